"""Runs of shipped scenarios, exported, and what sigrok-cli and tshark make of them."""

import os
import re
import shutil
import subprocess

from kit import SOURCE, InFolder, puckloop


class Exported(InFolder):
    """A test of files that another program reads; skipped without `tool`."""

    tool = ""

    def setUp(self):
        super().setUp()
        if shutil.which(self.tool) is None:
            self.skipTest(f"there is no {self.tool}: nothing reads the exported files")

    def succeeds(self, ended):
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        return ended.stdout

    def run_of(self, name, *words, keys=""):
        """The results folder of a shipped scenario, with `keys` added to its [run]."""
        text = (SOURCE / "scenarios" / f"{name}.toml").read_text()
        text = text.replace('"../firmware', f'"{SOURCE}/firmware').replace("[run]", f"[run]\n{keys}", 1)
        out = self.folder / f"out-{name}"
        self.succeeds(puckloop("run", self.file(f"{name}.toml", text), "--in-process", "--out", out, *words))
        return out

    def export(self, out, ending):
        file = out.with_suffix("." + ending)
        self.succeeds(puckloop("trace", "export", out, "-o", file))
        return file

    def decoded(self, out, *words):
        """Lines of `trace decode` without time, link and sender: (text, what is wrong)."""
        lines = self.succeeds(puckloop("trace", "decode", out, *words)).splitlines()
        parts = [re.sub(r"^\S+ \S+ \S+ \S+: ", "", line).split("  !! ", 1) for line in lines]
        return [(part[0], part[1] if len(part) > 1 else "") for part in parts]

    def called(self, *words, **environment):
        return subprocess.run([self.tool, *map(str, words)], capture_output=True, text=True, cwd=self.folder,
                              env={**os.environ, **environment}, timeout=300, check=False)
