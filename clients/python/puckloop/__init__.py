"""Drives puckloop, the emulator of the e-puck's boards, over its control protocol (docs/control_protocol.md).

    import puckloop

    with puckloop.start("scenarios/hello.toml") as run:
        run.step(to="2 s")
        print(run.board("robot0.pic").register("PORTA").value)

Simulated time stands still between two calls: what is done at a simulated time depends on nothing else. Times are
texts with a unit ("20 ms") or numbers of seconds. puckloop.aio has the same for asyncio. Needs Python 3.11 or newer
and nothing besides.
"""

from .errors import NobodyServes, ProtocolError, PuckloopError, RequestError, RunEnded, StartError
from .launch import program
from .records import Decoded, Ended, Frame, Register, Stepped, Value
from .run import Board, Dut, Run, attach, from_snapshot, start
from .scenario import Scenario
from .tables import dataframe, decoded, table

__all__ = ["Board", "Decoded", "Dut", "Ended", "Frame", "NobodyServes", "ProtocolError", "PuckloopError", "Register",
           "RequestError", "Run", "RunEnded", "Scenario", "StartError", "Stepped", "Value", "attach", "dataframe",
           "decoded", "from_snapshot", "program", "start", "table"]
