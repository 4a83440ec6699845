"""The same for asyncio: what puckloop does, each call awaited.

    import asyncio
    from puckloop import aio

    async def main():
        async with await aio.start("hello") as run:
            await run.step(to="2 s")
            print((await run.board("robot0.pic").register("PORTA")).value)

    asyncio.run(main())

Calls to one run are done one after the other; several runs go on at once. A call that is cancelled has been asked
already: the run does it, its answer is dropped.
"""

from __future__ import annotations

import asyncio
import os
import pathlib
import re
import subprocess
import time
from typing import Any, Mapping, Sequence, TypeVar

from . import launch, session, tables
from .errors import NobodyServes, PuckloopError, RequestError, RunEnded, StartError
from .launch import Found, Launched
from .line import HAS_ENDED, Wire
from .records import Decoded, Ended, Frame, Register, Stepped, Value
from .scenario import Scenario
from .session import Operation, Session, Text, Time

T = TypeVar("T")

_LONGEST_LINE = 1 << 30  # bytes; a million frames are some 200 MB


async def start(scenario: str | os.PathLike[str] | Scenario, *, out: str | os.PathLike[str] | None = None,
                firmware: Mapping[str, str | os.PathLike[str]] | None = None, linux: Sequence[str] | None = None,
                faults: Sequence[str] = (), seed: int | None = None, duration: Time | None = None,
                in_process: bool = True, options: Sequence[str] = ()) -> Run:
    """As puckloop.start()."""
    return await Run._begin(Launched(launch.of_scenario(
        scenario, out=out, firmware=firmware, linux=linux, faults=faults, seed=seed, duration=duration,
        in_process=in_process, options=options)))


async def from_snapshot(file: str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None,
                        faults: Sequence[str] = (), duration: Time | None = None, in_process: bool = True) -> Run:
    """As puckloop.from_snapshot()."""
    return await Run._begin(Launched(launch.of_snapshot(file, out=out, faults=faults, duration=duration,
                                                        in_process=in_process)))


async def attach(results: str | os.PathLike[str]) -> Run:
    """As puckloop.attach()."""
    return await Run._begin(Found(results))


