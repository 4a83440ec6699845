"""The line to a run: JSON over a unix socket, one request after the other."""

from __future__ import annotations

import json
import socket
from typing import Any

from .errors import ProtocolError, RequestError, RunEnded

PROTOCOL = 1


class Line:
    """Connected, and greeted. OSError: nobody serves the socket; ProtocolError: another version."""

    def __init__(self, path: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self._socket.connect(path)
            self._file = self._socket.makefile("rb")
            self.greeting = self._receive()
            if self.greeting.get("protocol") != PROTOCOL:
                raise ProtocolError(f"the run speaks protocol {self.greeting.get('protocol')!r} "
                                    f"(puckloop {self.greeting.get('version')}), this client {PROTOCOL}")
        except BaseException:
            self._socket.close()
            raise
        self._last = 0

    def _receive(self) -> dict[str, Any]:
        text = self._file.readline()
        if not text:
            raise RunEnded("the run ended without a word", False)
        try:
            reply = json.loads(text)
        except ValueError as error:
            raise ProtocolError(f"a reply that is no JSON: {error}") from None
        if not isinstance(reply, dict):
            raise ProtocolError("a reply that is no object")
        return reply

    def ask(self, op: str, **keys: Any) -> dict[str, Any]:
        """The reply. RequestError: it was refused."""
        self._last += 1
        request = {"id": self._last, "op": op, **{key: value for key, value in keys.items() if value is not None}}
        try:
            self._socket.sendall(json.dumps(request).encode() + b"\n")
            reply = self._receive()
        except (BrokenPipeError, ConnectionResetError):
            raise RunEnded("the run has ended", False) from None
        if reply.get("id") != self._last:
            raise ProtocolError("a reply to another request")
        if not reply.get("ok"):
            raise RequestError(str(reply.get("error", "refused")))
        return reply

    def close(self) -> None:
        """The run, if it goes on, ends without success."""
        self._file.close()
        self._socket.close()
