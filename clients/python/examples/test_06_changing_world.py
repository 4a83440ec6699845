"""A box is put before a robot that stands still; its proximity sensors see it."""

import struct

import puckloop


def front(run):
    """Proximity sensors 0 and 7 of the last whole sensor record."""
    run.frames()
    run.step(until={"frame": {"link": "robot0.uart", "from": "robot0.linux"}}, for_="300 ms")
    run.frames()
    run.step(for_="80 ms")
    record = bytes(frame.byte for frame in run.frames())[:72]
    values = struct.unpack_from("<8h", record, 8)
    return values[0] + values[7]


def test_a_box_is_seen(puckloop_start):
    room = puckloop.Scenario(run={"duration": "20 s", "allow": ["program"]}, arena={"size": ["1 m", "1 m"]})
    room.add("box", name="can", centre=["40 cm", "40 cm"], size=["5 cm", "5 cm", "10 cm"])
    room.add("robot", position=["0 m", "0 m"], pic={"firmware": "own"},
             linux={"program": ["puckloop-control", "--behaviour", "still", "--duration", "60"], "start": "20 ms"})
    run = puckloop_start(room)
    run.capture(link="robot0.uart", sender="robot0.pic")
    run.step(to="1 s")
    free = front(run)
    run.act("move can to 7 cm, 0 cm")
    run.step(for_="500 ms")
    assert front(run) > free + 200
