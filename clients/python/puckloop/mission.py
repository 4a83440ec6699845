"""A mission program: it gets what the tracker sees, counts the score, and may act on the world.

    from puckloop.mission import Mission

    with Mission() as mission:
        for frame in mission:
            inside = [r for r in frame.robots if (r.x - 0.6) ** 2 + r.y ** 2 < 0.3 ** 2]
            mission.score = mission.score + len(inside)
            if mission.score > 1000:
                mission.end("all have been there")

puckloop starts it where a scenario has `[mission]` with `kind = "program"` (docs/missions.md). Lengths
are metres, times seconds of simulated time, headings radians. Standard output belongs to puckloop;
print() writes to mission.log.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Iterator, TextIO

PROTOCOL = 1


@dataclass(frozen=True)
class Pose:
    """A robot as the tracker has it: m, m, rad."""

    name: str
    x: float
    y: float
    heading: float


@dataclass(frozen=True)
class Event:
    """What was done to the world, or refused: then `refused` says why."""

    time: float
    event: str
    act: str
    refused: str | None = None


@dataclass(frozen=True)
class Frame:
    """What the cameras saw at `time`; it arrived at `arrives`."""

    number: int
    time: float
    arrives: float
    robots: list[Pose] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)


def _pose(value: dict[str, Any]) -> Pose:
    return Pose(value["name"], value["x_m"], value["y_m"], value["theta_rad"])


def _frame(value: dict[str, Any]) -> Frame:
    events = [Event(e["at_s"], e["event"], e["act"], e.get("refused")) for e in value["events"]]
    return Frame(value["frame"], value["t_s"], value["arrives_s"], [_pose(r) for r in value["robots"]], events)


class Mission:
    """One run. Iterate over its frames; what was asked for meanwhile is sent when the next is wanted.

    Raises ValueError if puckloop speaks another version of the protocol.
    """

    score: float | None

    def __init__(self, lines: TextIO | None = None, answers: TextIO | None = None) -> None:
        self._lines = lines or sys.stdin
        self._answers = answers or sys.stdout
        if answers is None:
            sys.stdout = sys.stderr
        begin = json.loads(self._lines.readline())
        if begin.get("begin") != PROTOCOL:
            raise ValueError(f"puckloop speaks version {begin.get('begin')} of missions, this is {PROTOCOL}")
        self.seed: int = begin["seed"]
        self.duration: float | None = begin["duration_s"]
        self.frame_rate: float = begin["frame_rate_hz"]
        self.latency: float = begin["latency_s"]
        self.arena: list[tuple[float, float]] = [(x, y) for x, y in begin["arena_m"]]
        self.robots: list[Pose] = [_pose(robot) for robot in begin["robots"]]
        self.score = 0
        self.ended: float | None = None
        self._acts: list[str] = []
        self._end: bool | str = False
        self._open = True

    def act(self, command: str) -> None:
        """A command of `puckloop act`, done one step (1 ms) later: "add disc spot1 ..."."""
        self._acts.append(command)

    def end(self, why: str = "") -> None:
        """The run is to end."""
        self._end = why or True

    def _answer(self) -> None:
        answer: dict[str, Any] = {}
        if self.score is not None:
            answer["score"] = self.score
        if self._acts:
            answer["act"] = self._acts
        if self._end:
            answer["end"] = self._end
        self._acts = []
        self._answers.write(json.dumps(answer) + "\n")
        self._answers.flush()

    def __iter__(self) -> Iterator[Frame]:
        while self._open:
            self._answer()
            line = self._lines.readline()
            if not line:
                self._open = False
                return
            value = json.loads(line)
            if "end" in value:
                self.ended = value["end"]
                return
            yield _frame(value)

    def __enter__(self) -> Mission:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """After the last frame: the final score."""
        if kind is None and self._open and self.ended is not None:
            self._answer()
