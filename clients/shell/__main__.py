"""python3 clients/shell PROGRAM FOLDER: completion scripts and manual pages of a puckloop, under FOLDER/share.

    share/bash-completion/completions/puckloop
    share/zsh/vendor-completions/_puckloop
    share/fish/vendor_completions.d/puckloop.fish
    share/man/man1/puckloop.1, puckloop-run.1, ...
"""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys

import completions
import man_pages
import tables


def version_of(program: str) -> str:
    said = subprocess.run([program, "version", "--json"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          check=False).stdout
    try:
        return str(json.loads(said)["version"])
    except (ValueError, KeyError):
        raise tables.Unreadable("is no puckloop that states its version") from None


def main() -> int:
    if len(sys.argv) != 3:
        print("usage: python3 clients/shell PROGRAM FOLDER", file=sys.stderr)
        return 2
    program, share = sys.argv[1], pathlib.Path(sys.argv[2]) / "share"
    try:
        version = version_of(program)
        commands = tables.read(program)
        for place, text in (("bash-completion/completions/puckloop", completions.bash(commands)),
                            ("zsh/vendor-completions/_puckloop", completions.zsh(commands)),
                            ("fish/vendor_completions.d/puckloop.fish", completions.fish(commands)),
                            *((f"man/man1/{man_pages.page_name(one.words)}.1",
                               man_pages.page(one, commands, version)) for one in commands)):
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