class Line:
    """As puckloop.line.Line."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer, self._wire = reader, writer, Wire()
        self.greeting: dict[str, Any] = {}

    @staticmethod
    async def to(path: str) -> Line:
        try:
            line = Line(*await asyncio.open_unix_connection(path, limit=_LONGEST_LINE))
        except OSError as error:
            raise NobodyServes(f"{path}: nobody serves this socket ({error.strerror or error})") from None
        try:
            line.greeting = line._wire.greeting(await line._receive())
        except BaseException:
            line.close()
            raise
        return line

    async def _receive(self) -> bytes:
        try:
            return await self._reader.readline()
        except ConnectionResetError:
            raise RunEnded(HAS_ENDED, False) from None

    async def ask(self, op: str, keys: Mapping[str, Any]) -> dict[str, Any]:
        try:
            self._writer.write(self._wire.request(op, keys))
            await self._writer.drain()
        except (BrokenPipeError, ConnectionResetError):
            raise RunEnded(HAS_ENDED, False) from None
        while (reply := self._wire.reply(await self._receive())) is None:
            pass
        return reply

    def close(self) -> None:
        self._writer.close()


class Board:
    """As puckloop.Board."""

    def __init__(self, run: Run, name: str) -> None:
        self._run = run
        self.name = name

    async def register(self, name: str) -> Register:
        return await self._run._do(session.read_register(self.name, name))

    async def value(self, what: str) -> int:
        return await self._run._do(session.read_value(self.name, what))

    async def variable(self, name: str, size: int | None = None) -> Value:
        return await self._run._do(session.read_variable(self.name, name, size))

    async def memory(self, address: int, size: int) -> Value:
        return await self._run._do(session.read_memory(self.name, address, size))

    async def set_register(self, name: str, value: int) -> None:
        await self._run._do(session.write_register(self.name, name, value))

    async def set_variable(self, name: str, value: int | bytes, size: int | None = None) -> None:
        await self._run._do(session.write_variable(self.name, name, value, size))

    async def set_memory(self, address: int, data: bytes) -> None:
        await self._run._do(session.write_memory(self.name, address, data))

    async def step(self, instructions: int = 1) -> bool:
        return await self._run._do(session.step_instructions(self.name, instructions))


class Dut:
    """As puckloop.Dut; made by Run.dut()."""

    def __init__(self, run: Run, text: Text) -> None:
        self._run, self._text = run, text
        self.link, self.sender = text.link, text.sender

    async def text(self) -> str:
        await self._run._do(self._text.take())
        return self._text.bytes.decode("latin-1")

    async def expect(self, text: str | re.Pattern[str], timeout: Time = "1 s", every: Time = "10 ms") -> str:
        return await self._run._do(self._text.expect(text, timeout, every))


class Run:
    """As puckloop.Run; made by start() and from_snapshot()."""

    def __init__(self, launched: Launched | Found, line: Line) -> None:
        self._launched, self._line = launched, line
        self._session = Session(line.greeting, launched.results)
        self._turn = asyncio.Lock()

    @staticmethod
    async def _begin(launched: Launched | Found) -> Run:
        try:
            return Run(launched, await Run._connect(launched))
        except BaseException:
            launched.kill()
            launched.remove()
            raise

    @staticmethod
    async def _connect(launched: Launched | Found) -> Line:
        begun = time.monotonic()
        nobody: NobodyServes | None = None
        while time.monotonic() - begun < launched.patience:
            path = launched.socket()
            if path is not None:
                try:
                    return await Line.to(path)
                except NobodyServes as error:  # not yet: the socket's name is known before it is there
                    nobody = error
            await asyncio.sleep(launch.POLL_SECONDS)
        raise nobody or StartError(f"the run did not listen for {launched.patience:g} s")

    # What it is.
    @property
    def results(self) -> pathlib.Path:
        return self._launched.results

    @property
    def command(self) -> list[str]:
        return list(self._launched.command)

    @property
    def nodes(self) -> list[str]:
        return self._session.nodes

    @property
    def boards(self) -> list[str]:
        return self._session.boards

    @property
    def links(self) -> list[str]:
        return self._session.links

    @property
    def time_ps(self) -> int:
        return self._session.time_ps

    @property
    def time_s(self) -> float:
        return self._session.time_s

    @property
    def ended(self) -> Ended | None:
        return self._session.ended

    # How requests are carried.
    async def _ask(self, op: str, keys: Mapping[str, Any]) -> dict[str, Any]:
        self._session.may_ask()
        reply = await self._line.ask(op, keys)
        if self._session.replied(reply):
            await self._over(reply)
        return reply

    async def _do(self, operation: Operation[T]) -> T:
        async with self._turn:
            try:
                request = next(operation)
                while True:
                    try:
                        reply = await self._ask(*request)
                    except PuckloopError as error:
                        request = operation.throw(error)
                    else:
                        request = operation.send(reply)
            except StopIteration as done:
                result: T = done.value
                return result

    async def __aenter__(self) -> Run:
        return self

    async def __aexit__(self, *error: object) -> None:
        await self.close()

    async def close(self) -> None:
        if self.ended is None:
            try:
                await self.end()
            except (PuckloopError, OSError, ValueError):
                pass
        self._line.close()
        self._launched.kill()
        self._launched.remove()

    async def end(self) -> Ended:
        async with self._turn:
            if self.ended is None:
                try:
                    reply = await self._line.ask("end", {})
                except RunEnded as error:
                    reply = {"success": error.success, "ended_why": str(error)}
                await self._over(reply)
        assert self.ended is not None
        return self.ended

    async def _gone(self) -> None:
        """Until the process has ended; it is killed if it does not."""
        begun = time.monotonic()
        while not self._launched.gone() and time.monotonic() - begun < launch.END_SECONDS:
            await asyncio.sleep(launch.POLL_SECONDS)
        self._launched.kill()

    async def _over(self, reply: Mapping[str, Any]) -> None:
        await self._gone()
        self._session.ended = self._launched.report(reply)

    # Time.
    async def step(self, to: Time | None = None, for_: Time | None = None, until: Mapping[str, Any] | str | None = None,
                   every: Time | None = None) -> Stepped:
        return await self._do(self._session.step(to, for_, until, every))

    # What is in it.
    def board(self, name: str) -> Board:
        return Board(self, name)

    async def dut(self, link: str, sender: str) -> Dut:
        text = Text(self._session, link, sender)
        await self._do(text.begin())
        return Dut(self, text)

    async def capture(self, *, link: str | None = None, sender: str | None = None, kind: str | None = None,
                      value: str | None = None, signal: str | None = None) -> None:
        await self._do(self._session.capture(link, sender, kind, value, signal))

    async def frames(self) -> list[Frame]:
        return await self._do(self._session.frames())

    async def decoded(self, protocol: str | None = None, *, link: str | None = None, sender: str | None = None
                      ) -> list[Decoded]:
        words = tables.decode_words(self.results, protocol, link, sender)
        process = await asyncio.create_subprocess_exec(*words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        output, error = await process.communicate()
        return tables.decoded_rows(process.returncode or 0, output, error)

    def log(self, node: str) -> str:
        return self._session.log(node)

    async def act(self, command: str) -> None:
        await self._do(self._session.act(command))

    async def type(self, link: str, sender: str, text: str | bytes, baud: float | None = None) -> None:
        await self._do(self._session.type(link, sender, text, baud))

    async def flash(self, node: str, file: str | os.PathLike[str]) -> None:
        await self._do(self._session.flash(node, pathlib.Path(file).absolute()))

    # Snapshots and faults.
    async def save(self, file: str | os.PathLike[str]) -> pathlib.Path:
        return await self._do(self._session.save(pathlib.Path(file).absolute()))

    async def back(self, to: Time) -> None:
        await self._do(self._session.back(to))

    async def fault(self, *faults: str) -> None:
        await self._do(self._session.fault(faults))
