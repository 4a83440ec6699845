"""What a run is asked and what its answers mean, for the synchronous and the asynchronous client.

Each operation is a generator: it yields requests, is sent their replies, and returns its result. A client carries them.
"""

from __future__ import annotations

import pathlib
import re
from typing import Any, Generator, Mapping, Sequence, Tuple, TypeVar

from .errors import RunEnded
from .records import Ended, Frame, Register, Stepped, Value

Time = str | float | int  #: "20 ms", or seconds

Request = Tuple[str, Mapping[str, Any]]
Reply = dict[str, Any]
T = TypeVar("T")
Operation = Generator[Request, Reply, T]


def seconds_of(value: Time) -> float:
    """Seconds of "20 ms", "1 s", "3 us", "2 min" or a number. ValueError."""
    if isinstance(value, (int, float)):
        return float(value)
    units = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
    for unit in sorted(units, key=len, reverse=True):
        if value.endswith(unit):
            return float(value[:-len(unit)]) * units[unit]
    raise ValueError(f"{value!r} is no time such as '20 ms'")


class Session:
    """A run as its client knows it."""

    def __init__(self, greeting: Mapping[str, Any], results: pathlib.Path) -> None:
        self.results = results
        self.nodes: list[str] = list(greeting["nodes"])
        self.boards: list[str] = list(greeting["boards"])
        self.links: list[str] = [link["name"] for link in greeting["links"]]
        self.time_ps: int = int(greeting["time_ps"])
        self.ended: Ended | None = None
        self.faults: list[str] = []  #: added since
        self.texts: list[Text] = []

    @property
    def time_s(self) -> float:
        return self.time_ps / 1e12

    def may_ask(self) -> None:
        """RunEnded: nothing more can be asked."""
        if self.ended is not None:
            raise RunEnded(f"the run is over: {self.ended.why}", self.ended.success)

    def replied(self, reply: Reply) -> bool:
        """Keeps what every reply says; true: the run is over, and its report is written."""
        self.time_ps = int(reply["time_ps"])
        return bool(reply.get("ended"))

    def _goes_on(self) -> None:
        if self.ended is not None:
            raise RunEnded(f"the run ended at {self.time_s:.6f} s: {self.ended.why}", self.ended.success)

    # Time.
    def step(self, to: Time | None, for_: Time | None, until: Mapping[str, Any] | str | None,
             every: Time | None) -> Operation[Stepped]:
        reply = yield "step", {"to": to, "for": for_, "until": until, "every": every}
        if not reply.get("met"):
            self._goes_on()
        frame = Frame.of(reply["frame"]) if reply.get("frame") else None
        return Stepped(self.time_ps, bool(reply["met"]), frame, tuple(reply.get("acts", ())))

    # What is in it.
    def capture(self, link: str | None, sender: str | None, kind: str | None, value: str | None,
                signal: str | None) -> Operation[None]:
        keys = {"link": link, "from": sender, "kind": kind, "value": value, "signal": signal}
        frame = {key: text for key, text in keys.items() if text is not None}
        yield "capture", {"frame": frame}

    def frames(self) -> Operation[list[Frame]]:
        reply = yield "frames", {}
        return [Frame.of(row) for row in reply["frames"]]

    def act(self, command: str) -> Operation[None]:
        yield "act", {"command": command}

    def save(self, file: pathlib.Path) -> Operation[pathlib.Path]:
        yield "save", {"file": str(file)}
        return file

    def back(self, to: Time) -> Operation[None]:
        yield "back", {"to": to}
        self._goes_on()
        for text in self.texts:
            text.bytes = b""

    def fault(self, faults: Sequence[str]) -> Operation[None]:
        yield "fault", {"fault": list(faults)}
        self._goes_on()
        self.faults += faults

    def type(self, link: str, sender: str, text: str | bytes, baud: float | None) -> Operation[None]:
        what = {"data": text.hex()} if isinstance(text, bytes) else {"text": text}
        yield "type", {"link": link, "from": sender, "baud": baud, **what}
        self._goes_on()

    def flash(self, node: str, file: pathlib.Path) -> Operation[None]:
        yield "flash", {"node": node, "file": str(file)}
        self._goes_on()

    def log(self, node: str) -> str:
        file = self.results / f"{node}.log"
        return file.read_text(errors="replace") if file.is_file() else ""


# A board's chip, at the time at which the run stands still.
def step_instructions(node: str, count: int) -> Operation[bool]:
    reply = yield "step", {"node": node, "instructions": count}
    return bool(reply["met"])


def read_register(node: str, name: str) -> Operation[Register]:
    reply = yield "read", {"node": node, "register": name}
    return Register(name, int(reply["value"]), int(reply["bits"]), dict(reply["fields"]))


def read_value(node: str, what: str) -> Operation[int]:
    reply = yield "read", {"node": node, "what": what}
    return int(reply["value"]) if "value" in reply else int.from_bytes(bytes.fromhex(reply["data"]), "little")


def read_variable(node: str, name: str, size: int | None) -> Operation[Value]:
    reply = yield "read", {"node": node, "variable": name, "bytes": size}
    return _value(reply)


def read_memory(node: str, address: int, size: int) -> Operation[Value]:
    reply = yield "read", {"node": node, "memory": address, "bytes": size}
    return _value(reply)


def write_register(node: str, name: str, value: int) -> Operation[None]:
    yield "write", {"node": node, "register": name, "value": value}


def write_variable(node: str, name: str, value: int | bytes, size: int | None) -> Operation[None]:
    if isinstance(value, bytes):
        yield "write", {"node": node, "variable": name, "data": value.hex(), "bytes": len(value)}
    else:
        yield "write", {"node": node, "variable": name, "value": value, "bytes": size}


def write_memory(node: str, address: int, data: bytes) -> Operation[None]:
    yield "write", {"node": node, "memory": address, "data": data.hex(), "bytes": len(data)}


def _value(reply: Reply) -> Value:
    return Value(int(reply["address"]), bytes.fromhex(reply["data"]))


class Text:
    """What was sent on one direction of a serial line and nobody expected yet."""

    def __init__(self, session: Session, link: str, sender: str) -> None:
        self._session, self.link, self.sender = session, link, sender
        self.bytes = b""

    def begin(self) -> Operation[None]:
        yield from self._session.capture(self.link, self.sender, "uart", None, None)
        self._session.texts.append(self)

    def take(self) -> Operation[None]:
        """Hands new frames to all texts of the session: the run gives each frame once."""
        for frame in (yield from self._session.frames()):
            for text in self._session.texts:
                if (frame.link, frame.sender) == (text.link, text.sender) and not frame.fault and \
                        frame.kind == "uart":
                    text.bytes += bytes([frame.byte & 0xFF])

    def expect(self, wanted: str | re.Pattern[str], timeout: Time, every: Time) -> Operation[str]:
        pattern = re.compile(re.escape(wanted)) if isinstance(wanted, str) else wanted
        yield from self.take()
        end = self._session.time_ps + round(seconds_of(timeout) * 1e12)
        while (found := pattern.search(self.bytes.decode("latin-1"))) is None:
            if self._session.time_ps >= end:
                raise AssertionError(
                    f"{self.sender} did not send {pattern.pattern if pattern is wanted else wanted!r} on {self.link} "
                    f"within {timeout}; it sent {self.bytes[-200:]!r} (results in {self._session.results})")
            yield from self._session.step(None, min(seconds_of(every), (end - self._session.time_ps) / 1e12),
                                          None, None)
            yield from self.take()
        used, self.bytes = self.bytes[:found.end()], self.bytes[found.end():]
        return used.decode("latin-1")
