"""What can go wrong."""


class PuckloopError(Exception):
    """Of all errors of this package; the text is one line."""


class StartError(PuckloopError):
    """The run did not begin: the program is not there, or refused its scenario or options."""


class NobodyServes(StartError):
    """There is a socket, or its name, and no run listens to it."""


class ProtocolError(PuckloopError):
    """The program speaks another version of the protocol, or something else."""


class RequestError(PuckloopError):
    """The run refused a request: an unknown name, a time that is past. Nothing was done."""


class RunEnded(PuckloopError):
    """The run is over, so that nothing can be asked of it. `success` states how."""

    def __init__(self, text: str, success: bool) -> None:
        super().__init__(text)
        self.success = success
