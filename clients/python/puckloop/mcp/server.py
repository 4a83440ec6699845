"""JSON-RPC 2.0 as the Model Context Protocol has it on standard input and output: one message on one line."""

from __future__ import annotations

import json
import signal
import threading
import time
from typing import Any, BinaryIO, Mapping

from ..errors import PuckloopError
from .names import did_you_mean
from .runs import Call, Cancelled
from .tools import Toolbox

VERSIONS = ("2025-06-18", "2025-03-26", "2024-11-05")  #: of the protocol, the newest first
_BATCHES = "2025-03-26"  # the version that has them
_STRUCTURED = "2025-06-18"  # the first version with results beside their text

_LONGEST = 8 << 20  # bytes of a message
_MOST_CALLS = 16  # at once
_GRACE_SECONDS = 5.0  # for calls that are under way when the client has gone
_PROGRESS_SECONDS = 0.5  # at least, between two reports

PARSE, INVALID, METHOD, PARAMS = -32700, -32600, -32601, -32602

INSTRUCTIONS = (
    "puckloop emulates the boards of e-puck robots with their unmodified firmware. start_run begins a scenario that "
    "stands still; step and expect let simulated time go on; decode, read and log look at it; act, write and "
    "inject_fault change it; go_back, save_snapshot and start_from_snapshot return to a time; end_run gives the verdict.")


