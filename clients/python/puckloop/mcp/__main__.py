"""python3 -m puckloop.mcp [--folder DIR]..."""

import argparse
import json
import os
import pathlib
import subprocess
import sys

from ..errors import PuckloopError, StartError
from ..launch import program
from .folders import Folders
from .runs import Runs
from .server import Server
from .tools import Toolbox


def version_of(path: str) -> str:
    """StartError: it is no puckloop."""
    try:
        ended = subprocess.run([path, "version", "--json"], stdin=subprocess.DEVNULL, capture_output=True, check=False)
        return str(json.loads(ended.stdout)["version"])
    except OSError as error:
        raise StartError(f"{path}: {error.strerror}") from None
    except (ValueError, KeyError):
        raise StartError(f"{path}: is no puckloop that states its version") from None


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="puckloop mcp", description="server of the Model Context Protocol on standard input and output")
    parser.add_argument("--folder", metavar="DIR", action="append", default=[],
                        help="folder of which files may be named, such as scenarios and snapshots; results go into "
                             "out/mcp of the first (repeatable; default: the current one)")
    chosen = parser.parse_args()
    try:
        version = version_of(program())
        folders = Folders([pathlib.Path(one) for one in chosen.folder] or [pathlib.Path.cwd()])
    except PuckloopError as error:
        print(f"puckloop: mcp: {error}", file=sys.stderr)
        return 2
    # What libraries or children print must not get between the messages.
    messages = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    runs = Runs(folders)
    return Server(Toolbox(runs, folders), version, sys.stdin.buffer, messages).serve()


if __name__ == "__main__":
    sys.exit(main())
