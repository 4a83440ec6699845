"""The line to a run: JSON over a unix socket, one request after the other."""

from __future__ import annotations

import json
import socket
from typing import Any, Mapping

from .errors import NobodyServes, ProtocolError, RequestError, RunEnded

PROTOCOL = 1

#: The message of what is raised when a run's socket is closed.
HAS_ENDED = "the run has ended"


class Wire:
    """What is said on a line, whoever carries it: texts in, texts out."""

    def __init__(self) -> None:
        self._last = 0

    @staticmethod
    def _object(text: bytes) -> dict[str, Any]:
        if not text:
            raise RunEnded("the run ended without a word", False)
        try:
            reply = json.loads(text)
        except ValueError as error:
            raise ProtocolError(f"a reply that is no JSON: {error}") from None
        if not isinstance(reply, dict):
            raise ProtocolError("a reply that is no object")
        return reply

    def greeting(self, text: bytes) -> dict[str, Any]:
        """What the run said first. ProtocolError: of another version."""
        greeting = self._object(text)
        if greeting.get("protocol") != PROTOCOL:
            raise ProtocolError(f"the run speaks protocol {greeting.get('protocol')!r} "
                                f"(puckloop {greeting.get('version')}), this client {PROTOCOL}")
        return greeting

    def request(self, op: str, keys: Mapping[str, Any]) -> bytes:
        """A line to send; keys that are None are left out."""
        self._last += 1
        request = {"id": self._last, "op": op, **{key: value for key, value in keys.items() if value is not None}}
        return json.dumps(request).encode() + b"\n"

    def reply(self, text: bytes) -> dict[str, Any] | None:
        """The reply; None: to an earlier request, whose caller waits no more. RequestError: it was refused."""
        reply = self._object(text)
        number = reply.get("id")
        if isinstance(number, int) and number < self._last:
            return None
        if number != self._last:
            raise ProtocolError("a reply to another request")
        if not reply.get("ok"):
            raise RequestError(str(reply.get("error", "refused")))
        return reply


class Line:
    """Connected, and greeted. NobodyServes; ProtocolError: another version."""

    def __init__(self, path: str) -> None:
        self._wire = Wire()
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            try:
                self._socket.connect(path)
            except OSError as error:
                raise NobodyServes(f"{path}: nobody serves this socket ({error.strerror or error})") from None
            self._file = self._socket.makefile("rb")
            self.greeting = self._wire.greeting(self._receive())
        except BaseException:
            self._socket.close()
            raise

    def _receive(self) -> bytes:
        try:
            return self._file.readline()
        except ConnectionResetError:
            raise RunEnded(HAS_ENDED, False) from None

    def ask(self, op: str, keys: Mapping[str, Any]) -> dict[str, Any]:
        """The reply. RequestError: it was refused."""
        try:
            self._socket.sendall(self._wire.request(op, keys))
        except (BrokenPipeError, ConnectionResetError):
            raise RunEnded(HAS_ENDED, False) from None
        while (reply := self._wire.reply(self._receive())) is None:
            pass
        return reply

    def close(self) -> None:
        """The run, if it goes on, ends without success."""
        self._file.close()
        self._socket.close()
