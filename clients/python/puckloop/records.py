"""What a run answers with: plain records, which pandas.DataFrame() takes in lists."""

from __future__ import annotations

import dataclasses
from typing import Any, Mapping


@dataclasses.dataclass(frozen=True)
class Frame:
    """A message on a link, as a row of trace.csv."""

    time_ps: int  #: of delivery, picoseconds of simulated time
    link: str
    sender: str  #: node
    kind: str  #: "uart", "i2c", "signal", "radio", "packet", "break", ...
    value: str  #: hexadecimal of bytes, a number of a signal
    detail: str
    fault: str  #: what a fault did to it; empty: nothing

    @property
    def time_s(self) -> float:
        """Simulated time of delivery in seconds."""
        return self.time_ps / 1e12

    @property
    def byte(self) -> int:
        """The byte of a UART frame. ValueError for other kinds."""
        return int(self.value, 16)

    @staticmethod
    def of(row: Mapping[str, Any]) -> Frame:
        return Frame(int(row["time_ps"]), str(row.get("link", "")), str(row.get("from", "")),
                     str(row.get("kind", "")), str(row.get("value", "")), str(row.get("detail", "")),
                     str(row.get("fault", "")))


@dataclasses.dataclass(frozen=True)
class Decoded:
    """A frame of a protocol, as `puckloop trace decode` reads it."""

    begin_s: float  #: first bit on the line or air, seconds of simulated time
    end_s: float  #: the last bit is there
    link: str
    sender: str  #: node
    protocol: str  #: "epuck", "xbee", "bluetooth", "rab", "ircom", "i2c", "can", "mesh", "ip", "bytes", "fault"
    fields: dict[str, Any]  #: what is in it
    errors: tuple[str, ...]  #: what is wrong with it, and what faults did to it

    @staticmethod
    def of(row: Mapping[str, Any]) -> Decoded:
        own = ("begin_s", "end_s", "link", "from", "protocol", "errors")
        return Decoded(float(row["begin_s"]), float(row["end_s"]), str(row["link"]), str(row["from"]),
                       str(row["protocol"]), {key: value for key, value in row.items() if key not in own},
                       tuple(row.get("errors", ())))


@dataclasses.dataclass(frozen=True)
class Register:
    """A register of a chip."""

    name: str
    value: int
    bits: int  #: its width
    fields: dict[str, int]  #: those that the data sheet names


@dataclasses.dataclass(frozen=True)
class Value:
    """Bytes of data memory, or a variable."""

    address: int  #: data address
    data: bytes

    @property
    def value(self) -> int:
        """As an unsigned little-endian number."""
        return int.from_bytes(self.data, "little")

    @property
    def signed(self) -> int:
        """As a signed little-endian number."""
        return int.from_bytes(self.data, "little", signed=True)


@dataclasses.dataclass(frozen=True)
class Stepped:
    """How a step ended."""

    time_ps: int  #: picoseconds of simulated time
    met: bool  #: the condition held; True for a step without one
    frame: Frame | None  #: that was waited for
    acts: tuple[dict[str, Any], ...]  #: the world's replies to commands: "act", and "done" with "at_s" or "refused"

    @property
    def time_s(self) -> float:
        """Simulated time in seconds."""
        return self.time_ps / 1e12


@dataclasses.dataclass(frozen=True)
class Ended:
    """How a run ended, with its report (docs/schema/report.json)."""

    success: bool
    why: str  #: one line
    report: dict[str, Any]
