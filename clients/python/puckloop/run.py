"""A run that this program drives."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
from typing import Any, Mapping, Sequence

from .errors import RunEnded, StartError
from .line import Line
from .records import Ended, Frame, Register, Stepped, Value
from .scenario import Scenario

Time = str | float | int  #: "20 ms", or seconds

_START_SECONDS = 120.0  # of wall time, until the run listens
_END_SECONDS = 60.0


def program() -> str:
    """The puckloop that is driven: PUCKLOOP, else the one in PATH. StartError: there is none."""
    found = os.environ.get("PUCKLOOP") or shutil.which("puckloop")
    if not found:
        raise StartError("no puckloop in PATH, and PUCKLOOP names none")
    return found


def start(scenario: str | os.PathLike[str] | Scenario, *, out: str | os.PathLike[str] | None = None,
          firmware: Mapping[str, str | os.PathLike[str]] | None = None, linux: Sequence[str] | None = None,
          faults: Sequence[str] = (), seed: int | None = None, duration: Time | None = None, in_process: bool = True,
          options: Sequence[str] = ()) -> Run:
    """Starts a scenario (its file, a shipped one's name, or one made in code); it stands still at 0 s.

    `out` is the results folder (default: a temporary one, removed when the run is closed), a scenario made in code is
    written beside it as `out`.toml; `firmware` maps boards to
    images, as --firmware; `linux` replaces the Linux programs; `faults` as --fault; `options` are further words of
    `puckloop run`. StartError: the run was refused.
    """
    words = ["--duration", str(duration)] if duration is not None else []
    words += ["--seed", str(seed)] if seed is not None else []
    for board, image in (firmware or {}).items():
        words += ["--firmware", f"{board}={os.fspath(image)}"]
    for fault in faults:
        words += ["--fault", fault]
    words += options
    if linux is not None:
        words += ["--linux", *linux]
    return Run._begin(scenario, words, out, in_process, faults)


def from_snapshot(file: str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None,
                  faults: Sequence[str] = (), duration: Time | None = None, in_process: bool = True) -> Run:
    """Goes on from what Run.save() wrote, at its time, with faults that begin later. StartError."""
    words = ["--from", os.fspath(file)]
    words += ["--duration", str(duration)] if duration is not None else []
    for fault in faults:
        words += ["--fault", fault]
    return Run._begin(None, words, out, in_process, faults)


class Board:
    """A board of a run: its chip's registers, variables and memory, at the time at which the run stands still."""

    def __init__(self, run: Run, name: str) -> None:
        self._run = run
        self.name = name

    def register(self, name: str) -> Register:
        """By its data-sheet name ("TMR1"), or one of the core ("W0", "PC"). RequestError: there is none."""
        reply = self._run._ask("read", node=self.name, register=name)
        return Register(name, int(reply["value"]), int(reply["bits"]), dict(reply["fields"]))

    def variable(self, name: str, size: int | None = None) -> Value:
        """By its symbol; `size` in bytes where the image does not say. RequestError: no symbol of this name."""
        return self._value(self._run._ask("read", node=self.name, variable=name, bytes=size))

    def memory(self, address: int, size: int) -> Value:
        """`size` bytes of data space. RequestError: not all of them exist."""
        return self._value(self._run._ask("read", node=self.name, memory=address, bytes=size))

    def set_register(self, name: str, value: int) -> None:
        """With the side effects that the program's own write would have. RequestError."""
        self._run._ask("write", node=self.name, register=name, value=value)

    def set_variable(self, name: str, value: int | bytes, size: int | None = None) -> None:
        """A number (little-endian) or bytes. RequestError."""
        if isinstance(value, bytes):
            self._run._ask("write", node=self.name, variable=name, data=value.hex(), bytes=len(value))
        else:
            self._run._ask("write", node=self.name, variable=name, value=value, bytes=size)

    def set_memory(self, address: int, data: bytes) -> None:
        """Bytes of data space, as if the program wrote them. RequestError."""
        self._run._ask("write", node=self.name, memory=address, data=data.hex(), bytes=len(data))

    @staticmethod
    def _value(reply: Mapping[str, Any]) -> Value:
        return Value(int(reply["address"]), bytes.fromhex(reply["data"]))


class Dut:
    """What is sent on one direction of a serial line, as text to wait for."""

    def __init__(self, run: Run, link: str, sender: str) -> None:
        self._run, self.link, self.sender = run, link, sender
        self._text = b""
        run.capture(link=link, sender=sender, kind="uart")

    def _take(self) -> None:
        for frame in self._run.frames():
            for dut in self._run._duts:
                if (frame.link, frame.sender) == (dut.link, dut.sender) and not frame.fault and frame.kind == "uart":
                    dut._text += bytes([frame.byte & 0xFF])

    @property
    def text(self) -> str:
        """What was sent and not yet expected."""
        self._take()
        return self._text.decode("latin-1")

    def expect(self, text: str, timeout: Time = "1 s", every: Time = "10 ms") -> str:
        """Goes on until the text was sent; returns what came before and the text, which are used up.

        AssertionError if it is not sent within `timeout` of simulated time; looked at each `every`.
        """
        wanted = text.encode("latin-1")
        self._take()
        if wanted not in self._text:
            end = self._run.time_ps + seconds_of(timeout) * 1e12
            while wanted not in self._text and self._run.time_ps < end:
                self._run.step(for_=min(seconds_of(every), (end - self._run.time_ps) * 1e-12))
                self._take()
        at = self._text.find(wanted)
        if at < 0:
            raise AssertionError(f"{self.sender} did not send {text!r} on {self.link} within {timeout}; it sent "
                                 f"{self._text[-200:]!r} (results in {self._run.results})")
        used, self._text = self._text[:at + len(wanted)], self._text[at + len(wanted):]
        return used.decode("latin-1")


def seconds_of(value: Time) -> float:
    """Seconds of "20 ms", "1 s", "3 us", "2 min" or a number. ValueError."""
    if isinstance(value, (int, float)):
        return float(value)
    units = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
    for unit in sorted(units, key=len, reverse=True):
        if value.endswith(unit):
            return float(value[:-len(unit)]) * units[unit]
    raise ValueError(f"{value!r} is no time such as '20 ms'")


class Run:
    """Stands still between two calls. Made by start() and from_snapshot(); closed by a with statement."""

    def __init__(self, process: subprocess.Popen[bytes], line: Line, results: pathlib.Path,
                 temporary: tempfile.TemporaryDirectory[str] | None, in_process: bool,
                 faults: Sequence[str], command: Sequence[str]) -> None:
        self._process, self._line, self.results, self._temporary = process, line, results, temporary
        self._in_process = in_process
        self.command = list(command)  #: that began it
        self._faults = tuple(faults)
        self._duts: list[Dut] = []
        self._captures: list[dict[str, str]] = []
        self._ended: Ended | None = None
        self.nodes: list[str] = list(line.greeting["nodes"])
        self.boards: list[str] = list(line.greeting["boards"])
        self.links: list[str] = [link["name"] for link in line.greeting["links"]]
        self.time_ps: int = int(line.greeting["time_ps"])  #: picoseconds of simulated time

    # How it begins and ends.
    @staticmethod
    def _begin(scenario: str | os.PathLike[str] | Scenario | None, words: Sequence[str],
               out: str | os.PathLike[str] | None, in_process: bool, faults: Sequence[str]) -> Run:
        temporary = tempfile.TemporaryDirectory(prefix="puckloop-") if out is None else None
        folder = pathlib.Path(temporary.name) / "results" if temporary else pathlib.Path(os.fspath(out or ""))
        results = folder.absolute()
        results.mkdir(parents=True, exist_ok=True)
        command = [program(), "run"]
        if isinstance(scenario, Scenario):
            # Not within: a snapshot takes what is in the results folder for the run's own.
            command.append(str(scenario.write(results.with_name(results.name + ".toml"))))
        elif scenario is not None:
            command.append(os.fspath(scenario))
        command += ["--control", "--out", str(results)] + (["--in-process"] if in_process else []) + list(words)
        note = results / "control.json"
        note.unlink(missing_ok=True)
        try:
            with open(results / "puckloop.log", "wb") as log:
                process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        except OSError as error:
            raise StartError(f"{command[0]}: {error.strerror}") from None
        try:
            line = Run._connect(process, note, results)
        except BaseException:
            process.kill()
            process.wait()
            if temporary:
                temporary.cleanup()
            raise
        return Run(process, line, results, temporary, in_process, faults, command)

    @staticmethod
    def _connect(process: subprocess.Popen[bytes], note: pathlib.Path, results: pathlib.Path) -> Line:
        begun = time.monotonic()
        while time.monotonic() - begun < _START_SECONDS:
            ended = process.poll() is not None
            try:
                return Line(json.loads(note.read_text())["control"])
            except (OSError, ValueError, KeyError):  # not yet
                if ended:
                    said = (results / "puckloop.log").read_text(errors="replace").strip().splitlines()
                    raise StartError(said[-1] if said else "the run ended at once") from None
            time.sleep(0.01)
        raise StartError(f"the run did not listen for {_START_SECONDS:g} s")

    def __enter__(self) -> Run:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the run if it goes on, and removes a temporary results folder."""
        if self._ended is None:
            try:
                self.end()
            except (RunEnded, OSError):
                pass
        self._line.close()
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
        if self._temporary:
            self._temporary.cleanup()

    def end(self) -> Ended:
        """Programs get their end signal, results are written. The run's verdict and report."""
        if self._ended is None:
            try:
                reply = self._line.ask("end")
            except RunEnded as error:
                reply = {"success": error.success, "ended_why": str(error)}
            self._over(reply)
        assert self._ended is not None
        return self._ended

    def _over(self, reply: Mapping[str, Any]) -> None:
        try:
            self._process.wait(_END_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        file = self.results / "report.json"
        report = json.loads(file.read_text()) if file.is_file() and file.stat().st_size else {}
        self._ended = Ended(bool(report.get("success", reply.get("success", False))),
                            str(report.get("ended_why", reply.get("ended_why", ""))), report)

    # Time.
    @property
    def time_s(self) -> float:
        """Simulated time in seconds."""
        return self.time_ps * 1e-12

    @property
    def ended(self) -> Ended | None:
        """How the run ended; None: it has not."""
        return self._ended

    def _ask(self, op: str, **keys: Any) -> dict[str, Any]:
        if self._ended is not None:
            raise RunEnded(f"the run is over: {self._ended.why}", self._ended.success)
        reply = self._line.ask(op, **keys)
        self.time_ps = int(reply["time_ps"])
        if reply.get("ended"):
            self._over(reply)
        return reply

    def step(self, to: Time | None = None, for_: Time | None = None, until: Mapping[str, Any] | None = None,
             every: Time | None = None) -> Stepped:
        """Goes on to a simulated time, or for a span.

        `until`: {"frame": {...}}, {"text": ..., "frame": {...}} or {"node": ..., "register": ..., "is": ">=",
        "value": ...}, looked at each `every` (1 ms), ends the step earlier. RequestError: a time that is past, an
        unknown name. RunEnded: the run ended before.
        """
        reply = self._ask("step", to=to, **{"for": for_}, until=until, every=every)
        if self._ended is not None and not reply.get("met"):
            raise RunEnded(f"the run ended at {self.time_s:.6f} s: {self._ended.why}", self._ended.success)
        frame = Frame.of(reply["frame"]) if reply.get("frame") else None
        return Stepped(self.time_ps, bool(reply["met"]), frame, tuple(reply.get("acts", ())))

    # What is in it.
    def board(self, name: str) -> Board:
        """Of `boards`; looked for when it is used."""
        return Board(self, name)

    def dut(self, link: str, sender: str) -> Dut:
        """A direction of a serial line, from now on."""
        dut = Dut(self, link, sender)
        self._duts.append(dut)
        return dut

    def capture(self, *, link: str | None = None, sender: str | None = None, kind: str | None = None,
                value: str | None = None, signal: str | None = None) -> None:
        """Frames like this are kept from now on, for frames(). RequestError: no link of this name."""
        keys = {"link": link, "from": sender, "kind": kind, "value": value, "signal": signal}
        frame = {key: text for key, text in keys.items() if text is not None}
        self._captures.append(frame)
        self._ask("capture", frame=frame)

    def frames(self) -> list[Frame]:
        """Those captured since the last call, in the order of their time."""
        return [Frame.of(row) for row in self._ask("frames")["frames"]]

    def log(self, node: str) -> str:
        """What a node wrote into its log so far; empty: nothing."""
        file = self.results / f"{node}.log"
        return file.read_text(errors="replace") if file.is_file() else ""

    def act(self, command: str) -> None:
        """Does something to the world in its next step, as `puckloop act`: "move can to 10 cm, 0 cm". RequestError."""
        self._ask("act", command=command)

    # Snapshots and faults.
    def save(self, file: str | os.PathLike[str]) -> pathlib.Path:
        """The whole run as it is, for from_snapshot(). RequestError: the file cannot be written."""
        path = pathlib.Path(file).absolute()
        self._ask("save", file=str(path))
        return path

    def fault(self, *faults: str) -> None:
        """Goes on with these faults besides (as --fault, beginning later than now): the run is saved and gone on
        with from there, in a process of its own and the same results folder. StartError: a fault was refused; the
        run is over then."""
        with tempfile.TemporaryDirectory(prefix="puckloop-") as folder:
            snapshot = self.save(pathlib.Path(folder) / "run.snapshot")
            self._line.close()
            self._process.wait(_END_SECONDS)
            words = ["--from", str(snapshot)]
            self._faults += faults
            for fault in self._faults:
                words += ["--fault", fault]
            other = Run._begin(None, words, self.results, self._in_process, self._faults)
        self._process, self._line = other._process, other._line
        for frame in self._captures:
            self._ask("capture", frame=frame)
