"""The commands of all pages, as a reader types them: each has options that there are, and is carried out, or it is
listed here with the reason why not. The how-to pages, which tell a story each, are howto_test.py's."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

from kit import PROGRAM, SOURCE, InFolder, typed_in

PAGES = [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]
IMAGES = pathlib.Path(os.environ.get("PUCKLOOP_IMAGES", "/nowhere"))

# Why a command is not carried out here; by a part of it. The first that fits counts.
LAUNCHER = "the launcher's own, which builds and installs"
LIVE = "goes on until somebody ends it, or speaks to a terminal"
LONG = "takes minutes to hours; a test of its own does less of it"
GIVEN = "its file is the reader's: one for each place in capitals, measured data, a real program"
REASONS = [
    (r"^puckloop (test|package|release|docs|images$|new )", LAUNCHER),
    (r"[A-Z]{3,}_?[A-Z]* |\[--|=\$!|DIR --out OUT", GIVEN),
    (r"--uart1 (pty|-)|--view|--shell|^puckloop (shell|act|mcp|view [^-]*$|view \S+ --at|debug)|--gdb|--control|wireshark|--live|"
     r"/dev/pts|\| less|--paced|X=", LIVE),
    (r"^puckloop (bench|experiment|gap|faults)|swarm.toml|argos |foraging|--export \S+mp4|--peer", LONG),
    (r"my_controller|\./controller|\./drive|team.toml --paced|mine.toml|net.toml|scenario.toml|air.txt|view.ppm|"
     r"script:|scriptbus|changed.hex|optiboot|floor.txt|visit.txt|e_init_port|out/gap/overlay|out/own_rab|levels/w|remember|other/|out/tam ", GIVEN),
]


def commands_of(page):
    return (re.sub(r"\s+", " ", command) for command in typed_in(page, "puckloop .*|printf .* >.*"))


def reason_of(command):
    return next((reason for part, reason in REASONS if re.search(part, command)), None)


class Options(unittest.TestCase):
    def test_every_option_of_every_page_is_one_of_its_command(self):
        helps = {}
        for page in PAGES:
            for command in commands_of(page):
                if reason_of(command) is LAUNCHER or command.startswith("printf"):
                    continue
                words = re.split(r" [|<>&] ?|;", command)[0].replace("'", "").replace('"', "").split()[1:]
                words = words[:words.index("--linux") + 1] if "--linux" in words else words  # the program has its own
                names = [word.split("=")[0] for word in words if re.match(r"--?[a-z]", word)]
                path = [words[0]] + [word for word in words[1:2] if re.fullmatch("[a-z]+", word)]
                while path:
                    key = tuple(path)
                    if key not in helps:
                        ended = subprocess.run([PROGRAM, *path, "--help"], capture_output=True, text=True, check=False)
                        helps[key] = ended.stdout if ended.returncode == 0 else ""
                    missing = [name for name in names if not re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", helps[key])]
                    if helps[key] and not missing:
                        break
                    path.pop()
                with self.subTest(page=page.name, command=command):
                    self.assertTrue(path, f"unknown: {missing}")


class Commands(InFolder):
    def prepare(self):
        for name in ("scenarios", "firmware", "campaigns", "docs"):
            os.symlink(SOURCE / name, self.folder / name)
        os.symlink(PROGRAM, self.folder / "puckloop")
        for image in IMAGES.glob("*.hex"):
            shutil.copy(image, self.folder)
        for name, image in (("tinybld.hex", "tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex"),):
            if (IMAGES / image).exists():
                shutil.copy(IMAGES / image, self.folder / name)
        self.file("events.txt", "0.1 selector 3\n")
        self.file("script.txt", "continue\n")
        self.file("program.s", "        goto start\n        .org 0x100\nstart:  bra start\n")
        self.file("blink.s", "start:  rjmp start\n")

    def image_for(self, command):
        """`firmware.elf` and `lamp.elf` of the pages are the reader's."""
        avr = "atmega1284p" in command or "tam" in command
        own = SOURCE / "firmware/start/firmware.elf"
        tam = pathlib.Path(PROGRAM).parents[1] / "firmware/tam/tam.elf"
        if avr and not tam.exists():
            return False
        for name in ("firmware.elf", "lamp.elf", "tam_firmware.elf", "firmware.hex"):
            shutil.copy(tam if avr else own, self.folder / name)
        return True

    def test_every_command_of_every_page_is_carried_out_or_listed(self):
        self.prepare()
        done, waiting = 0, []
        used = set()
        for page in PAGES:
            for command in commands_of(page):
                if command.startswith("printf"):  # writes a file that the page's next command reads
                    subprocess.run(["bash", "-c", command], cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
                    continue
                reason = reason_of(command)
                if reason is not None:
                    used.add(next(part for part, _ in REASONS if re.search(part, command)))
                    continue
                images = [word for word in re.findall(r"[\w]+\.hex", command) if not word.startswith(("program", "blink", "firmware"))]
                missing = [image for image in images if not (self.folder / image).exists() and
                           not list((SOURCE / "firmware").glob(f"*/{image}"))]
                if missing or not self.image_for(command):
                    waiting.append(command)  # third-party images: with PUCKLOOP_IMAGES
                    continue
                # A first second shows that it runs.
                short = command + " --duration 1" if re.match(r"puckloop run (?!--from)", command) and "--duration" not in command else command
                with self.subTest(page=page.name, command=short):
                    ended = subprocess.run(["bash", "-c", "./" + short], cwd=self.folder, capture_output=True, text=True,
                                           stdin=subprocess.DEVNULL, timeout=300, check=False)
                    self.assertEqual(ended.returncode, 0, ended.stdout[-800:] + ended.stderr[-800:])
                done += 1
        # Most need nothing from elsewhere; an image that no folder has is seen here, a regular expression that finds nothing too.
        self.assertGreater(done, len(waiting), waiting)
        self.assertGreater(done + len(waiting), 40)
        if IMAGES.is_dir():
            self.assertEqual(waiting, [])
        self.assertEqual({part for part, _ in REASONS} - used, set(), "reasons that no command has")


if __name__ == "__main__":
    unittest.main()
