"""`puckloop view --export FILE.mp4`: films of a recorded run."""

import pathlib
import shutil
import subprocess
import unittest

from browser import find_chromium
from kit import SOURCE, InFolder, puckloop


class Film(InFolder):
    def test_a_film_has_its_pictures(self):
        if not find_chromium() or not shutil.which("ffmpeg"):
            self.skipTest("Chromium or ffmpeg is not installed")
        out = self.folder / "recorded"
        ended = puckloop("run", SOURCE / "scenarios/hello.toml", "--in-process", "--duration", 2, "--out", out)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        for name in ("a.mp4", "a.webm"):
            file = self.folder / name
            ended = puckloop("view", out, "--export", file, "--part", "arena", "--size", "601x500", "--fps", 5,
                             "--speed", 2, "--begin", "0.4")
            self.assertEqual((ended.returncode, ended.stdout.strip()), (0, str(file)), ended.stderr)
            said = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                                   "stream=nb_read_frames,r_frame_rate", "-of", "csv=p=0", file],
                                  capture_output=True, text=True, check=True).stdout.strip()
            self.assertEqual(said, "5/1,5")  # 0.4, 0.8, ... 2.0 s
            self.assertFalse(pathlib.Path(f"{file}.part").exists())


if __name__ == "__main__":
    unittest.main()
