"""The runs that a client began, each by its name."""

from __future__ import annotations

import pathlib
import re
import threading
from typing import Any, Callable, Mapping, Sequence

from ..errors import PuckloopError
from ..records import Stepped
from ..run import Run, from_snapshot, start
from ..session import seconds_of
from .folders import Folders, Refused
from .names import one_of

_MOST_RUNS = 8
_KEPT_TEXT = 65536  # bytes of each direction of a line that nobody expected yet
_SLICE_PS = 100_000_000_000  # between two looks at whether a call was cancelled
_LOOK_PS = 10_000_000_000  # of expect
_LONGEST_PS = 720 * 3600 * 10 ** 12


class Cancelled(PuckloopError):
    """The client does not want the answer any more."""


class Call:
    """A call that is under way: it may be cancelled, and reports how far it is."""

    def __init__(self, progress: Callable[[float, float], None] | None = None) -> None:
        self.cancelled = threading.Event()
        self._progress = progress

    def look(self, done: float = 0, of: float = 0) -> None:
        """Cancelled."""
        if self.cancelled.is_set():
            raise Cancelled("cancelled")
        if self._progress is not None and of > 0:
            self._progress(done, of)


def picoseconds(key: str, value: Any) -> int:
    try:
        time = round(seconds_of(value) * 1e12)
    except (ValueError, OverflowError):
        time = -1
    if not 0 <= time <= _LONGEST_PS:
        raise Refused(f"{key}: {value!r} is no time such as '20 ms'")
    return time


class Kept:
    """A run, one call at a time, with the text of its serial lines."""

    def __init__(self, name: str, run: Run) -> None:
        self.name, self.run = name, run
        self.turn = threading.Lock()
        self._texts: dict[tuple[str, str], bytes] = {}
        run.capture(kind="uart")

    def back(self, to: str) -> None:
        self.drain()
        self.run.back(to)
        self._texts.clear()

    def drain(self) -> None:
        """Takes what the lines carried; the run keeps only so much of it."""
        if self.run.ended is not None:
            return
        for frame in self.run.frames():
            if not frame.fault and frame.kind == "uart":
                key = (frame.link, frame.sender)
                self._texts[key] = (self._texts.get(key, b"") + bytes([frame.byte & 0xFF]))[-_KEPT_TEXT:]

    def step(self, call: Call, end: int, until: Mapping[str, Any] | None) -> Stepped:
        """To that time, in slices; where it is cancelled in between, the run stands still there."""
        run, begun = self.run, self.run.time_ps
        acts: list[dict[str, Any]] = []
        while True:
            call.look(run.time_ps - begun, end - begun)
            time = min(end, run.time_ps + _SLICE_PS)
            step = run.step(to=max(time, run.time_ps + 1) / 1e12, until=until)
            acts += step.acts
            self.drain()
            if step.time_ps >= end or (until is not None and step.met):
                return Stepped(step.time_ps, step.met, step.frame, tuple(acts))

    def expect(self, call: Call, link: str, sender: str, wanted: bytes, timeout: int) -> tuple[bool, bytes]:
        """Whether it was sent, and what came before and with it; or the end of what came instead."""
        key, run = (link, sender), self.run
        self.drain()
        begun, end = run.time_ps, run.time_ps + timeout
        while (at := self._texts.get(key, b"").find(wanted)) < 0:
            call.look(run.time_ps - begun, timeout)
            if run.time_ps >= end:
                return False, self._texts.get(key, b"")[-200:]
            run.step(to=min(end, run.time_ps + _LOOK_PS) / 1e12)
            self.drain()
        after = at + len(wanted)
        used, self._texts[key] = self._texts[key][:after], self._texts[key][after:]
        return True, used


class Runs:
    def __init__(self, folders: Folders) -> None:
        self._folders = folders
        self._runs: dict[str, Kept] = {}
        self._names = threading.Lock()
        self._closed = False

    def _keep(self, begin: Callable[[pathlib.Path], Run]) -> Kept:
        with self._names:
            if sum(kept.run.ended is None for kept in self._runs.values()) >= _MOST_RUNS:
                raise Refused(f"{_MOST_RUNS} runs are open: end one first")
        run = begin(self._folders.new_results())
        kept = Kept(run.results.name, run)
        with self._names:
            if not self._closed:
                self._runs[kept.name] = kept
                return kept
        run.close()
        raise Cancelled("the server ends")

    def start(self, scenario: str, firmware: Mapping[str, str], faults: Sequence[str], seed: int | None,
              duration: str | None, in_process: bool) -> Kept:
        return self._keep(lambda out: start(
            self._folders.scenario(scenario), out=out, firmware=self.check_images(firmware),
            faults=self.check_faults(faults), seed=seed, duration=self._time(duration), in_process=in_process))

    def go_on(self, snapshot: str, faults: Sequence[str], duration: str | None) -> Kept:
        file = self._folders.snapshot(snapshot)
        if not file.is_file():
            raise Refused(f"{snapshot}: there is no such snapshot")
        return self._keep(lambda out: from_snapshot(file, out=out, faults=self.check_faults(faults),
                                                    duration=self._time(duration)))

    def check_images(self, firmware: Mapping[str, str]) -> dict[str, str]:
        """Images as files. Refused."""
        for board in firmware:
            if not re.fullmatch(r"\w[\w.-]*", board):
                raise Refused(f"'{board}' is no board's name")
        return {board: self._folders.image(image) for board, image in firmware.items()}

    @staticmethod
    def check_faults(faults: Sequence[str]) -> Sequence[str]:
        """The faults. Refused: one could be taken for an option, or names a file."""
        for fault in faults:
            if re.match(r"\s*(kind=)?\W*flash\b", fault) or "image" in fault:
                raise Refused("an image is flashed by the tool flash, which looks where it is")
            if not re.match(r"\w", fault):
                raise Refused(f"'{fault}' is no fault such as 'drop link=robot0.uart begin=2s count=1'")
        return faults

    @staticmethod
    def _time(duration: str | None) -> float | None:
        return None if duration is None else picoseconds("duration", duration) / 1e12

    def named(self, name: str) -> Kept:
        """Refused: there is none."""
        with self._names:
            if not self._runs:
                raise Refused(f"there is no run '{name}': start_run begins one")
            return self._runs[one_of("run", name, list(self._runs))]

    def all(self) -> list[Kept]:
        with self._names:
            return list(self._runs.values())

    def close(self) -> None:
        """Ends all of them; none is begun any more."""
        with self._names:
            self._closed = True
            runs = list(self._runs.values())
        for kept in runs:
            kept.run.close()
