"""`puckloop debug`: scripts at the project's own main board image, at the TAM, and at a real XC16 image."""

import os
import pathlib
import pty
import random
import re
import select
import shutil
import subprocess
import time
import unittest

from kit import PROGRAM, SOURCE, InFolder, puckloop

EPUCK = SOURCE / "firmware" / "epuck"
LAMP = SOURCE / "tests" / "debug" / "programs" / "lamp.c"
IMAGES = os.environ.get("PUCKLOOP_IMAGES", "")
PROMPT = "(puckloop) "


class Debugged(InFolder):
    def debug(self, *words, script, status=0):
        """What each command of the script printed, by the order of commands; [0] is before the first."""
        ended = subprocess.run([PROGRAM, "debug", *map(str, words)], input="\n".join(script) + "\n", capture_output=True,
                               text=True, timeout=240, check=False, cwd=self.folder)
        self.assertEqual((ended.returncode, ended.stderr.replace(f"puckloop: {words[0]}", "")), (status, ""), ended.stdout)
        parts = re.split(r"^\(puckloop\) (.*)\n", ended.stdout, flags=re.MULTILINE)
        self.assertEqual(parts[1::2], [line for line in script], ended.stdout)
        return [parts[0], *parts[2::2]]

    def lamp(self):
        if shutil.which("avr-gcc") is None or not pathlib.Path("/usr/lib/avr/include/avr/io.h").exists():
            self.skipTest("avr-gcc with avr-libc is not installed")
        subprocess.run(["avr-gcc", "-mmcu=atmega1284p", "-g", "-O1", "-o", self.folder / "lamp.elf", LAMP], check=True)
        return self.folder / "lamp.elf"


