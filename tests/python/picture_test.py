"""`puckloop view --png`: what the page shows, as pictures; held against golden ones with a tolerance.

PUCKLOOP_WRITE_PICTURES=1 writes the golden ones again; look at them before you keep them.
"""

import os
import unittest

import png
from browser import find_chromium
from kit import SOURCE, InFolder, puckloop

GOLDEN = SOURCE / "tests/python/pictures"
# Of blocks of 16 x 16 pixels. The same browser draws none otherwise; of the arena 0.8 % are others half a second
# earlier and 1.9 % at the begin. Where there is much text another font may change some.
MOST_OF_ARENA, MOST_OF_TEXT = 0.005, 0.02


class Pictures(InFolder):
    @classmethod
    def setUpClass(cls):
        if not find_chromium():
            raise unittest.SkipTest("no chromium is installed")

    def run_of(self, scenario, seconds):
        out = self.folder / "recorded"
        ended = puckloop("run", SOURCE / "scenarios" / scenario, "--in-process", "--duration", seconds, "--out", out)
        self.assertTrue((out / "trace.csv").exists(), ended.stderr)
        return out

    def picture(self, out, time, *options):
        file = self.folder / "picture.png"
        file.unlink(missing_ok=True)
        ended = puckloop("view", out, "--png", time, "--export", file, *options)
        self.assertEqual((ended.returncode, ended.stdout.strip()), (0, str(file)), ended.stderr)
        return file.read_bytes()

    def golden(self, name, picture, most):
        file = GOLDEN / f"{name}.png"
        if os.environ.get("PUCKLOOP_WRITE_PICTURES"):
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(picture)
        self.assertLessEqual(png.apart(picture, file.read_bytes()), most, file)

    def test_pictures_are_the_golden_ones(self):
        out = self.run_of("rab_pair.toml", 4)
        arena = self.picture(out, 3.5, "--part", "arena", "--size", "1100x800")
        self.golden("arena", arena, MOST_OF_ARENA)
        self.golden("timeline", self.picture(out, 3.5, "--part", "timeline", "--size", "1100x800"), MOST_OF_TEXT)
        page = self.picture(out, 3.5, "--dark", "--size", "1100x800")
        self.assertEqual(png.read(page)[:2], (1100, 800))
        self.golden("page", page, MOST_OF_TEXT)
        # The tolerance is one that other pictures do not keep to.
        self.assertGreater(png.apart(self.picture(out, 3, "--part", "arena", "--size", "1100x800"), arena),
                           MOST_OF_ARENA)
        self.assertGreater(png.apart(self.picture(out, 3.5, "--size", "1100x800"), page), 0.5)
        self.assertEqual(png.apart(page, arena), 1.0)

    def test_the_time_is_the_one_that_was_asked_for(self):
        out = self.run_of("hello.toml", 4)
        early, late = (self.picture(out, time, "--part", "arena") for time in (0, 4))
        # Edges of letters may be smoothed otherwise from one time to the next.
        self.assertEqual(png.apart(early, self.picture(out, 0, "--part", "arena")), 0)
        self.assertGreater(png.apart(early, late), 0)
        named = puckloop("view", out, "--png", 1, folder=self.folder)
        self.assertEqual(named.returncode, 0, named.stderr)
        self.assertTrue((self.folder / "recorded.png").is_file())

    def test_what_is_refused(self):
        out = self.run_of("hello.toml", 1)
        for words, parts in ((("--png", 3), ("the run ends at 1 s",)),
                             (("--png", -1), ("--png",)),
                             (("--png", "x"), ("--png",)),
                             (("--export", "a.png"), ("--png TIME",)),
                             (("--export", "a.html", "--png", 1), ("no file of a picture",)),
                             (("--png", 1, "--fps", 3), ("--fps", "does not go")),
                             (("--export", "a.html", "--dark"), ("--dark", "does not go")),
                             (("--part", "arena"), ("--part", "does not go")),
                             (("--png", 1, "--part", "robot"), ("--part",)),
                             (("--png", 1, "--size", "100x100"), ("is no size",)),
                             (("--png", 1, "--size", "900"), ("is no size",)),
                             (("--export", "a.mp4", "--begin", 1), ("is not after",)),
                             (("--export", "a.mp4", "--end", 2), ("the run ends at 1 s",)),
                             (("--export", "nowhere/a.mp4"), ("nowhere",))):
            self.refused(puckloop("view", out, *words, folder=self.folder), *parts)
        self.assertEqual(sorted(file.name for file in self.folder.iterdir()), ["recorded"])

    def test_without_a_browser_or_ffmpeg_the_remedy_is_named(self):
        out = self.run_of("hello.toml", 1)
        nothing = {"PATH": str(self.folder)}
        self.refused(puckloop("view", out, "--png", 1, "--export", self.folder / "a.png", env=nothing),
                     "apt install chromium")
        (self.folder / "chromium").symlink_to(find_chromium())
        # The browser's own script may need more than it finds here: then it is the browser that fails.
        ended = puckloop("view", out, "--export", self.folder / "a.mp4", env=nothing)
        self.assertNotEqual(ended.returncode, 0)
        self.assertFalse((self.folder / "a.mp4").exists() or (self.folder / "a.mp4.part").exists())


if __name__ == "__main__":
    unittest.main()
