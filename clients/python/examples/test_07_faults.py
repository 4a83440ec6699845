"""What a lost, doubled or changed byte does: one test for each, all from one snapshot."""

import pytest

FAULTS = [f"{kind} link=robot0.uart from=robot0.linux begin=2.5s count=1" for kind in ("drop", "duplicate", "flip")]


@pytest.mark.puckloop("hello", at="2 s", duration="6 s", faults=FAULTS)
def test_the_robot_goes_on(swarm, robot, fault):
    swarm.step(to="4 s")
    assert swarm.step(for_="500 ms", until={"frame": {"link": "robot0.uart", "from": "robot0.pic"}}).met
    report = swarm.end().report
    assert [one["fired"] > 0 for one in report["faults"]] == [True], fault
