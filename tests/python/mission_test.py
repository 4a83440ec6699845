"""Mission programs in real runs: what they get, what they may do, and what becomes of bad ones."""

import csv
import json
import math
import pathlib
import unittest

from kit import SOURCE, InFolder, puckloop

SCENARIO = """[run]
duration = "{duration}"
record_every = "10 ms"
allow = ["program"]
[arena]
size = ["1 m", "1 m"]
[[floor_patch]]
name = "spot"
shape = "disc"
centre = ["0 m", "0 m"]
radius = "10 cm"
grey = 0
[tracker]
frame_rate = "{rate} Hz"
latency = "30 ms"
{tracker}
[mission]
kind = "program"
program = ["./judge", "word"]
{mission}
[[robot]]
name = "one"
position = ["0 m", "0 m"]
heading = "90 deg"
[robot.pic]
firmware = "own"
[robot.linux]
program = ["puckloop-control", "--behaviour", "wander", "--duration", "60"]
start = "20 ms"
[[robot]]
name = "two"
position = ["30 cm", "0 m"]
[robot.pic]
firmware = "own"
"""

# Answers without the client: JSON lines and nothing else.
COUNTS = """#!/usr/bin/python3
import json, sys
print("hello", sys.argv[1:], file=sys.stderr)
score = 0
kept = open(sys.argv[0] + ".lines", "w")
for line in sys.stdin:
    kept.write(line)
    line = json.loads(line)
    answer = {"score": score}
    if line.get("frame") == 3:
        answer["act"] = ["set spot grey 1", "set nothing grey 0", "move two to 30 cm, 20 cm"]
    if "frame" in line:
        score += len(line["robots"])
        answer["score"] = score
    print(json.dumps(answer), flush=True)
"""


