"""The client's types, by mypy."""

import os
import pathlib
import subprocess
import unittest

from kit import SOURCE

MYPY = pathlib.Path("/usr/bin/mypy")  # Debian's, which finds Debian's pytest


class Types(unittest.TestCase):
    def test_mypy_strict(self):
        if not MYPY.is_file():
            self.skipTest("there is no mypy (Debian: mypy)")
        ended = subprocess.run([str(MYPY), "--strict", "--python-version", "3.11", "--cache-dir", os.devnull,
                                str(SOURCE / "clients" / "python" / "puckloop")], capture_output=True, text=True,
                               cwd="/", check=False)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)


if __name__ == "__main__":
    unittest.main()
