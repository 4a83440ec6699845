"""A run that this program drives."""

from __future__ import annotations

import os
import pathlib
import re
import time
from typing import Any, Mapping, Sequence, TypeVar

from . import launch, session, tables
from .errors import NobodyServes, PuckloopError, RequestError, RunEnded, StartError
from .launch import Found, Launched
from .line import Line
from .records import Decoded, Ended, Frame, Register, Stepped, Value
from .scenario import Scenario
from .session import Operation, Session, Text, Time

T = TypeVar("T")


def start(scenario: str | os.PathLike[str] | Scenario, *, out: str | os.PathLike[str] | None = None,
          firmware: Mapping[str, str | os.PathLike[str]] | None = None, linux: Sequence[str] | None = None,
          faults: Sequence[str] = (), seed: int | None = None, duration: Time | None = None, in_process: bool = True,
          options: Sequence[str] = ()) -> Run:
    """Starts a scenario (its file, a shipped one's name, or one made in code); it stands still at 0 s.

    `out` is the results folder (default: a temporary one, removed when the run is closed), a scenario made in code is
    written beside it as `out`.toml; `firmware` maps boards to images, as --firmware; `linux` replaces the Linux
    programs; `faults` as --fault; `options` are further words of `puckloop run`. StartError: the run was refused.
    """
    return Run(Launched(launch.of_scenario(scenario, out=out, firmware=firmware, linux=linux, faults=faults, seed=seed,
                                           duration=duration, in_process=in_process, options=options)))


def from_snapshot(file: str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None,
                  faults: Sequence[str] = (), duration: Time | None = None, in_process: bool = True) -> Run:
    """Goes on from what Run.save() wrote, at its time, with faults that begin later. StartError."""
    return Run(Launched(launch.of_snapshot(file, out=out, faults=faults, duration=duration, in_process=in_process)))


def attach(results: str | os.PathLike[str]) -> Run:
    """Drives a run that was begun by hand with --control, by its results folder.

    StartError: there is no such run, it is over, or nobody serves its socket.
    """
    return Run(Found(results))


class Board:
    """A board of a run: its chip's registers, variables and memory, at the time at which the run stands still."""

    def __init__(self, run: Run, name: str) -> None:
        self._run = run
        self.name = name

    def register(self, name: str) -> Register:
        """By its data-sheet name ("TMR1"), or one of the core ("W0", "PC"). RequestError: there is none."""
        return self._run._do(session.read_register(self.name, name))

    def value(self, what: str) -> int:
        """By what one types: "TMR1", "U2STA.TRMT" (a field), a variable, "0x850:4" (memory). RequestError."""
        return self._run._do(session.read_value(self.name, what))

    def variable(self, name: str, size: int | None = None) -> Value:
        """By its symbol; `size` in bytes where the image does not say. RequestError: no symbol of this name."""
        return self._run._do(session.read_variable(self.name, name, size))

    def memory(self, address: int, size: int) -> Value:
        """`size` bytes of data space. RequestError: not all of them exist."""
        return self._run._do(session.read_memory(self.name, address, size))

    def set_register(self, name: str, value: int) -> None:
        """With the side effects that the program's own write would have. RequestError."""
        self._run._do(session.write_register(self.name, name, value))

    def set_variable(self, name: str, value: int | bytes, size: int | None = None) -> None:
        """A number (little-endian) or bytes. RequestError."""
        self._run._do(session.write_variable(self.name, name, value, size))

    def set_memory(self, address: int, data: bytes) -> None:
        """Bytes of data space, as if the program wrote them. RequestError."""
        self._run._do(session.write_memory(self.name, address, data))

    def step(self, instructions: int = 1) -> bool:
        """The run goes on until this board has executed so many instructions (1 to 100,000). False: it has not within
        100 ms, for it waits. RequestError."""
        return self._run._do(session.step_instructions(self.name, instructions))