class MainBoard(Debugged):
    """firmware/epuck/epuck.elf, by a pic30 compiler: dsPIC30F6014A, lines in DWARF."""

    def at(self, *script, status=0):
        return self.debug(EPUCK / "epuck.elf", "--sources", EPUCK, script=script, status=status)

    def test_lines_steps_and_back(self):
        said = self.at("break main", "continue", "next", "next", "next", "step", "backtrace", "finish", "next",
                       "time", "back", "back", "time", "reverse-continue", "time")
        self.assertRegex(said[1], r"^breakpoint 1: main at 0x[0-9a-f]+ in main \(main.c:\d+\)\n$")
        self.assertIn("breakpoint 1: main\n", said[2])
        lines = (EPUCK / "main.c").read_text().splitlines()
        for place in (2, 3, 4, 5):  # what is shown is the source's line
            number, text = re.search(r"^(\d+)\t(.*)$", said[place], re.MULTILINE).groups()
            self.assertEqual(text, lines[int(number) - 1])
        self.assertIn("quiet_the_rest();", said[5])
        self.assertRegex(said[6], r"in quiet_the_rest\S* \(main.c:\d+\)")
        self.assertRegex(said[7], r"^\*#0 .* in quiet_the_rest.*\n #1 .* in main")
        self.assertRegex(said[8], r"in main\+0x[0-9a-f]+ \(main.c")
        self.assertIn("leds_start();", said[8])
        self.assertIn("motors_start();", said[9])
        self.assertIn("leds_start();", said[11])
        self.assertIn("quiet_the_rest();", said[12])
        self.assertIn("breakpoint 1: main", said[14])
        # Where the program was at the same line, it is at the same cycle.
        cycles = [int(re.search(r"(\d+) cycles", said[place])[1]) for place in (10, 13, 15)]
        self.assertLess(cycles[2], cycles[1])
        self.assertLess(cycles[1], cycles[0])
        self.assertIn("in the past", said[15])

    def test_back_and_forth_is_the_same(self):
        said = self.at("break leds_set", "continue", "print/x pc w0 w15 LATA", "time", "finish", "stepi 40", "back-instruction 20",
                       "reverse-continue", "print/x pc w0 w15 LATA", "time")
        self.assertEqual(said[9], said[3])
        self.assertEqual(said[10].replace(", in the past", ""), said[4])

    def test_register_bits(self):
        said = self.at("break T1CON.TON=1", "continue", "print T1CON T1CON.TON", "watch LATA", "delete 1", "continue", "info",
                       "print T1CON.15")
        self.assertIn("breakpoint 1: T1CON.TON=1\nT1CON.TON = 1\n", said[2])
        self.assertRegex(said[3], r"T1CON = 0x8[0-9a-f]{3} .*TON=1.*\nT1CON.TON = 1\n")
        self.assertIn("2  watch LATA", said[7])
        self.assertEqual(said[8], "T1CON.15 = 1\n")

    def test_hardware_sets_a_bit(self):
        # A flag that a timer sets, not the program: seen within one instruction of it.
        said = self.at("break main", "continue", "break IFS0.T1IF=1", "continue", "print IFS0.T1IF", "stepi", "interrupts")
        self.assertIn("breakpoint 2: IFS0.T1IF=1", said[4])
        self.assertEqual(said[5], "IFS0.T1IF = 1\n")
        self.assertIn("T1Interrupt", said[6])
        self.assertIn("IEC0: ", said[7])

    def test_change_what_is_there(self):
        said = self.at("break main", "continue", "set LATA = 0x40", "print/x LATA", "set LATA.LATA6 = 0", "print LATA.6",
                       "set w3 = 0x1234", "print w3", "back", "set w3 = 1", status=1)
        self.assertEqual(said[4], "LATA = 0x0040\n")
        self.assertEqual(said[6], "LATA.6 = 0\n")
        self.assertIn("0x1234", said[8])
        self.assertIn("the past cannot be changed", said[10])

    def test_lists_and_disassembles(self):
        said = self.at("list leds.c:12", "disassemble leds_set", "tbreak leds_set", "continue", "info", "up", "list", "down")
        self.assertIn("  12\tvoid leds_set(u8 ring, u8 others) {\n", said[1])
        self.assertRegex(said[2], r"leds.c:14\n   0x\w+ leds_set +\S+")
        self.assertIn("return", said[2])
        self.assertIn("breakpoint 1\n", said[4])
        self.assertIn("no break- or watchpoints", said[5])
        self.assertIn("in leds_start", said[6])
        self.assertIn("leds_set(0, 0);", said[7])

    def test_commands_that_gdb_has(self):
        said = self.at("x/3 leds_set", "x/2i", "info registers", "regs", "x/0", "x/3q leds_set", status=1)
        for place, instructions in ((1, 3), (2, 2)):
            self.assertEqual(len(re.findall(r"^(?:=>|  ) 0x\w{6} ", said[place], re.M)), instructions, said[place])
        self.assertIn("w15", said[3])
        self.assertEqual(said[3], said[4])
        self.assertIn("'/0' is no count", said[5])
        self.assertIn("'/3q' is no count", said[6])

    def test_bad_lines_are_one_line_each(self):
        said = self.at("break leds_sett", "break lead.c:7", "break leds.c:700", "break 0x3", "break 0xfffffe", "print LATQ",
                       "print LATA.LATA99", "prnt LATA", "delete 7", "step 0", "list nobody.c:1", "set LATA", "set LATA = 70000",
                       "watch pc", "break T1CON.TON=2", "print /q LATA", "print main[", "finish", "up", "time", status=1)
        for place, text in enumerate(["did you mean \"leds_set\"", "no source file 'lead.c'", "has no code from line 700",
                                      "is no program address", "", "did you mean \"LAT", "LATA has no field", "did you mean \"print\"",
                                      "no break- or watchpoint", "is no number of times", "no source file", "assigns nothing",
                                      "does not fit", "has no address", "is no value", "is no format", "no", "no caller",
                                      "no frame", "0.000000000 s, "], start=1):
            self.assertIn(text, said[place])
            self.assertEqual(said[place].count("\n"), 1, said[place])

    def test_images_that_cannot_be(self):
        self.refused(puckloop("debug", "nothing.elf"), "nothing.elf")
        self.refused(puckloop("debug", SOURCE / "scenarios" / "hello.toml"), "is a scenario")
        self.refused(puckloop("debug", EPUCK / "epuck.elf", "--uart1", "-"), "standard input and output are the debugger's")
        said = self.debug(EPUCK / "epuck.hex", script=["break main", "stepi", "next", "print LATA", "info"], status=1)
        self.assertIn("no function 'main'", said[1])
        self.assertIn("no source lines", said[5])

    def test_the_end_of_a_run(self):
        said = self.debug(EPUCK / "epuck.elf", "--seconds", "0.01", status=1,
                          script=["continue", "print LATA", "step", "back", "stepi", "back-instruction", "continue"])
        for place in (1, 3, 7):
            self.assertIn("the run is over", said[place])
        self.assertEqual(said[6].splitlines()[0], said[4].splitlines()[0])
        # A script that gives no end of its own has one.
        said = self.debug(EPUCK / "epuck.hex", script=["continue", "time"])
        self.assertIn("the run is over", said[1])
        self.assertIn("60.000", said[2])


    def test_the_documented_session(self):
        text = (SOURCE / "docs" / "debugger.md").read_text()
        block = text[text.index("    (puckloop) break main"):]
        lines = []
        for line in block.splitlines():
            if not line.startswith("    "):
                break
            lines.append(line[4:])
        script = [line.removeprefix(PROMPT) for line in lines if line.startswith(PROMPT)]
        self.assertGreater(len(script), 6)
        ended = subprocess.run([PROGRAM, "debug", EPUCK / "epuck.elf", "--board", "pic", "--sources", EPUCK],
                               input="\n".join(script) + "\n", capture_output=True, text=True, check=False)
        shown = ended.stdout[ended.stdout.index(PROMPT):].splitlines()
        self.assertEqual(shown[:len(lines)], lines)

    def test_drawn_commands(self):
        # Whatever is typed, the debugger answers and goes on: 40 scripts of words that mean something elsewhere.
        words = ["break", "tbreak", "watch", "delete", "info", "step", "next", "stepi", "finish", "until", "back", "back-into",
                 "bi", "rc", "bt", "up", "down", "list", "x", "p", "set", "m", "registers", "interrupts", "main", "leds_set",
                 "main.c:25", "LATA", "T1CON.TON", "T1CON.TON=1", "0x800", "0x1000", "-1", "=", "7", "[", "]", ":", "w0", "w0[1]",
                 "0xFFFF:4", "0xFFFF", "/x", "/", "*", "#", "LATA[3]", "LATA:9", "pc", "65536", "99999999999999999999", "a" * 500]
        draw = random.Random(41)
        for _ in range(40):
            script = [" ".join(draw.choice(words) for _ in range(draw.randint(1, 4))) for _ in range(30)]
            ended = subprocess.run([PROGRAM, "debug", EPUCK / "epuck.elf", "--seconds", "0.002"], input="\n".join(script) + "\n",
                                   capture_output=True, text=True, timeout=120, check=False, cwd=self.folder)
            self.assertIn(ended.returncode, (0, 1), (script, ended.stderr))
            self.assertEqual(ended.stdout.count(PROMPT), len(script), script)


