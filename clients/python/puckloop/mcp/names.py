"""Names that are not there, and those that were perhaps meant."""

from __future__ import annotations

import difflib
from typing import Iterable, Sequence

from .folders import Refused


def did_you_mean(name: str, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(name, list(known), 3)
    return f"; did you mean {' or '.join(near)}?" if near else ""


def one_of(what: str, name: str, known: Sequence[str]) -> str:
    """The name. Refused: it is none of them, with those that are like it."""
    if name not in known:
        near = did_you_mean(name, known) or f"; there are {', '.join(known)}"
        raise Refused(f"there is no {what} '{name}'{near}")
    return name
