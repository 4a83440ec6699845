"""Commands of puckloop that a call runs."""

from __future__ import annotations

import pathlib
import subprocess
import tempfile
from typing import Sequence

from ..launch import program
from .folders import Refused
from .runs import Call, Cancelled

_POLL_SECONDS = 0.05
_END_SECONDS = 10  # of wall time, for a command to end when it is asked to


def ended(words: Sequence[str], call: Call, folder: pathlib.Path, most: int | None = None) -> tuple[int, str, str]:
    """Status, output (its last `most` lines) and errors of a command in a folder. Cancelled: it was ended."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([program(), *words], stdin=subprocess.DEVNULL, stdout=out, stderr=errors, cwd=folder)
        try:
            while True:
                try:
                    process.wait(_POLL_SECONDS)
                    break
                except subprocess.TimeoutExpired:
                    call.look()
        except Cancelled:
            process.terminate()
            try:
                process.wait(_END_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            raise
        out.seek(0)
        errors.seek(0)
        lines: list[bytes] = []
        for line in out:
            lines.append(line)
            if most is not None and len(lines) > 2 * most:
                del lines[:-most]
        kept = b"".join(lines if most is None else lines[-most:])
        return process.returncode, kept.decode(errors="replace"), errors.read().decode(errors="replace")


def why(status: int, errors: str) -> str:
    """The line that a command ended with."""
    said = errors.strip().splitlines()
    return said[-1].removeprefix("puckloop: ") if said else f"puckloop ended with status {status}"


def checked(words: Sequence[str], call: Call, folder: pathlib.Path, most: int | None = None) -> str:
    """The output. Refused: it failed, with its last line."""
    status, out, errors = ended(words, call, folder, most)
    if status != 0:
        raise Refused(why(status, errors or out))
    return out