class Wrong(Exception):
    """A message that gets an error."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code


class Server:
    def __init__(self, toolbox: Toolbox, version: str, incoming: BinaryIO, outgoing: BinaryIO) -> None:
        self._toolbox, self._in, self._out = toolbox, incoming, outgoing
        self._version_of_program = version
        self._writing = threading.Lock()
        self._calls: dict[str | int, tuple[Call, threading.Thread]] = {}
        self._counting = threading.Lock()
        self._version: str | None = None
        self._gone = False

    def serve(self) -> int:
        """Until the client closes its end, or a signal asks to end. Runs are closed."""
        def stop(*_: object) -> None:
            raise KeyboardInterrupt

        signal.signal(signal.SIGTERM, stop)
        grace = _GRACE_SECONDS
        try:
            while (line := self._receive()) != b"":
                self._take(line)
        except KeyboardInterrupt:
            grace = 0
        try:
            self._finish(grace)
            self._toolbox.close()
        except KeyboardInterrupt:
            pass
        return 0

    def _finish(self, grace: float) -> None:
        end = time.monotonic() + grace
        with self._counting:
            calls = list(self._calls.values())
        for call, thread in calls:
            thread.join(max(0.0, end - time.monotonic()))
        for call, thread in calls:
            call.cancelled.set()
        for call, thread in calls:
            thread.join(_GRACE_SECONDS)

    # Lines.
    def _receive(self) -> bytes:
        """A line; empty: the end. One that is too long is passed over, with an error."""
        while True:
            line = self._in.readline(_LONGEST + 1)
            if line == b"" or line.endswith(b"\n") or len(line) <= _LONGEST:
                return line
            while (rest := self._in.readline(_LONGEST)) and not rest.endswith(b"\n"):
                pass
            self._error(None, INVALID, f"a message is longer than {_LONGEST} bytes")

    def _send(self, message: Any) -> None:
        line = json.dumps(message, ensure_ascii=True, separators=(",", ":")).encode() + b"\n"
        with self._writing:
            view = memoryview(line)
            while view and not self._gone:
                try:
                    view = view[self._out.write(view):]
                except (BrokenPipeError, ConnectionResetError):
                    self._gone = True

    def _error(self, number: Any, code: int, text: str) -> None:
        self._send(self._of_error(number, code, text))

    @staticmethod
    def _of_error(number: Any, code: int, text: str) -> dict[str, Any]:
        return {"jsonrpc": "2.0", "id": number, "error": {"code": code, "message": text}}

    # Messages.
    def _take(self, line: bytes) -> None:
        if not line.strip():
            return
        try:
            message = json.loads(line)
        except (ValueError, RecursionError) as error:
            return self._error(None, PARSE, f"no JSON: {error}".splitlines()[0][:200])
        if not isinstance(message, list):
            reply = self._answer(message)
        elif self._version != _BATCHES or not message:
            return self._error(None, INVALID, f"a batch: protocol {self._version or VERSIONS[0]} has none"
                               if message else "an empty batch")
        else:
            # Calls in a batch answer by themselves, as each reply may come when it is ready.
            reply = None
            for one in message:
                answered = self._answer(one)
                if answered is not None:
                    self._send(answered)
        if reply is not None:
            self._send(reply)

    def _answer(self, message: Any) -> dict[str, Any] | None:
        """The reply; None: there is none, or not yet."""
        number = message.get("id") if isinstance(message, dict) else None
        if isinstance(number, bool) or not isinstance(number, (str, int, type(None))):
            number = None
        try:
            if not isinstance(message, dict) or message.get("jsonrpc") != "2.0":
                raise Wrong(INVALID, "no message of JSON-RPC 2.0")
            method = message.get("method")
            if not isinstance(method, str):
                if "result" in message or "error" in message:
                    return None  # an answer; nothing was asked
                raise Wrong(INVALID, "'method' is missing")
            params = message.get("params", {})
            if not isinstance(params, dict):
                raise Wrong(PARAMS if "id" in message else INVALID, "'params' is no object")
            if "id" not in message:
                self._notified(method, params)
                return None
            if number is None:
                raise Wrong(INVALID, "'id' is neither a text nor a whole number")
            result = self._requested(number, method, params)
        except Wrong as wrong:
            if isinstance(message, dict) and "id" not in message and "method" in message:
                return None  # a notification has no answer
            return self._of_error(number, wrong.code, str(wrong))
        return None if result is None else {"jsonrpc": "2.0", "id": number, "result": result}

    def _notified(self, method: str, params: Mapping[str, Any]) -> None:
        if method != "notifications/cancelled":
            return
        number = params.get("requestId")
        with self._counting:
            call = self._calls.get(number) if isinstance(number, (str, int)) else None
        if call is not None:
            call[0].cancelled.set()

    def _requested(self, number: str | int, method: str, params: Mapping[str, Any]) -> dict[str, Any] | None:
        if method == "ping":
            return {}
        if method == "initialize":
            return self._initialize(params)
        known = ("initialize", "ping", "tools/list", "tools/call")
        if method not in known:
            raise Wrong(METHOD, f"there is no method '{method}'{did_you_mean(method, known)}")
        if self._version is None:
            raise Wrong(INVALID, f"'{method}' before 'initialize'")
        if method == "tools/list":
            if params.get("cursor"):
                raise Wrong(PARAMS, "there is no such cursor: the list is one page")
            return {"tools": [tool.listed() for tool in self._toolbox.tools.values()]}
        self._begin_call(number, params)
        return None

    def _initialize(self, params: Mapping[str, Any]) -> dict[str, Any]:
        asked = params.get("protocolVersion")
        if not isinstance(asked, str):
            raise Wrong(PARAMS, f"'protocolVersion' is missing: this server speaks {', '.join(VERSIONS)}")
        if self._version is not None:
            raise Wrong(INVALID, "'initialize' a second time")
        # A client that does not speak the version of the answer goes away.
        self._version = asked if asked in VERSIONS else VERSIONS[0]
        return {"protocolVersion": self._version, "capabilities": {"tools": {"listChanged": False}},
                "serverInfo": {"name": "puckloop", "version": self._version_of_program}, "instructions": INSTRUCTIONS}

    # Calls.
    def _begin_call(self, number: str | int, params: Mapping[str, Any]) -> None:
        name, arguments = params.get("name"), params.get("arguments")
        if not isinstance(name, str) or name not in self._toolbox.tools:
            near = did_you_mean(name, self._toolbox.tools) if isinstance(name, str) else ""
            raise Wrong(PARAMS, f"there is no tool {json.dumps(name)}{near}")
        if not isinstance(arguments, (dict, type(None))):
            raise Wrong(PARAMS, "'arguments' is no object")
        meta = params.get("_meta")
        token = meta.get("progressToken") if isinstance(meta, dict) else None
        call = Call(self._progress(token) if isinstance(token, (str, int)) else None)
        thread = threading.Thread(target=self._do_call, args=(number, name, arguments or {}, call), daemon=True)
        with self._counting:
            if number in self._calls:
                raise Wrong(INVALID, f"request {json.dumps(number)} is under way")
            if len(self._calls) >= _MOST_CALLS:
                raise Wrong(INVALID, f"{_MOST_CALLS} calls are under way")
            self._calls[number] = call, thread
        thread.start()

    def _progress(self, token: str | int) -> Any:
        last = [time.monotonic()]

        def report(done: float, of: float) -> None:
            if time.monotonic() - last[0] < _PROGRESS_SECONDS:
                return
            last[0] = time.monotonic()
            self._send({"jsonrpc": "2.0", "method": "notifications/progress",
                        "params": {"progressToken": token, "progress": done / 1e12, "total": of / 1e12}})

        return report

    def _do_call(self, number: str | int, name: str, arguments: Mapping[str, Any], call: Call) -> None:
        result: dict[str, Any] | None
        try:
            done = self._toolbox.call(name, arguments, call)
            result = {"content": [{"type": "text", "text": json.dumps(done)}], "isError": False}
            if self._version is not None and self._version >= _STRUCTURED:
                result["structuredContent"] = done
        except Cancelled:
            result = None
        except PuckloopError as error:
            result = self._failed(str(error))
        except Exception as error:  # nothing may end the server
            result = self._failed(f"puckloop mcp failed: {type(error).__name__}: {error}")
        with self._counting:
            del self._calls[number]
        # An answer that nobody wants any more is not sent.
        if result is not None and not call.cancelled.is_set():
            self._send({"jsonrpc": "2.0", "id": number, "result": result})

    @staticmethod
    def _failed(text: str) -> dict[str, Any]:
        return {"content": [{"type": "text", "text": " ".join(text.split())}], "isError": True}
