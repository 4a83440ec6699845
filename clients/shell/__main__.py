"""python3 clients/shell PROGRAM FOLDER: completion scripts and manual pages of a puckloop, under FOLDER/share.

    share/bash-completion/completions/puckloop
    share/zsh/vendor-completions/_puckloop
    share/fish/vendor_completions.d/puckloop.fish
    share/man/man1/puckloop.1, puckloop-run.1, ...

Of puckloop-mpi: its manual pages alone.
"""

from __future__ import annotations

import pathlib
import re
import subprocess
import sys

import completions
import man_pages
import tables


def version_of(program: str) -> str:
    said = subprocess.run([program, "--version"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          check=False).stdout
    found = re.match(r"puckloop(?:-mpi)? (\d+\.\d+\.\d+)\b", said)
    if not found:
        raise tables.Unreadable("is no puckloop that states its version")
    return found[1]


def main() -> int:
    if len(sys.argv) != 3:
        print("usage: python3 clients/shell PROGRAM FOLDER", file=sys.stderr)
        return 2
    program, share = sys.argv[1], pathlib.Path(sys.argv[2]) / "share"
    try:
        version = version_of(program)
        commands = tables.read(program)
        name = commands[0].usage.split(" ")[0]
        made = [(f"man/man1/{man_pages.page_name(one.words, name)}.1", man_pages.page(one, commands, version, name))
                for one in commands]
        if name == "puckloop":
            made += [("bash-completion/completions/puckloop", completions.bash(commands)),
                     ("zsh/vendor-completions/_puckloop", completions.zsh(commands)),
                     ("fish/vendor_completions.d/puckloop.fish", completions.fish(commands))]
        for place, text in made:
            file = share / place
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
    except OSError as error:
        print(f"puckloop: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    except tables.Unreadable as error:
        print(f"puckloop: {program}: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
