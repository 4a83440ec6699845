"""The program's option tables, read from its own --help of every command."""

from __future__ import annotations

import dataclasses
import re
import subprocess
from typing import Sequence

_COLUMN = 30  # where descriptions begin (tools/cli/help_text.h)
_DEEPEST = 4  # words of a command


class Unreadable(Exception):
    """A help that is not like the others; the text names the line."""


@dataclasses.dataclass(frozen=True)
class Option:
    """An option, or a positional argument (its names have no hyphen)."""

    names: tuple[str, ...]
    value: str  #: what stands for its value, such as FILE; empty: a flag
    choices: tuple[str, ...]
    repeatable: bool
    about: str

    @property
    def takes_value(self) -> bool:
        return bool(self.value or self.choices)


@dataclasses.dataclass(frozen=True)
class Section:
    title: str
    options: tuple[Option, ...]


@dataclasses.dataclass(frozen=True)
class Command:
    words: tuple[str, ...]  #: after the program's name
    about: str
    usage: str
    sections: tuple[Section, ...]
    positionals: tuple[Option, ...]
    commands: tuple[tuple[str, str, str], ...]  #: heading, name and what each does
    notes: tuple[str, ...]  #: lines after the options
    examples: tuple[str, ...]

    @property
    def options(self) -> list[Option]:
        return [option for section in self.sections for option in section.options]


def _entries(lines: Sequence[str]) -> list[tuple[str, str]]:
    """Left and right column of each entry of a section, both in one line."""
    entries: list[tuple[str, str]] = []
    for line in lines:
        if re.match(r"  \S", line):
            entries.append(("", ""))
        elif not entries:
            raise Unreadable(f"'{line}' belongs to no entry")
        left, right = entries[-1]
        if line.startswith(" " * _COLUMN):
            right += " " + line.strip()
        elif re.match(r"  \S", line) and line[_COLUMN - 1:_COLUMN] == " " and line[_COLUMN:] != "...":
            left, right = line[:_COLUMN].strip(), line[_COLUMN:].strip()
        else:
            left += (" " if left else "") + line.strip()
        entries[-1] = left, right.strip()
    return entries


def _option(left: str, right: str) -> Option:
    found = re.match(r"(\S+?)(?:\{\w+\})?(?:\s+(.*))?$", left)
    if not found:
        raise Unreadable(f"'{left}' is no option")
    names, rest = found[1].rstrip(","), found[2] or ""
    rest = re.sub(r"\s*(Excludes|Needs):.*$", "", rest)
    rest = re.sub(r"\s*\bREQUIRED\b", "", rest)
    repeatable = rest.endswith("...")
    rest = rest.removesuffix("...").strip()
    kind, default = re.match(r"(.*?)(?:=([^=\s]+))?$", rest).groups() if re.search(r"(?<![A-Z])=\S+$|^VALUE=", rest) \
        else (rest, None)
    choices = re.search(r"\{([^}]*)\}", kind)
    value, _, limits = kind.partition(":")
    if re.match(r"-?\d", value):
        value, limits = "N", value
    notes = [limits] if limits and not choices else []
    notes += [f"default {default}"] if default else []
    return Option(tuple(names.split(",")), "" if choices else value,
                  tuple(one.strip() for one in choices[1].split(",")) if choices else (), repeatable,
                  right + (f" ({', '.join(notes)})" if notes else ""))


def parse(words: Sequence[str], text: str) -> Command:
    """Unreadable: there is no usage, or a line belongs to nothing."""
    lines = text.splitlines()
    at = next((place for place, line in enumerate(lines) if line.startswith("Usage: ")), None)
    if at is None:
        raise Unreadable(f"puckloop {' '.join(words)} --help has no usage")
    about = " ".join(" ".join(lines[:at]).split())
    after = next((place for place in range(at, len(lines)) if not lines[place].strip()), len(lines))
    usage = " ".join(" ".join(lines[at:after]).removeprefix("Usage: ").split())
    sections: list[Section] = []
    positionals: list[Option] = []
    commands: list[tuple[str, str, str]] = []
    notes: list[str] = []
    examples: list[str] = []
    title, block = "", []  # of the section that is being read

    def close() -> None:
        if title.startswith("Example"):
            examples.extend(line.strip() for line in block)
        elif title and block and not block[0].strip().startswith("-") and title != "Positionals" and \
                "COMMAND" not in usage:
            notes.extend([title + ":", *(line.strip() for line in block)])
        elif title and block:
            entries = _entries(block)
            if all(left.startswith("-") for left, _ in entries):
                sections.append(Section(title, tuple(_option(*entry) for entry in entries)))
            elif title == "Positionals":
                positionals.extend(_option(*entry) for entry in entries)
            else:
                commands.extend((title, left, right) for left, right in entries)

    for line in lines[after:]:
        if re.match(r"\S.*:$", line) and not line.startswith("puckloop"):
            close()
            title, block = line[:-1], []
        elif line.startswith("  ") and title:
            block.append(line)
        elif line.strip():
            close()
            title, block = "", []
            notes.append(line.strip())
    close()
    return Command(tuple(words), about, usage, tuple(sections), tuple(positionals), tuple(commands), tuple(notes),
                   tuple(examples))


def read(program: str) -> list[Command]:
    """All commands, the program itself first. OSError, Unreadable."""
    found: list[Command] = []

    def visit(words: tuple[str, ...]) -> None:
        ended = subprocess.run([program, *words, "--help"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                               check=False)
        if ended.returncode != 0:
            if words == ("gap",):
                return  # a program of its own, which is perhaps not built
            raise Unreadable(f"puckloop {' '.join(words)} --help: status {ended.returncode}")
        command = parse(words, ended.stdout)
        found.append(command)
        if len(words) < _DEEPEST:
            for _, name, _ in command.commands:
                visit((*words, name))

    visit(())
    return found
