"""Manual pages in the macros of man(7): one of the program, one of each command."""

from __future__ import annotations

import re
from typing import Sequence

from tables import Command, Option


def _text(text: str) -> str:
    """For troff: a backslash, a hyphen and a leading point or quote mean something to it."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text)


def page_name(words: Sequence[str], program: str) -> str:
    return "-".join((program, *words))


def _option(option: Option) -> list[str]:
    value = "{" + ",".join(option.choices) + "}" if option.choices else option.value
    names = ", ".join(f"\\fB{_text(name)}\\fR" for name in option.names)
    more = (f" \\fI{_text(value)}\\fR" if value else "") + (" ..." if option.repeatable else "")
    return [".TP", names + more, _text(option.about) or "\\&"]


def page(command: Command, commands: Sequence[Command], version: str, program: str) -> str:
    """Of `program`, such as puckloop."""
    name = page_name(command.words, program)
    usage = command.usage.split(" ")
    lines = [f'.TH "{_text(name.upper())}" "1" "" "puckloop {_text(version)}" "puckloop"',
             ".SH NAME", f"{_text(name)} \\- {_text(command.about)}",
             ".SH SYNOPSIS", f"\\fB{_text(' '.join((program, *command.words)))}\\fR "
             + _text(" ".join(usage[1 + len(command.words):]))]
    if command.positionals:
        lines.append(".SH ARGUMENTS")
        for option in command.positionals:
            lines += _option(option)
    lines.append(".SH OPTIONS")
    for section in command.sections:
        if section.title != "Options":
            lines.append(f".SS {_text(section.title)}")
        for option in section.options:
            lines += _option(option)
    if command.commands:
        lines.append(".SH COMMANDS")
        heading = None
        for title, one, about in command.commands:
            if title != heading and title != "Subcommands":
                lines.append(f".SS {_text(title)}")
            heading = title
            lines += [".TP", f"\\fB{_text(one)}\\fR", _text(about)]
    if command.notes:
        lines.append(".SH NOTES")
        for note in command.notes:
            lines += [_text(note), ".br"]
        lines.pop()
    if command.examples:
        lines += [".SH EXAMPLES", ".nf", *(_text(example) for example in command.examples), ".fi"]
    lines += [".SH EXIT STATUS", ".TP", "0", "success", ".TP", "1", "a run, a check or an expectation failed", ".TP",
              "2", "wrong use or bad input, with one line that names the place"]
    parents = [command.words[:-1]] if command.words else []
    others = [one.words for one in commands if one.words[:-1] == command.words and one.words]
    if parents + others:
        lines += [".SH SEE ALSO", ", ".join(f"\\fB{_text(page_name(words, program))}\\fR(1)" for words in parents + others)]
    return "\n".join(lines) + "\n"
