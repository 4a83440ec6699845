"""Completion scripts for bash, zsh and fish."""

from __future__ import annotations

from typing import Sequence

from tables import Command, Option

_FILES = ("FILE", "IMAGE", "SCENARIO", "PROGRAM [ARG]", "OVERLAY", "BOARD=IMAGE", "VALUE")
_FOLDERS = ("DIR",)


def _name(words: Sequence[str]) -> str:
    return "_".join(("puckloop", *words)).replace("-", "_")


def _first_sentence(about: str) -> str:
    return about.split(";")[0].split(" (")[0].strip()


def _flags(command: Command) -> list[str]:
    return [name for option in command.options for name in option.names]


def _choices(command: Command) -> list[str]:
    """What may stand for the first positional argument; commands besides."""
    return [name for _, name, _ in command.commands] + \
        [choice for option in command.positionals for choice in option.choices]


def bash(commands: Sequence[Command]) -> str:
    lines = ["# bash completion of puckloop, generated from its --help.", "", "_puckloop() {",
             "    local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path= word i",
             "    COMPREPLY=()",
             "    # The command so far: words that name one within the one before.",
             "    for ((i = 1; i < COMP_CWORD; i++)); do",
             "        word=${COMP_WORDS[i]}",
             '        case "$path/$word" in']
    for command in commands:
        if command.words:
            lines.append(f"            /{'/'.join(command.words)}) path=/{'/'.join(command.words)} ;;")
    lines += ["        esac", "    done", '    case "$path $before" in']
    for command in commands:
        path = "".join("/" + word for word in command.words)
        for option in command.options:
            if not option.takes_value:
                continue
            names = " | ".join(f'"{path} {name}"' for name in option.names)
            if option.choices:
                act = f'COMPREPLY=($(compgen -W "{" ".join(option.choices)}" -- "$current"))'
            elif option.value in _FOLDERS:
                act = 'COMPREPLY=($(compgen -d -- "$current"))'
            elif option.value in _FILES:
                act = 'COMPREPLY=($(compgen -f -- "$current"))'
            else:
                act = ":"  # any text
            lines.append(f"        {names}) {act}; return ;;")
    lines += ["    esac", '    case "$path" in']
    for command in commands:
        path = "".join("/" + word for word in command.words)
        flags, words = " ".join(_flags(command)), " ".join(_choices(command))
        lines += [f'        "{path}")', '            if [[ $current == -* ]]; then',
                  f'                COMPREPLY=($(compgen -W "{flags}" -- "$current"))', "            else",
                  f'                COMPREPLY=($(compgen -W "{words}" -- "$current"))']
        if any(option.value == "SCENARIO" for option in command.positionals):
            lines.append('                COMPREPLY+=($(compgen -W "$(puckloop list scenarios 2>/dev/null | '
                         "sed -n 's/^  \\([^ ]*\\) .*/\\1/p')\" -- \"$current\"))")
        if any(not option.choices for option in command.positionals):
            lines.append('                COMPREPLY+=($(compgen -f -- "$current"))')
        lines += ["            fi ;;"]
    return "\n".join(lines + ["    esac", "}", "", "complete -o filenames -F _puckloop puckloop"]) + "\n"


def _zsh_text(text: str) -> str:
    for character in "\\[]:":
        text = text.replace(character, "\\" + character)
    return text.replace("'", "'\\''")


def _zsh_value(option: Option) -> str:
    if option.choices:
        return ":value:(" + " ".join(option.choices) + ")"
    if option.value in _FOLDERS:
        return ":folder:_files -/"
    if option.value in _FILES:
        return ":file:_files"
    return f":{_zsh_text(option.value.lower())}: " if option.value else ""


def zsh(commands: Sequence[Command]) -> str:
    lines = ["#compdef puckloop", "# zsh completion of puckloop, generated from its --help.", ""]
    for command in reversed(commands):
        function = "_" + _name(command.words)
        lines += [f"{function}() {{", "    local context state state_descr line", "    typeset -A opt_args"]
        words = []
        for option in command.options:
            for name in option.names:
                others = "" if option.repeatable else "(" + " ".join(option.names) + ")"
                star = "*" if option.repeatable else ""
                words.append(f"'{others}{star}{name}[{_zsh_text(_first_sentence(option.about))}]{_zsh_value(option)}'")
        if command.commands:
            words += ["'1:command:->command'", "'*::argument:->argument'"]
        else:
            for option in command.positionals:
                scenarios = option.value == "SCENARIO"
                value = ":_puckloop_scenarios" if scenarios else _zsh_value(option).split(":", 2)[-1]
                value = ":" + value.lstrip(":") if value.strip() else ": "
                words.append(f"'{'*' if option.repeatable else ''}:{option.names[0].lower()}{value}'")
        lines += ["    _arguments -C \\"] + [f"        {word} \\" for word in words[:-1]] + [f"        {words[-1]}"]
        if command.commands:
            lines += ["    case $state in", "        command)", "            local -a known", "            known=("]
            lines += [f"                '{name}:{_zsh_text(_first_sentence(about))}'"
                      for _, name, about in command.commands]
            lines += ["            )", "            _describe command known ;;", "        argument)",
                      "            case $line[1] in"]
            lines += [f"                {name}) {function}_{name.replace('-', '_')} ;;"
                      for _, name, _ in command.commands if (*command.words, name) in
                      {one.words for one in commands}]
            lines += ["            esac ;;", "    esac"]
        lines += ["}", ""]
    lines += ["_puckloop_scenarios() {", "    local -a known",
              "    known=(${(f)\"$(puckloop list scenarios 2>/dev/null | sed -n 's/^  \\([^ ]*\\) .*/\\1/p')\"})",
              "    _describe scenario known", "    _files", "}", "", '_puckloop "$@"']
    return "\n".join(lines) + "\n"


def _fish_text(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish(commands: Sequence[Command]) -> str:
    lines = ["# fish completion of puckloop, generated from its --help.", "",
             "# Whether the words so far name this command and none within it.", "function __puckloop_at",
             "    set -l path", "    for word in (commandline -opc)[2..-1]", '        switch "$path/$word"']
    lines += [f"            case {'/' + '/'.join(command.words)}\n                set path \"$path/$word\""
              for command in commands if command.words]
    lines += ["        end", "    end", '    test "$path" = "$argv[1]"', "end", "", "complete -c puckloop -f"]
    for command in commands:
        path = "".join("/" + word for word in command.words)
        at = f"complete -c puckloop -n '__puckloop_at \"{path}\"'"
        for _, name, about in command.commands:
            lines.append(f"{at} -a {name} -d {_fish_text(_first_sentence(about))}")
        for option in command.positionals:
            if option.choices:
                lines.append(f"{at} -a {_fish_text(' '.join(option.choices))}")
            else:
                lines.append(f"{at} -F")
            if option.value == "SCENARIO":
                lines.append(f"{at} -a '(puckloop list scenarios 2>/dev/null | "
                             "string replace -rf \"^  (\\S+) +(.*)\" \"\\$1\\t\\$2\")'")
        for option in command.options:
            names = " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option.names)
            value = ""
            if option.choices:
                value = " -x -a " + _fish_text(" ".join(option.choices))
            elif option.value in _FOLDERS:
                value = " -x -a '(__fish_complete_directories)'"
            elif option.value in _FILES:
                value = " -r -F"
            elif option.value:
                value = " -x"
            lines.append(f"{at} {names}{value} -d {_fish_text(_first_sentence(option.about))}")
    return "\n".join(lines) + "\n"