class Missions(InFolder):
    def ran(self, program, *words, out="out", duration="1 s", rate=10, tracker="", mission=""):
        judge = self.file("judge", program)
        judge.chmod(0o755)
        scene = self.file("s.toml", SCENARIO.format(duration=duration, rate=rate, tracker=tracker, mission=mission))
        words = words or ("--in-process",)
        return puckloop("run", scene, "--out", self.folder / out, *words)

    def report(self, out="out"):
        return json.loads((self.folder / out / "report.json").read_text())

    def lines_of_run(self):
        return [json.loads(line) for line in (self.folder / "judge.lines").read_text().splitlines()]

    def failed(self, ended, *parts):
        self.assertEqual(ended.returncode, 1, ended.stdout + ended.stderr)
        for part in parts:
            self.assertIn(part, ended.stdout + ended.stderr)

    def test_a_program_is_told_what_the_tracker_sees_and_its_last_score_is_the_runs(self):
        ended = self.ran(COUNTS)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        lines = self.lines_of_run()
        self.assertEqual(lines[0]["begin"], 1)
        self.assertEqual([robot["name"] for robot in lines[0]["robots"]], ["one", "two"])
        self.assertEqual(lines[0]["duration_s"], 1.0)
        frames = lines[1:-1]
        self.assertEqual([f["frame"] for f in frames], list(range(10)))  # that of 1.0 s arrives after the end
        self.assertEqual(frames[4]["t_s"], 0.4)
        self.assertEqual(frames[4]["arrives_s"], 0.43)
        self.assertAlmostEqual(frames[0]["robots"][1]["x_m"], 0.3, delta=0.015)
        self.assertAlmostEqual(lines[-1]["end"], 1.0, delta=0.1)
        mission = self.report()["mission"]
        self.assertEqual(mission, {"kind": "program", "score": 20, "better": "more", "steps": 10})
        self.assertIn("mission program: score 20 (more is better), 10 frames of the tracker", ended.stdout)
        self.assertEqual((self.folder / "out" / "mission.log").read_text(), "hello ['word']\n")

    def test_what_it_asks_for_is_done_one_step_later_and_what_is_refused_comes_back(self):
        self.assertEqual(self.ran(COUNTS).returncode, 0)
        frames = {line["frame"]: line for line in self.lines_of_run() if "frame" in line}
        self.assertEqual(frames[3]["events"], [])
        events = {event["act"]: event for event in frames[4]["events"]}
        self.assertEqual(events["set spot grey 1"]["at_s"], 0.331)
        self.assertIn("nothing", events["set nothing grey 0"]["refused"])
        self.assertNotIn("refused", events["move two to 30 cm, 20 cm"])
        self.assertEqual(frames[5]["events"], [])
        self.assertAlmostEqual(frames[4]["robots"][1]["y_m"], 0.2, delta=0.015)
        done = (self.folder / "out" / "events.toml").read_text()
        self.assertIn('at = "0.331 s"', done)

    def test_one_trace_in_every_placement_and_thread_count_and_without_the_program_by_its_events(self):
        traces = set()
        for words in (("--in-process",), (), ("--in-process", "--threads", "2")):
            self.assertEqual(self.ran(COUNTS, *words).returncode, 0)
            traces.add(self.report()["trace_sha256"])
            tracked = (self.folder / "out" / "tracker.csv").read_bytes()
        self.assertEqual(len(traces), 1)
        self.assertEqual(len(tracked.splitlines()), 1 + 2 * 11)
        events = self.folder / "again.toml"
        events.write_bytes((self.folder / "out" / "events.toml").read_bytes())
        scene = self.file("plain.toml", "\n".join(
            line for line in (self.folder / "s.toml").read_text().splitlines()
            if not line.startswith(("[mission]", "kind =", "program = [\"./judge"))))
        ended = puckloop("run", scene, "--in-process", "--events", events, "--out", self.folder / "again")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual({self.report("again")["trace_sha256"]}, traces)

    def test_tracker_csv_is_what_it_says(self):
        self.assertEqual(self.ran(COUNTS, rate=50, duration="2 s", tracker='position_noise = "0 m"\n'
                                  'heading_noise = "0 rad"').returncode, 0)
        with open(self.folder / "out" / "trajectory.csv", encoding="utf-8") as file:
            true = {(row["t_s"], row["robot"]): row for row in csv.DictReader(file)}
        with open(self.folder / "out" / "tracker.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * len({row["frame"] for row in rows}))
        self.assertGreaterEqual(len(rows), 2 * 101)
        for row in rows:
            there = true[(row["t_s"], row["robot"])]
            for key in ("x_m", "y_m"):
                self.assertAlmostEqual(float(row[key]), float(there[key]), delta=2e-5)
            self.assertAlmostEqual(float(row["arrives_s"]) - float(row["t_s"]), 0.03, places=6)

    def test_it_may_end_the_run(self):
        ended = self.ran('#!/bin/sh\nread begin; echo "{}"\nread first; echo \'{"score": 4.5, "end": "it is enough"}\'\n'
                         'read last; echo "{}"\n', mission='better = "less"')
        self.assertEqual(ended.returncode, 0, ended.stderr)
        report = self.report()
        self.assertIn("it is enough", report["ended_why"])
        self.assertLess(report["simulated_s"], 0.5)
        self.assertEqual(report["mission"]["score"], 4.5)
        self.assertEqual(report["mission"]["better"], "less")

    def test_bad_programs_fail_the_run_and_the_line_says_when_and_what(self):
        self.failed(self.ran('#!/bin/sh\nread a; echo "{}"; read b; exit 3\n'), "exited with status 3 at frame 0")
        self.failed(self.ran('#!/bin/sh\nread a; kill -9 $$\n'), "was killed by signal 9 (Killed) at its beginning")
        self.failed(self.ran('#!/bin/sh\nread a; echo "{}"; read b; sleep 100\n', mission='timeout = "2 s"'),
                    "gave no answer within 2 s at frame 0")
        self.failed(self.ran('#!/bin/sh\necho oh >&2\nread a; echo nonsense\n'), "its beginning", "'nonsense' is no JSON object",
                    "mission.log")
        self.failed(self.ran('#!/bin/sh\nread a; echo \'{"scor": 1}\'\n'), "'scor' is no key of an answer; did you mean \"score\"?")
        self.failed(self.ran('#!/bin/sh\nread a; echo \'{"score": "many"}\'\n'), '"many" is no score')
        self.failed(self.ran('#!/bin/sh\nread a; echo \'{"act": "dance"}\'\n'), "dance")
        self.failed(self.ran('#!/bin/sh\nread a; exec 1>&-; sleep 100\n'), "closed its output at its beginning")
        self.failed(self.ran('#!/bin/sh\nyes x | tr -d "\\n"\n'), "answered more than 1 MiB")
        self.failed(self.ran("#!/no/such/interpreter\n"), "exited with status 127 at its beginning")

    def test_a_program_that_ends_badly_after_the_end_fails_the_run_too(self):
        self.failed(self.ran(COUNTS + "sys.exit(4)\n"), "the mission program exited with status 4")
        self.assertEqual(self.report()["mission"]["score"], 20)
        self.failed(self.ran(COUNTS + "import time\ntime.sleep(100)\n", mission='timeout = "4 s"'),
                    "had not ended 4 s after its last answer")

    def test_a_program_that_is_not_there_is_refused_with_its_line(self):
        ended = self.ran(COUNTS)
        (self.folder / "judge").unlink()
        report = (self.folder / "out" / "report.json").read_text()
        ended = puckloop("run", self.folder / "s.toml", "--in-process", "--out", self.folder / "out")
        self.refused(ended, "s.toml", "line", "judge", "cannot be executed")
        self.assertEqual((self.folder / "out" / "report.json").read_text(), report)  # what was there stays

    def test_bad_tables_are_refused_with_their_line(self):
        for text, part in (('loss = 2', "loss is out of range"), ('frame_rate = "0 Hz"', "frame_rate is out of range"),
                           ('latency = "-1 s"', "latency is out of range"), ('los = 0.1', "loss"),
                           ('swap_distance = "1 s"', "swap_distance")):
            lines = SCENARIO.format(duration="1 s", rate=10, tracker=text, mission="").splitlines()
            key = text.split()[0]
            kept = [line for line in lines if line == text or not line.startswith(key + " =")]
            scene = self.file("bad.toml", "\n".join(kept))
            self.refused(puckloop("check", scene), "bad.toml", "line", part)
        scene = self.file("bad.toml", SCENARIO.format(duration="1 s", rate=10, tracker="", mission='step = "1 s"'))
        self.refused(puckloop("check", scene), "line", "step")

    def test_the_shipped_mission_runs_with_the_client(self):
        out = self.folder / "shipped"
        ended = puckloop("run", SOURCE / "scenarios/moving_spot.toml", "--in-process", "--duration", "6", "--set", "robots=2",
                         "--out", out)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        report = json.loads((out / "report.json").read_text())
        with open(out / "tracker.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        side, score = 1, 0  # the same again, from the record
        for number in range(report["mission"]["steps"]):
            frame = [row for row in rows if int(row["frame"]) == number]
            inside = sum(math.hypot(float(row["x_m"]), float(row["y_m"]) - 0.6 * side) <= 0.3 for row in frame)
            score += inside
            side = -side if inside * 2 >= 2 else side
        self.assertEqual(report["mission"]["score"], score)
        self.assertGreater(report["mission"]["steps"], 50)


if __name__ == "__main__":
    unittest.main()
