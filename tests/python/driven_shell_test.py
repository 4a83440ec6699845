"""`puckloop shell` and `run --shell`: a run driven by commands."""

import json
import pathlib
import re
import subprocess
import tempfile
import unittest

from kit import PROGRAM, SOURCE, puckloop

SCENARIO = SOURCE / "scenarios/hello.toml"


class DrivenShell(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.out = pathlib.Path(place.name) / "o"

    def shell(self, script, *options):
        done = subprocess.run([PROGRAM, "run", SCENARIO, "--shell", "--in-process", "--out", self.out, *options],
                              input=script, capture_output=True, text=True, timeout=120, check=False)
        return done.returncode, done.stdout, done.stderr

    def test_commands_drive_a_run(self):
        status, said, wrong = self.shell("""# a comment
board robot0.pic
step 500ms
read TMR1 U2STA.TRMT 0x850:4
where
frames link=robot0.uart from=robot0.pic
stepi
stepi 3
until TMR1 >= 0x10
until frame link=robot0.uart from=robot0.pic
act move can to 10 cm, 5 cm
type robot0.uart robot0.pic "v\\r"
step 20 ms
frames
back 0.4
write TRISA 0x1234
step 1 ms
fault drop link=robot0.uart from=robot0.pic begin=450ms count=1
run 1.2
links
save %s
end
""" % (self.out.parent / "a.snapshot"))
        self.assertEqual((status, wrong), (0, ""), said)
        self.assertRegex(said, r"(?m)^TMR1 = 0x[0-9a-f]{4} \d+")
        self.assertRegex(said, r"(?m)^U2STA.TRMT = [01]$")
        self.assertRegex(said, r"(?m)^0x850:4 = 0x[0-9a-f]{8} ")
        self.assertEqual(len(re.findall(r"(?m)^=> 0x[0-9a-f]{4}  \S", said)), 3)
        self.assertRegex(said, r"(?m)fault=insert from=robot0\.pic .*value=76$")
        self.assertGreater(len(re.findall(r"(?m)^[01]\.\d+ .*from=robot0\.pic.* value=[0-9a-f]{2}$", said)), 1)
        self.assertIn("\n0.400000 s\n", said)
        self.assertIn("\n1.200000 s\n", said)
        self.assertIn("  robot0.uart\n", said)
        self.assertIn("the run is over: node robot0.pic stopped", said)
        report = json.loads((self.out / "report.json").read_text())
        self.assertEqual(report["faults"][0]["fired"], 1)
        self.assertEqual(report["events"], [])  # what was done was taken back
        self.assertTrue((self.out.parent / "a.snapshot").is_file())

    def test_an_image_is_flashed_and_taken_back(self):
        status, said, wrong = self.shell(f"""step 500ms
flash {SOURCE / "firmware/epuck/epuck_ircom.elf"}
step 1ms
read frozen
back 0.3
read frozen
run 0.5
flash {SOURCE / "firmware/epuck/epuck_ircom.elf"}
run 1
end
""")
        self.assertEqual((status, wrong), (1, ""), said)
        self.assertEqual(len(re.findall(r"(?m)^frozen = 0x", said)), 1)  # of the image with symbols
        self.assertIn("its image has no symbols", said)
        self.assertEqual(json.loads((self.out / "report.json").read_text())["faults"][0]["fired"], 1)

    def test_what_is_refused_is_said_and_counted(self):
        lines = ["nonsense", "until TMR1 ~ 3", "until frame x", "read", "read TMR9", "read -", "write TRISA zz",
                 "write TRISA", "write U2STA.TRMT 1", "board nobody", "back 1", "fault dropp link=robot0.uart", "act fly",
                 "frames", "step x", "save", "read U2STA.NONE", "type", "type robot0.uart", "type robot0.uart robot0.pic",
                 "flash", "flash /nowhere.hex", f"flash {SOURCE / 'README.md'}", f"flash {SOURCE / 'firmware/rab/rab.hex'}",
                 "type robot0.uart nobody x", 'type robot0.uart robot0.pic "\\q"']
        status, said, _ = self.shell("step\n" + "\n".join(lines) + "\nstep\n")
        self.assertEqual(status, 1)
        answers = said.split("(puckloop) ")[2:-1]
        self.assertEqual(len(answers), len(lines))
        for line, answer in zip(lines, answers):
            self.assertEqual(len(answer.strip().splitlines()), 2, answer)  # the command, and one line
            self.assertTrue(answer.startswith(line), answer)
        self.assertIn("0.200000 s", said)

    def test_a_run_to_its_end(self):
        status, said, _ = self.shell("run\n", "--duration", "300 ms")
        self.assertEqual(status, 0)
        self.assertIn("the run is over: the asked duration is over", said)

    def test_nothing_to_drive(self):
        done = puckloop("shell", self.out)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        done = puckloop("run", SCENARIO, "--shell", "--view")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)


if __name__ == "__main__":
    unittest.main()
