"""A run that went wrong is no success, and its report states what it was made of."""

import hashlib
import json
import os
import unittest

from kit import PROGRAM, SOURCE, InFolder, problems, puckloop, schema_of

SCENARIO = """[run]
duration = "3 s"
{allow}
[arena]
size = ["1 m", "1 m"]
[[robot]]
position = ["0 m", "0 m"]
[robot.pic]
firmware = "{firmware}"
{linux}
"""

TALKS = """#!/usr/bin/python3
import os, signal, sys, termios, time, tty
port = os.open("/dev/ttyS0", os.O_RDWR | os.O_NOCTTY)
tty.setraw(port)
settings = termios.tcgetattr(port)
settings[4] = settings[5] = termios.B115200
termios.tcsetattr(port, termios.TCSAFLUSH, settings)
signal.signal(signal.SIGTERM, lambda number, frame: sys.exit({status}))
os.write(port, bytes({sent}))
while True:
    time.sleep(0.1)
"""
HELLO = [1, 0, 0, 0, 0]  # wake-up and configuration: 72 bytes come back

# Waits for a failure of the oscillator, which no model makes.
HANGS = """
        goto    main
        .org    0x100
main:   mov     #0x0900, w15
        mov     #0x27f0, w0
        mov     w0, SPLIM
        bset    RCON, #12
wait:   btss    INTCON1, #1
        bra     wait
        bra     wait
"""


class Truth(InFolder):
    def scene(self, allow="", firmware="own", program=""):
        linux = ""
        if program:
            path = self.file("program", program)
            path.chmod(0o755)
            linux = f'[robot.linux]\nprogram = ["{path}"]\nstart = "100 ms"\n'
        return self.file("s.toml", SCENARIO.format(allow=allow, firmware=firmware, linux=linux))

    def ran(self, scene, *words):
        ended = puckloop("run", scene, "--in-process", "--out", self.folder / "out", *words)
        report = json.loads((self.folder / "out/report.json").read_text())
        self.assertEqual(problems(report, schema_of("report")), [])
        self.assertEqual(ended.returncode, 0 if report["success"] else 1, ended.stderr)
        return report, ended

    def fails_unless_allowed(self, kind, text, **parts):
        report, ended = self.ran(self.scene(**parts))
        self.assertFalse(report["success"])
        self.assertIn(text, report["ended_why"])
        self.assertIn(text, ended.stderr)
        self.assertEqual([(one["kind"], one["allowed"]) for one in report["failures"]], [(kind, False)])
        report, _ = self.ran(self.scene(allow=f'allow = ["{kind}"]', **parts))
        self.assertTrue(report["success"], report["ended_why"])
        self.assertEqual([(one["kind"], one["allowed"]) for one in report["failures"]], [(kind, True)])

    def test_a_program_that_ends_badly_behind_its_end_signal(self):
        program = TALKS.format(status=7, sent=HELLO)
        self.fails_unless_allowed("program", "exited with status 7 after SIGTERM", program=program)

    def test_a_program_that_ends_well_is_a_success(self):
        program = TALKS.format(status=0, sent=HELLO)
        report, _ = self.ran(self.scene(program=program))
        self.assertTrue(report["success"], report["ended_why"])
        self.assertEqual(report["failures"], [])

    def test_a_robot_that_never_answers(self):
        # Another rate: the firmware hears other bytes, or none.
        program = TALKS.format(status=0, sent=HELLO).replace("B115200", "B9600")
        self.fails_unless_allowed("silent_line", "never received one", program=program)

    def test_a_silence_that_a_fault_makes_is_the_faults(self):
        program = TALKS.format(status=0, sent=HELLO)
        report, _ = self.ran(self.scene(program=program), "--fault", "drop link=robot0.uart from=robot0.pic")
        self.assertTrue(report["success"], report["ended_why"])

    def test_a_board_that_hangs(self):
        source = self.file("hangs.s", HANGS)
        image = self.folder / "hangs.hex"
        self.assertEqual(puckloop("asm", source, "-o", image).returncode, 0)
        self.fails_unless_allowed("hung", "INTCON1, bit OSCFAIL", firmware=image)

    def test_the_report_states_what_ran(self):
        report, _ = self.ran("hello", "--duration", "2 s")
        self.assertEqual(report["format"], 1)
        self.assertEqual(report["puckloop"]["version"], os.environ["PUCKLOOP_VERSION"])
        self.assertEqual(report["command_line"][:3], [PROGRAM, "run", "hello"])
        files = {(one["node"], one["role"]): one for one in report["files"]}
        image = files[("robot0.pic", "firmware")]
        self.assertEqual(image["sha256"],
                         hashlib.sha256((SOURCE / "firmware/epuck/epuck.hex").read_bytes()).hexdigest())
        program = files[("robot0.linux", "program")]
        with open(program["file"], "rb") as stream:
            self.assertEqual(program["sha256"], hashlib.sha256(stream.read()).hexdigest())


if __name__ == "__main__":
    unittest.main()
