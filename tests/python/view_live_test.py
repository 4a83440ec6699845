"""`puckloop view` over a run that goes on: the page drives it, in a headless Chromium."""

import json
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest
import urllib.error
import urllib.request

from browser import Browser, find_chromium
from kit import PROGRAM, SOURCE, puckloop

SCENARIO = SOURCE / "scenarios/hello.toml"


class Live(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.out = self.folder / "o"

    def start(self, duration):
        """A run that waits for its client, and a viewer: its address."""
        # pylint: disable=consider-using-with
        self.run = subprocess.Popen([PROGRAM, "run", SCENARIO, "--control", "--duration", str(duration), "--out",
                                     self.out], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, self.run)
        until = time.monotonic() + 60
        while "control" not in self.note() and time.monotonic() < until:
            time.sleep(0.02)
        self.viewer = subprocess.Popen([PROGRAM, "view", self.out], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True)
        self.addCleanup(self.end, self.viewer)
        return self.viewer.stdout.readline().strip()

    def note(self):
        try:
            return (self.out / "control.json").read_text()
        except OSError:
            return ""

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def report(self, folder=None):
        return json.loads(((folder or self.out) / "report.json").read_text())

    def ask(self, address, request, origin=None):
        """Status and text of a POST."""
        root = address.split("/", 3)
        headers = {"Origin": "/".join(root[:3])} if origin is None else {"Origin": origin} if origin else {}
        post = urllib.request.Request(address + "drive", json.dumps(request).encode(), headers, method="POST")
        try:
            with urllib.request.urlopen(post, timeout=60) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read().decode()

    def state(self, address):
        with urllib.request.urlopen(address + "drive", timeout=60) as answer:
            return json.loads(answer.read())

    def wait(self, address, condition, limit=120):
        until = time.monotonic() + limit
        while not condition(self.state(address)):
            self.assertLess(time.monotonic(), until, self.state(address))
            time.sleep(0.02)
        return self.state(address)

    def test_the_trace_with_a_viewer_is_the_one_without(self):
        plain = self.folder / "plain"
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--out", plain).returncode, 0)
        address = self.start(2)
        self.assertEqual(self.ask(address, {"page": "a", "do": "step", "ms": 1})[0], 200)
        self.assertAlmostEqual(self.wait(address, lambda s: s["time_s"] > 0)["time_s"], 0.001)
        self.assertEqual(self.ask(address, {"page": "a", "do": "play", "speed": 0})[0], 200)
        self.wait(address, lambda s: s["over"])
        self.assertEqual(self.run.wait(60), 0)
        self.assertEqual(self.report()["trace_sha256"], self.report(plain)["trace_sha256"])

    def test_what_its_user_did_replays_to_the_same_trace(self):
        address = self.start(2)
        self.ask(address, {"page": "a", "do": "step", "ms": 700})
        self.wait(address, lambda s: s["time_s"] > 0.69)
        self.ask(address, {"page": "a", "do": "act", "command": "move can to 10 cm, 5 cm"})
        self.ask(address, {"page": "a", "do": "act", "command": "move nobody to 10 cm, 5 cm"})
        self.ask(address, {"page": "a", "do": "play", "speed": 0})
        state = self.wait(address, lambda s: s["over"])
        self.assertIn("can", state["acts"][0]["answer"])
        self.assertFalse(state["acts"][0]["refused"])
        self.assertTrue(state["acts"][1]["refused"])
        self.run.wait(60)
        again = self.folder / "again"
        events = self.folder / "events.toml"
        events.write_text((self.out / "events.toml").read_text())
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--events", events, "--out",
                                  again).returncode, 0)
        self.assertEqual(self.report()["trace_sha256"], self.report(again)["trace_sha256"])

    def test_one_page_drives_and_others_look_on(self):
        address = self.start(2)
        self.assertEqual(self.ask(address, {"page": "a", "do": "step", "ms": 10})[0], 200)
        self.assertEqual(self.ask(address, {"page": "b", "do": "step", "ms": 10}), (409, "another page drives"))
        self.assertEqual(self.ask(address, {"page": "b", "do": "take"})[0], 200)
        self.assertEqual(self.ask(address, {"page": "a", "do": "pause"})[0], 409)
        for request in ([], {}, {"page": "b"}, {"page": "b", "do": "fly"}, {"page": "b", "do": "step", "ms": 0},
                        {"page": "b", "do": "step", "ms": "x"}, {"page": "b", "do": "play", "speed": -1},
                        {"page": "b", "do": "act", "command": ""}, {"page": "x" * 100, "do": "pause"}):
            self.assertEqual(self.ask(address, request)[0], 409, request)
        for origin in ("", "http://evil.example", "null"):
            self.assertEqual(self.ask(address, {"page": "b", "do": "pause"}, origin)[0], 403)
        self.assertEqual(self.ask(address, {"page": "b", "do": "act", "command": "x" * 5000})[0], 413)
        # A second viewer finds the run taken.
        second = puckloop("view", self.out)
        self.assertEqual(second.returncode, 2)
        self.assertIn("one drives at a time", second.stderr)
        # Ctrl-C of the viewer ends the run.
        self.viewer.send_signal(signal.SIGINT)
        self.assertEqual(self.viewer.wait(60), 0)
        self.assertEqual(self.run.wait(60), 0)
        self.assertEqual(self.report()["ended_why"].split(":")[-1].strip(), "its client ended the run")

    def test_the_page_plays_pauses_steps_and_acts(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        address = self.start(30)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        browser.wait("document.body && document.body.dataset.ready")
        browser.value("document.getElementById('play').click()")
        browser.wait("Number(document.body.dataset.simulated) > 1 && Number(document.body.dataset.time) > 0.5")
        browser.value("document.getElementById('play').click()")
        browser.wait("document.body.dataset.playing === 'false'")
        time.sleep(0.5)
        stands = browser.value("document.body.dataset.simulated")
        time.sleep(0.5)
        self.assertEqual(browser.value("document.body.dataset.simulated"), stands)
        browser.value("document.getElementById('step-1').click()")
        browser.wait(f"Math.abs(Number(document.body.dataset.simulated) - {stands} - 0.001) < 1e-7")
        # The can is carried by the mouse.
        x, y = browser.value("""(() => { const { arena } = window.puckloopView, box = arena.canvas.getBoundingClientRect();
            const [x, y] = arena.at(-0.25, -0.2); return [box.left + x, box.top + y]; })()""")
        browser.drag(x, y, x + 60, y, modifiers=1)
        browser.value("document.getElementById('step-100').click()")
        browser.wait("document.getElementById('detail').textContent.startsWith('move can to ')")
        browser.wait("document.getElementById('detail').textContent.includes(' s: ')")
        browser.wait("Number(document.body.dataset.events) > 20")
        browser.value("document.getElementById('end-run').click()")
        browser.wait("document.body.dataset.over === 'true'")
        self.run.wait(60)
        self.assertEqual(browser.errors, [])
        self.assertIn("can", (self.out / "events.toml").read_text())


if __name__ == "__main__":
    unittest.main()
