"""A scenario that is made in code."""

from __future__ import annotations

import copy
import pathlib
import re
import tomllib
from typing import Any, Mapping


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, pathlib.PurePath)):
        text = str(value).replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c >= " " else f"\\u{ord(c):04x}" for c in text) + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(one) for one in value) + "]"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(one)}" for key, one in value.items()) + " }"
    raise TypeError(f"a scenario holds no {type(value).__name__}")


def _key(key: str) -> str:
    return key if re.fullmatch("[A-Za-z0-9_-]+", key) else _value(key)


class Scenario:
    """Tables and keys as docs/scenario.md has them; quantities are texts with a unit.

        scenario = Scenario(run={"duration": "5 s"}, arena={"size": ["1 m", "1 m"]})
        scenario.add("robot", position=["0 m", "0 m"], pic={"firmware": "own"})
    """

    def __init__(self, **tables: Mapping[str, Any]) -> None:
        self.tables: dict[str, Any] = {name: dict(table) for name, table in tables.items()}

    @staticmethod
    def load(file: str | pathlib.Path) -> Scenario:
        """Reads a file. Relative paths of firmware in it are made absolute, so that it may be written elsewhere.

        OSError, tomllib.TOMLDecodeError.
        """
        path = pathlib.Path(file)
        scenario = Scenario()
        scenario.tables = tomllib.loads(path.read_text(encoding="utf-8"))
        for robot in scenario.tables.get("robot", []):
            for board in (robot.get("pic"), robot.get("rab")):
                if board and (path.parent / board.get("firmware", "own")).is_file():
                    board["firmware"] = str((path.parent / board["firmware"]).resolve())
            program = robot.get("linux", {}).get("program")
            if isinstance(program, list) and "/" in program[0]:
                program[0] = str((path.parent / program[0]).resolve())
        return scenario

    def add(self, table: str, **keys: Any) -> Scenario:
        """One more [[table]]: robot, box, lamp, fault, event, ..."""
        self.tables.setdefault(table, []).append(copy.deepcopy(keys))
        return self

    def to_toml(self) -> str:
        """The scenario's file."""
        lines: list[str] = []
        for name, content in self.tables.items():
            for table in content if isinstance(content, list) else [content]:
                lines.append(f"[[{_key(name)}]]" if isinstance(content, list) else f"[{_key(name)}]")
                lines += [f"{_key(key)} = {_value(value)}" for key, value in table.items()]
                lines.append("")
        return "\n".join(lines)

    def write(self, file: str | pathlib.Path) -> pathlib.Path:
        """Writes the file and returns its path. OSError."""
        path = pathlib.Path(file)
        path.write_text(self.to_toml(), encoding="utf-8")
        return path
