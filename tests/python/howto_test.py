"""The how-to pages' commands, page by page and in their order, as a reader types them."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

from kit import PROGRAM, SOURCE, InFolder, typed_in

HOWTO = SOURCE / "docs" / "howto"
MINUTES = 5  # of wall time, for one command


def commands_of(page):
    """But for those that go on until somebody ends them."""
    return list(typed_in(page, r"(?:puckloop|cd|python3|tail|sed) (?:(?!Ctrl-C).)*"))


def bytes_of(image):
    """Of an Intel HEX file, by address."""
    found, high = {}, 0
    for line in image.read_text().split():
        record = bytes.fromhex(line[1:])
        place, kind, content = int.from_bytes(record[1:3], "big"), record[3], record[4:-1]
        if kind == 4:
            high = int.from_bytes(content, "big") << 16
        elif kind == 0:
            found.update({high + place + i: byte for i, byte in enumerate(content)})
    return found


class Pages(InFolder):
    def prepare(self, text):
        """What a page says the reader has: files named before a block, an image with its sources, `hello` with more."""
        shutil.copy(SOURCE / "firmware" / "epuck" / "epuck.elf", self.folder / "firmware.elf")
        shutil.copytree(SOURCE / "firmware" / "epuck", self.folder / "src")
        for name, content in re.findall(r"in `(\S+)`:\n\n```\w+\n(.*?)```", text, re.DOTALL):
            self.file(name, content)
        for content in re.findall(r"```toml\n(.*?)```", text, re.DOTALL):
            shipped = (SOURCE / "scenarios" / "hello.toml").read_text().replace("../firmware/epuck/epuck.hex", "own")
            self.file("wake.toml", shipped + "\n" + content)
        (self.folder / "bin").mkdir()
        os.symlink(PROGRAM, self.folder / "bin" / "puckloop")

    def check_page(self, name, least):
        self.prepare((HOWTO / name).read_text())
        commands = commands_of(HOWTO / name)
        self.assertGreaterEqual(len(commands), least)
        for command in commands:
            if "pytest" in command:
                if subprocess.run(["/usr/bin/python3", "-c", "import pytest"], capture_output=True, check=False).returncode != 0:
                    continue
                command = command.replace("python3", "/usr/bin/python3 -B")
            ended = subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True, stdin=subprocess.DEVNULL,
                                   timeout=60 * MINUTES, check=False,
                                   env={**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
                                        "PUCKLOOP": "puckloop", "PYTHONPATH": str(SOURCE / "clients" / "python")})
            self.assertEqual(ended.returncode, 0, f"{name}: {command}\n{ended.stdout[-2000:]}{ended.stderr[-2000:]}")

    def test_first(self):
        self.check_page("first.md", 7)
        self.assertGreater((self.folder / "hello.html").stat().st_size, 10000)

    def test_hang(self):
        self.check_page("hang.md", 4)

    def test_stands_still(self):
        self.check_page("stands_still.md", 3)

    def test_controller(self):
        self.check_page("controller.md", 5)

    def test_ci(self):
        self.check_page("ci.md", 2)
        self.assertIn("it stays awake", (self.folder / "results.xml").read_text())

    def test_own_firmware(self):
        self.check_page("own_firmware.md", 5)
        self.assertIn("its clock runs", (self.folder / "results.xml").read_text())

    def test_lost_frames(self):
        self.check_page("lost_frames.md", 5)

    def test_faults(self):
        self.check_page("faults.md", 3)

    def test_twenty_robots(self):
        self.check_page("twenty_robots.md", 3)

    def test_odometry(self):
        if subprocess.run([PROGRAM, "gap", "--help"], capture_output=True, check=False).returncode != 0:
            self.skipTest("puckloop-gap is not built")
        self.check_page("odometry.md", 3)
        for name in ("report.html", "overlay.toml"):
            self.assertTrue((self.folder / "answer" / name).is_file(), name)

    def test_boot_loader(self):
        images = pathlib.Path(os.environ.get("PUCKLOOP_IMAGES", "/nowhere"))
        boot = images / "tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex"
        if not boot.exists():
            self.skipTest("PUCKLOOP_IMAGES names no folder with the boot loader's image")
        shutil.copy(boot, self.folder / "boot.hex")
        shutil.copy(SOURCE / "firmware" / "epuck" / "epuck.hex", self.folder / "my_firmware.hex")
        self.check_page("boot_loader.md", 5)
        # What was uploaded is in the flash: all but the reset vector, which the boot loader keeps for itself.
        kept, own = bytes_of(self.folder / "robot.hex"), bytes_of(self.folder / "my_firmware.hex")
        program = {place: byte for place, byte in own.items() if 0x200 <= place < 0x100000}
        self.assertGreater(len(program), 2000)
        self.assertEqual({place: kept.get(place) for place in program}, program)

    def test_every_page_is_tested_and_listed(self):
        pages = {page.name for page in HOWTO.glob("*.md")} - {"README.md"}
        tested = {name.removeprefix("test_") + ".md" for name in dir(self) if name.startswith("test_")}
        self.assertEqual(pages - tested, set())
        listed = set(re.findall(r"\((\w+\.md)\)", (HOWTO / "README.md").read_text()))
        self.assertEqual(listed, pages)


class Site(InFolder):
    """The pages as a site: no warning, so that each link leads somewhere."""

    def test_site(self):
        if shutil.which("sphinx-build") is None or \
                subprocess.run(["/usr/bin/python3", "-c", "import myst_parser, sphinx_rtd_theme"], capture_output=True, check=False).returncode:
            self.skipTest("sphinx-build, python3-myst-parser or python3-sphinx-rtd-theme is not installed")
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        ended = subprocess.run(["sphinx-build", "-q", "-W", "--keep-going", "-c", SOURCE / "docs" / "site", "-d", self.folder / "cache",
                                "-b", "html", SOURCE, self.folder / "made"], capture_output=True, text=True, check=False, env=environment)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""), ended.stdout)
        first = (self.folder / "made" / "docs" / "site" / "index.html").read_text()
        for text in ("puckloop run hello", "How to", "Scenario"):
            self.assertIn(text, first)
        self.assertTrue((self.folder / "made" / "index.html").is_file())


if __name__ == "__main__":
    unittest.main()
