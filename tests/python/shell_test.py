"""Completion scripts and manual pages of clients/shell, in bash, zsh, fish and man."""

import os
import pty
import re
import select
import shutil
import subprocess
import sys
import time
import unittest

from kit import PROGRAM, SOURCE, InFolder, puckloop

ZSH_SECONDS = 30  # of wall time, for one completion


def flags_of(*words):
    """Names of a command's options, read from its help by their place alone."""
    found = set()
    for line in puckloop(*words, "--help").stdout.splitlines():
        entry = re.match(r"  (-\S+)", line)
        if entry:
            found.update(name.rstrip(",") for name in re.sub(r"\{\w+\}", "", entry[1]).split(",") if name)
    return found


class Shell(InFolder):
    def setUp(self):
        super().setUp()
        ended = subprocess.run([sys.executable, "-B", str(SOURCE / "clients" / "shell"), PROGRAM, str(self.folder)],
                               capture_output=True, text=True, check=False)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.share = self.folder / "share"
        # What scripts ask the program itself.
        (self.folder / "bin").mkdir()
        os.symlink(PROGRAM, self.folder / "bin" / "puckloop")
        self.environment = {**os.environ, "PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
                            "HOME": str(self.folder), "XDG_CONFIG_HOME": str(self.folder), "TERM": "vt100"}

    def needs(self, tool):
        if shutil.which(tool) is None:
            self.skipTest(f"there is no {tool}")

    def shell(self, *words):
        ended = subprocess.run(words, capture_output=True, text=True, cwd=self.folder, env=self.environment,
                               timeout=120, check=False)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        return ended.stdout.splitlines()

    def bash(self, *words):
        script = self.share / "bash-completion" / "completions" / "puckloop"
        return self.shell("bash", "-c", f'source "{script}"; COMP_WORDS=(puckloop "$@"); COMP_CWORD=$#; _puckloop; '
                          'printf "%s\\n" "${COMPREPLY[@]}"', "bash", *words)

    def test_bash(self):
        self.assertEqual(set(self.bash("tr")), {"trace"})
        self.assertIn("mcp", self.bash(""))
        self.assertEqual(set(self.bash("trace", "")) & {"decode", "export", "rab"}, {"decode", "export", "rab"})
        for words in (["run"], ["exec"], ["trace", "decode"], ["frames", "epuck", "decode"], ["faults", "campaign"]):
            self.assertEqual(set(self.bash(*words, "-")), flags_of(*words), words)
        self.assertEqual(self.bash("trace", "decode", "--protocol", "x"), ["xbee"])
        self.assertEqual(set(self.bash("run", "--seed", "")), {""})  # any number
        self.assertIn("hello", self.bash("run", "hel"))
        self.file("mine.toml", "")
        self.assertIn("mine.toml", self.bash("run", "mi"))
        self.assertIn("scenario", self.bash("schema", ""))
        self.assertIn("decode", self.bash("frames", "--help", "rab", "d"))  # options between the words

    def fish(self, line):
        script = self.share / "fish" / "vendor_completions.d" / "puckloop.fish"
        return {one.split("\t")[0] for one in
                self.shell("fish", "--no-config", "-c", f"source '{script}'; complete -C '{line}'")}

    def test_fish(self):
        self.needs("fish")
        self.assertEqual(self.fish("puckloop tr"), {"trace"})
        self.assertTrue({"decode", "export", "rab"} <= self.fish("puckloop trace "))
        for words in (["run"], ["exec"], ["trace", "decode"], ["frames", "epuck", "decode"]):
            line = "puckloop " + " ".join(words)
            self.assertEqual(self.fish(line + " --"), {name for name in flags_of(*words) if name.startswith("--")})
        self.assertEqual(self.fish("puckloop trace decode --protocol x"), {"xbee"})
        self.assertIn("hello", self.fish("puckloop run hel"))

    def test_zsh(self):
        self.needs("zsh")
        place = self.share / "zsh" / "vendor-completions"
        pid, terminal = pty.fork()
        if pid == 0:
            os.chdir(self.folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], self.environment)
        self.addCleanup(os.waitpid, pid, 0)
        self.addCleanup(os.close, terminal)

        def said_after(text, wanted):
            os.write(terminal, text.encode())
            end, said = time.monotonic() + ZSH_SECONDS, ""
            while time.monotonic() < end:
                if select.select([terminal], [], [], 0.2)[0]:
                    said += os.read(terminal, 65536).decode(errors="replace")
                    said = re.sub("\x1b\\[[0-9;?]*[A-Za-z]|\x00", "", said)  # colours, padding
                if wanted in said:
                    return
            self.fail(f"zsh does not show {wanted!r} for {text!r}, but {said!r}")

        said_after(f"PS1=$'\\x40@>' RPS1= ; unsetopt beep; fpath=({place} $fpath); autoload -U compinit; compinit -u -D\n",
                   "@@>")
        for typed, shown in (("puckloop trac\t", "trace "), ("dec\t", "decode "), ("--from-n\t", "--from-node "),
                             ("\x15puckloop frames epuck dec\t", "decode "),
                             ("\x15puckloop run --trace-f\t", "--trace-format "), ("pc\t", "pcapng "),
                             ("\x15puckloop run hel\t", "hello "), ("\x15puckloop sche\t", "schema "),
                             ("camp\t", "campaign ")):
            said_after(typed, shown[len(typed.rsplit(" ", 1)[-1].strip("\t\x15")):])
        os.write(terminal, b"\x15exit\n")

    def test_manual_pages(self):
        self.needs("man")
        pages = {file.stem: file for file in (self.share / "man" / "man1").glob("*.1")}
        for name in ("puckloop", "puckloop-run", "puckloop-trace-decode", "puckloop-mcp"):
            self.assertIn(name, pages)
        for name, file in pages.items():
            ended = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", str(file)],
                                   capture_output=True, text=True, check=False,
                                   env={**self.environment, "MANWIDTH": "100", "MANROFFOPT": "-c"})
            self.assertEqual((ended.returncode, ended.stderr), (0, ""), name)
            shown = re.sub(".\x08", "", ended.stdout)  # without what makes it bold
            if name == "puckloop-run":
                for flag in flags_of("run"):
                    self.assertIn(flag, shown)
                for part in ("What runs", "EXAMPLES", "puckloop run hello", "--trace-format {sr,pcapng,vcd} ..."):
                    self.assertIn(part, shown)

    def test_what_cannot_be_read(self):
        for program, text in (("/bin/true", "is no puckloop"), (str(self.folder / "nothing"), "No such file")):
            ended = subprocess.run([sys.executable, "-B", str(SOURCE / "clients" / "shell"), program,
                                    str(self.folder / "other")], capture_output=True, text=True, check=False)
            self.refused(ended, text)
        self.assertFalse((self.folder / "other").exists())


if __name__ == "__main__":
    unittest.main()