class Terminal(Debugged):
    """At a terminal: completion, history, Ctrl-C."""

    def setUp(self):
        super().setUp()
        pid, self.terminal = pty.fork()
        if pid == 0:
            os.environ.update(TERM="vt100", XDG_STATE_HOME=str(self.folder), HOME=str(self.folder))
            os.execv(PROGRAM, [PROGRAM, "debug", str(EPUCK / "epuck.elf"), "--sources", str(EPUCK)])
        self.pid = pid
        self.addCleanup(os.close, self.terminal)

    def said_after(self, text, wanted):
        os.write(self.terminal, text.encode())
        end, said = time.monotonic() + 60, ""
        while wanted not in said:
            self.assertLess(time.monotonic(), end, said)
            if select.select([self.terminal], [], [], 0.2)[0]:
                said += os.read(self.terminal, 65536).decode(errors="replace")

    def test_typing(self):
        self.said_after("", PROMPT)
        self.said_after("tbr\t", "eak ")
        self.said_after("leds_se\t", "t ")
        self.said_after("\n", "leds.c:14")
        self.said_after("cont\t\n", "in leds_set")
        self.said_after("print T1CO\t\n", "T1CON = 0x0000")
        self.said_after("cont\t\n", "inue")
        time.sleep(0.3)
        self.said_after("\x03", "interrupted")
        self.said_after("time\n", " cycles")
        self.said_after("quit\n", "quit")
        self.assertEqual(os.waitpid(self.pid, 0)[1], 0)
        history = (self.folder / "puckloop" / "debug_history").read_text()
        self.assertIn("tbreak", history)


