"""A chip looked at from within: registers by name, and a wait for one of them (the coils are at port D)."""

import pytest


@pytest.mark.puckloop("hello", duration="4 s", seeds=[1, 2])
def test_the_motors_run(swarm, robot, board):
    assert board.register("PC").value == 0  # not begun
    robot.linux.expect("\x01", timeout="2 s")  # the wake-up
    begun = swarm.time_s
    swarm.step(for_="1 s", until={"node": board.name, "register": "LATD", "is": "!=", "value": 0}, every="100 us")
    assert swarm.time_s - begun < 1
    assert board.register("TRISD").bits == 16
    with pytest.raises(Exception, match='did you mean "TRISD'):
        board.register("TRISDD")