class Dut:
    """What is sent on one direction of a serial line, as text to wait for."""

    def __init__(self, run: Run, link: str, sender: str) -> None:
        self._run, self.link, self.sender = run, link, sender
        self._text = Text(run._session, link, sender)
        run._do(self._text.begin())

    @property
    def text(self) -> str:
        """What was sent and not yet expected."""
        self._run._do(self._text.take())
        return self._text.bytes.decode("latin-1")

    def expect(self, text: str | re.Pattern[str], timeout: Time = "1 s", every: Time = "10 ms") -> str:
        """Goes on until the text was sent; returns what came before and the text, which are used up.

        Bytes are characters of Latin-1. AssertionError if it is not sent within `timeout` of simulated time; looked at
        each `every`. RunEnded: the run ended before.
        """
        return self._run._do(self._text.expect(text, timeout, every))


class Run:
    """Stands still between two calls. Made by start(), from_snapshot() and attach(); closed by a with statement."""

    def __init__(self, launched: Launched | Found) -> None:
        self._launched = launched
        try:
            self._line = self._connect()
        except BaseException:
            self._launched.kill()
            self._launched.remove()
            raise
        self._session = Session(self._line.greeting, self._launched.results)

    def _connect(self) -> Line:
        begun = time.monotonic()
        nobody: NobodyServes | None = None
        while time.monotonic() - begun < self._launched.patience:
            path = self._launched.socket()
            if path is not None:
                try:
                    return Line(path)
                except NobodyServes as error:  # not yet: the socket's name is known before it is there
                    nobody = error
            time.sleep(launch.POLL_SECONDS)
        raise nobody or StartError(f"the run did not listen for {self._launched.patience:g} s")

    # What it is.
    @property
    def results(self) -> pathlib.Path:
        """The results folder."""
        return self._launched.results

    @property
    def command(self) -> list[str]:
        """The command that began it; empty of a run that somebody else began."""
        return list(self._launched.command)

    @property
    def faults(self) -> list[str]:
        """Those that it was begun with, and those of fault()."""
        begun = list(self._launched.plan.faults) if isinstance(self._launched, Launched) else []
        return begun + self._session.faults

    @property
    def nodes(self) -> list[str]:
        """Names of all nodes."""
        return self._session.nodes

    @property
    def boards(self) -> list[str]:
        """Names of the nodes that board() reaches."""
        return self._session.boards

    @property
    def links(self) -> list[str]:
        """Names of all links."""
        return self._session.links

    @property
    def time_ps(self) -> int:
        """Picoseconds of simulated time."""
        return self._session.time_ps

    @property
    def time_s(self) -> float:
        """Simulated time in seconds."""
        return self._session.time_s

    @property
    def ended(self) -> Ended | None:
        """How the run ended; None: it has not."""
        return self._session.ended

    # How requests are carried.
    def _ask(self, op: str, keys: Mapping[str, Any]) -> dict[str, Any]:
        self._session.may_ask()
        reply = self._line.ask(op, keys)
        if self._session.replied(reply):
            self._over(reply)
        return reply

    def _do(self, operation: Operation[T]) -> T:
        try:
            request = next(operation)
            while True:
                try:
                    reply = self._ask(*request)
                except PuckloopError as error:
                    request = operation.throw(error)
                else:
                    request = operation.send(reply)
        except StopIteration as done:
            result: T = done.value
            return result

    def __enter__(self) -> Run:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the run if it goes on, and removes a temporary results folder."""
        if self.ended is None:
            try:
                self.end()
            except (PuckloopError, OSError, ValueError):
                pass
        self._line.close()
        self._launched.kill()
        self._launched.remove()

    def end(self) -> Ended:
        """Programs get their end signal, results are written. The run's verdict and report."""
        if self.ended is None:
            try:
                reply = self._line.ask("end", {})
            except RunEnded as error:
                reply = {"success": error.success, "ended_why": str(error)}
            self._over(reply)
        assert self.ended is not None
        return self.ended

    def _over(self, reply: Mapping[str, Any]) -> None:
        self._gone()
        self._session.ended = self._launched.report(reply)

    def _gone(self) -> None:
        """Until the run has ended; its process is killed if it does not."""
        begun = time.monotonic()
        while not self._launched.gone() and time.monotonic() - begun < launch.END_SECONDS:
            time.sleep(launch.POLL_SECONDS)
        self._launched.kill()

    # Time.
    def step(self, to: Time | None = None, for_: Time | None = None, until: Mapping[str, Any] | str | None = None,
             every: Time | None = None) -> Stepped:
        """Goes on to a simulated time, or for a span.

        `until` ends the step earlier: 'robot0.pic TMR1 >= 9', 'text "ok"', 'frame link=robot0.uart value=4e', or the
        same as {"frame": {...}}, {"text": ..., "frame": {...}} or {"node": ..., "register": ..., "is": ">=",
        "value": ...}; it is looked at each `every` (1 ms). RequestError: a time that is past, an unknown name, no
        condition. RunEnded: the run ended before.
        """
        return self._do(self._session.step(to, for_, until, every))

    # What is in it.
    def board(self, name: str) -> Board:
        """Of `boards`; looked for when it is used."""
        return Board(self, name)

    def dut(self, link: str, sender: str) -> Dut:
        """A direction of a serial line, from now on."""
        return Dut(self, link, sender)

    def capture(self, *, link: str | None = None, sender: str | None = None, kind: str | None = None,
                value: str | None = None, signal: str | None = None) -> None:
        """Frames like this are kept from now on, for frames(). RequestError: no link of this name."""
        self._do(self._session.capture(link, sender, kind, value, signal))

    def frames(self) -> list[Frame]:
        """Those captured since the last call, in the order of their time."""
        return self._do(self._session.frames())

    def decoded(self, protocol: str | None = None, *, link: str | None = None, sender: str | None = None
                ) -> list[Decoded]:
        """Frames so far by protocol ("epuck", "rab", "xbee", ...), with fields and errors. PuckloopError: no such
        protocol, link or node."""
        return tables.decoded(self.results, protocol, link=link, sender=sender)

    def log(self, node: str) -> str:
        """What a node wrote into its log so far; empty: nothing."""
        return self._session.log(node)

    def act(self, command: str) -> None:
        """Does something to the world in its next step, as `puckloop act`: "move can to 10 cm, 0 cm". RequestError."""
        self._do(self._session.act(command))

    def type(self, link: str, sender: str, text: str | bytes, baud: float | None = None) -> None:
        """Types into a serial line from now on, as if `sender`, one of its ends, had sent it: 8N1 without a pause, at
        the line's nominal rate unless `baud` is given, behind what was typed there before. A text is UTF-8.
        RequestError: no such line or end, more than 4096 bytes, a run with lines to the outside."""
        self._do(self._session.type(link, sender, text, baud))

    def flash(self, node: str, file: str | os.PathLike[str]) -> None:
        """Writes a firmware image into a board's chip, as a programmer at its connector would: memories are erased and
        written in no time, RAM stays, the chip is reset. What is read shows it from the next step on; events.toml
        repeats it, from a copy of the image. RequestError: no such board or file, no image, one for another chip, a
        run with lines to the outside; nothing was done then."""
        self._do(self._session.flash(node, pathlib.Path(file).absolute()))

    # Snapshots and faults.
    def save(self, file: str | os.PathLike[str]) -> pathlib.Path:
        """The whole run as it is, for from_snapshot(). RequestError: the file cannot be written."""
        return self._do(self._session.save(pathlib.Path(file).absolute()))

    @staticmethod
    def from_snapshot(file: str | os.PathLike[str], **keywords: Any) -> Run:
        """As the function of this name."""
        return from_snapshot(file, **keywords)

    def back(self, to: Time) -> None:
        """To an earlier time of the run, from which it goes on again: what was written to boards and done to the world
        from then on is taken back, and so are trace and results. RequestError: a time that is not past, a run with
        lines to the outside."""
        self._do(self._session.back(to))

    def fault(self, *faults: str) -> None:
        """Goes on with these faults besides (as --fault, beginning now or later). RequestError: one is refused; the
        run is as before."""
        self._do(self._session.fault(faults))