class Tam(Debugged):
    """The ATmega1284P with a program by avr-gcc: interrupts every 100 us."""

    def at(self, *script, status=0):
        return self.debug(self.lamp(), "--mcu", "atmega1284p", "--sources", LAMP.parent, script=script, status=status)

    def test_interrupts_are_stepped_over(self):
        said = self.at("break remember", "continue", "backtrace", "print levels", "watch levels[0]", "delete 1", "continue",
                       "print levels[0] ticks", "next 40", "break __vector_13", "continue", "backtrace", "finish")
        self.assertIn("in remember (lamp.c:20)", said[2])
        self.assertRegex(said[3], r"#0 .*remember.*\n #1 .*in main\+\S+ \(lamp.c:39\)")
        self.assertEqual(said[4], "levels = 00 00 00 00\n" if "00 00" in said[4] else "levels = 0 (0x00000000)\n")
        self.assertIn("levels[0] = 3 (0x03)", said[7])
        self.assertIn("ticks = 1 (0x0001)", said[8])
        self.assertNotIn("__vector", said[9])
        self.assertIn("in __vector_13", said[11])
        self.assertRegex(said[12], r"#0 .*__vector_13.*interrupt\n #1 .*lamp.c")
        self.assertIn("lamp.c:", said[13])

    def test_back_over_functions(self):
        said = self.at("tbreak remember", "continue", "back", "time", "back", "step", "step")
        self.assertIn("in main", said[3])
        self.assertNotIn("brightness", said[5])
        self.assertRegex(said[7], "main|brightness|remember")


@unittest.skipUnless(IMAGES, "PUCKLOOP_IMAGES names no folder: real images are skipped")
class RealImage(Debugged):
    """demoGCtronic.X.production.elf, as XC16 built it."""

    def test_lines_of_xc16(self):
        image = pathlib.Path(IMAGES) / "demoGCtronic.X.production.elf"
        if not image.exists():
            self.skipTest(f"{image} is not there")
        said = self.debug(image, script=["break main", "continue", "next", "backtrace", "time", "stepi 30", "back-instruction 30", "time"])
        self.assertRegex(said[2], r"in main \(\S+\.c:\d+\)")
        self.assertIn(".c:", said[3])
        self.assertEqual(said[8].replace(", in the past", ""), said[5])

    def test_lines_of_c30(self):
        image = pathlib.Path(IMAGES) / "randb.cof"
        if not image.exists():
            self.skipTest(f"{image} is not there")
        said = self.debug(image, script=["break main", "continue", "next", "next", "back", "time", "stepi 50", "back-instruction 50",
                                         "time", "break registers.c:31", "continue", "backtrace"])
        self.assertRegex(said[2], r"in main \(randb.c:\d+\)")
        self.assertEqual(said[5].splitlines()[0], said[3].splitlines()[0])
        self.assertEqual(said[9], said[6])
        self.assertIn("in init_registers", said[11])
        self.assertRegex(said[12], r"#0 .*init_registers.*registers.c:31.*\n #1 .*in init_I2C.*\n #2 .*in main")
        self.assertNotRegex("".join(said), "[\x01-\x08]")


if __name__ == "__main__":
    unittest.main()
