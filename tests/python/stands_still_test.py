"""docs/howto/stands_still.md: what it names is on the page, asked for as the page asks."""

import json
import pathlib
import struct
import subprocess
import time
import unittest
import urllib.request

from kit import PROGRAM, InFolder, puckloop


class Page:
    """A viewer's address: what a page gets from it."""

    def __init__(self, test, *words):
        # pylint: disable=consider-using-with
        self.process = subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True)
        test.addCleanup(self.close)
        self.address = self.process.stdout.readline().strip()

    def close(self):
        if self.process.poll() is None:
            self.process.terminate()
        self.process.communicate(timeout=60)

    def get(self, what):
        with urllib.request.urlopen(self.address + what, timeout=60) as answer:
            return answer.read()

    def json(self, what):
        return json.loads(self.get(what))

    def wait(self, what, condition, limit=120):
        end = time.monotonic() + limit
        while not condition(state := self.json(what)):
            if time.monotonic() > end:
                raise TimeoutError(state)
            time.sleep(0.05)
        return state

    def drive(self, **request):
        post = urllib.request.Request(self.address + "drive", json.dumps({"page": "a", **request}).encode(),
                                      {"Origin": "/".join(self.address.split("/")[:3])}, method="POST")
        urllib.request.urlopen(post, timeout=60).close()

    def step(self, seconds):
        to = self.json("drive")["time_s"] + seconds
        self.drive(do="step", ms=round(1000 * seconds))
        self.wait("drive", lambda state: state["time_s"] >= to - 1e-9 or state["over"])

    def look(self, board, *items):
        """Where the board's program is, and what the items are."""
        self.drive(do="look", board=board, items=items)
        look = self.wait("drive", lambda state: state["look"] and state["look"]["board"] == board
                         and len(state["look"]["values"]) == len(items))["look"]
        return look["where"], [value["text"] for value in look["values"]]

    def events(self):
        """Of a recorded run: track, begin, failed, text."""
        status = self.wait("status", lambda state: state["done"])
        block = self.get("events?from=0")
        count = struct.unpack_from("<4I", block)[2]
        begins = struct.unpack_from(f"<{count}d", block, 16)
        tracks = struct.unpack_from(f"<{count}H", block, 16 + 12 * count)
        flags = struct.unpack_from(f"<{count}B", block, 16 + 14 * count)
        texts = []
        for first in range(0, count, 500):
            texts += self.json("texts?numbers=" + ",".join(map(str, range(first, min(first + 500, count)))))
        return [(status["tracks"][tracks[i]]["name"], begins[i], bool(flags[i] & 1), texts[i]) for i in range(count)]


class StandsStill(InFolder):
    def run_view(self, scenario):
        return Page(self, "run", scenario, "--view", "--out", self.folder / "live")

    def recorded(self, scenario):
        ended = puckloop("run", scenario, "--in-process", "--out", self.folder / "out")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return Page(self, "view", self.folder / "out")

    def path(self, robot, folder="out"):
        """x and y in m, one row each 100 ms."""
        rows = (self.folder / folder / "trajectory.csv").read_text().splitlines()[1:]
        return [tuple(map(float, row.split(",")[2:4])) for row in rows if row.split(",")[1] == robot]

    def moved(self, robot, begin, end, folder="out"):
        path = self.path(robot, folder)
        first, last = path[round(10 * begin)], path[min(round(10 * end), len(path) - 1)]
        return ((first[0] - last[0]) ** 2 + (first[1] - last[1]) ** 2) ** 0.5

    def test_hung_on_a_register(self):
        page = self.run_view("still_1")
        page.step(3)
        tracks = [track["name"] for track in page.wait(
            "status", lambda state: any("robot0.uart" in track["name"] for track in state["tracks"]))["tracks"]]
        self.assertIn("robot0.uart robot0.linux", tracks)
        self.assertNotIn("robot0.uart robot0.pic", tracks)
        items = ("ADCON1.ADON", "IFS0.ADIF", "IEC0.ADIE")
        for _ in range(3):
            where, values = page.look("robot0.pic", *items)
            self.assertRegex(where["line"], r"main\.c:3[56]")
            self.assertEqual(values, ["0", "0", "1"])
            page.step(0.1)
        page.drive(do="back", to_s=0.004)
        page.wait("drive", lambda state: state["time_s"] == 0.004)
        self.assertEqual(page.look("robot0.pic", *items)[1][0], "1")
        page.drive(do="until", condition="ADCON1.ADON == 0", board="robot0.pic", ms=1000)
        state = page.wait("drive", lambda state: state["acts"] and "until" in state["acts"][-1]["command"])
        self.assertFalse(state["acts"][-1]["refused"])
        self.assertTrue(0.005 <= state["time_s"] <= 0.006 + 1e-9, state["time_s"])
        # Switched on again by hand, it moves: that is the cause. (The page reads; the shell writes.)
        page.drive(do="end")
        page.wait("drive", lambda state: state["over"])
        script = self.file("again", "step 20ms\nwrite ADCON1 0x80e4\nrun 8\nend\n")
        with script.open() as lines:
            subprocess.run([PROGRAM, "run", "still_1", "--shell", "--out", self.folder / "out"], stdin=lines,
                           stdout=subprocess.DEVNULL, timeout=120, check=False)
        self.assertGreater(self.moved("robot0", 2, 7), 0.1)

    def test_lost_byte(self):
        page = self.recorded("still_2")
        failed = [event for event in page.events() if event[2] and " robot0.pic" in event[0]]
        self.assertEqual(len(failed), 1, failed)
        track, begin, _, text = failed[0]
        self.assertEqual((track, round(begin, 2)), ("robot0.uart robot0.pic", 3.05))
        self.assertIn("71 of 72 bytes", text)
        after = [event for event in page.events() if event[0].startswith("robot0.uart") and event[1] > begin]
        self.assertEqual(after, [])
        self.assertIn(1, json.loads(page.get("serial?from=0,robot0.uart"))["k"])  # struck through
        self.assertGreater(self.moved("robot0", 2, 3), 0.04)
        self.assertLess(self.moved("robot0", 4.5, 8), 0.001)
        page.close()
        live = self.run_view("still_2")
        live.step(4)
        live.drive(do="type", link="robot0.uart", **{"from": "robot0.pic"}, text="*")
        live.wait("drive", lambda state: state["epoch"] == 1)
        live.drive(do="play", speed=0)
        live.wait("drive", lambda state: state["over"])
        self.assertGreater(self.moved("robot0", 4.5, 7.5, "live"), 0.1)

    def test_dead_receivers(self):
        page = self.recorded("still_3")
        lost = {}
        for track, _, failed, _ in page.events():
            if track.endswith(" range and bearing"):
                all_, bad = lost.get(track.split()[0], (0, 0))
                lost[track.split()[0]] = (all_ + 1, bad + failed)
        self.assertEqual(set(lost), {"caller", "left", "right"})
        self.assertGreater(lost["right"][0], 100)
        self.assertEqual(*lost["right"])  # every one
        self.assertEqual((lost["left"][1], lost["caller"][1]), (0, 0))
        asked = [text for track, begin, _, text in page.events() if track.startswith("right.i2c.linux") and begin > 1]
        self.assertGreater(sum("read POP(0) = 00" in text for text in asked), 100)
        self.assertFalse(any("DATA" in text for text in asked))
        self.assertGreater(self.moved("left", 1, 7), 0.05)
        self.assertLess(self.moved("right", 0, 8), 0.001)


if __name__ == "__main__":
    unittest.main()
