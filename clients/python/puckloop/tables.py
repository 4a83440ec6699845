"""Results of a run as records, or as data frames where pandas is installed."""

from __future__ import annotations

import csv
import dataclasses
import importlib
import os
import pathlib
from typing import Any, Iterable, Mapping

from .errors import PuckloopError


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


def dataframe(rows: Iterable[Any]) -> Any:
    """A pandas.DataFrame of what table(), Run.frames() and the like give. PuckloopError: pandas is not installed."""
    try:
        pandas = importlib.import_module("pandas")
    except ImportError:
        raise PuckloopError("data frames need pandas (Debian: python3-pandas)") from None
    return pandas.DataFrame([dict(row) if isinstance(row, Mapping) else dataclasses.asdict(row) for row in rows])
