"""Results of a run as records, or as data frames where pandas is installed."""

from __future__ import annotations

import csv
import dataclasses
import importlib
import json
import os
import pathlib
import subprocess
from typing import Any, Iterable, Mapping

from .errors import PuckloopError
from .launch import program
from .records import Decoded


def _cell(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def table(results: str | os.PathLike[str], name: str) -> list[dict[str, float | str]]:
    """Rows of a CSV file of a results folder: table(run.results, "trajectory"). Numbers are floats.

    PuckloopError: there is no such table, with those that there are; or it cannot be read.
    """
    folder = pathlib.Path(results)
    file = folder / (name if name.endswith(".csv") else name + ".csv")
    if not file.is_file():
        there = sorted(one.stem for one in folder.glob("*.csv")) if folder.is_dir() else []
        raise PuckloopError(f"{file}: there is no such table" + (f"; there are {', '.join(there)}" if there else ""))
    with open(file, newline="", encoding="utf-8") as rows:
        # The bytes of a trace are texts: "10" is not ten.
        texts = {"value"} if file.name in ("trace.csv", "record.csv") else set()
        return [{key: value if key in texts else _cell(value) for key, value in row.items() if key is not None}
                for row in csv.DictReader(rows)]


def decode_words(results: str | os.PathLike[str], protocol: str | None, link: str | None, sender: str | None) -> list[str]:
    """The command that decoded() is."""
    chosen = [("--protocol", protocol), ("--link", link), ("--from-node", sender)]
    return [program(), "trace", "decode", os.fspath(results), "--json",
            *[word for option, value in chosen if value is not None for word in (option, value)]]


def decoded_rows(status: int, output: bytes, error: bytes) -> list[Decoded]:
    """What that command printed. PuckloopError: its line."""
    if status != 0:
        raise PuckloopError(error.decode(errors="replace").strip().removeprefix("puckloop: ") or f"status {status}")
    return [Decoded.of(json.loads(line)) for line in output.splitlines()]


def decoded(results: str | os.PathLike[str], protocol: str | None = None, *, link: str | None = None,
            sender: str | None = None) -> list[Decoded]:
    """Frames by protocol in a results folder's trace, in the order in which they were complete.

    Without `protocol` those of all. PuckloopError: no trace, or an unknown name.
    """
    done = subprocess.run(decode_words(results, protocol, link, sender), capture_output=True, check=False)
    return decoded_rows(done.returncode, done.stdout, done.stderr)


def dataframe(rows: Iterable[Any]) -> Any:
    """A pandas.DataFrame of what table(), Run.frames(), decoded() and the like give. PuckloopError: pandas is not installed."""
    try:
        pandas = importlib.import_module("pandas")
    except ImportError:
        raise PuckloopError("data frames need pandas (Debian: python3-pandas)") from None
    return pandas.DataFrame([dict(row) if isinstance(row, Mapping) else dataclasses.asdict(row) for row in rows])
