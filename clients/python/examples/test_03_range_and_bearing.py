"""Two robots hear each other by infra-red light."""

import re


def test_both_hear_most_messages(puckloop_start):
    run = puckloop_start("rab_pair")
    run.step(to="2.5 s")
    for robot, other in (("leader", 2), ("follower", 1)):
        heard = re.search(rf"messages a second: {other}: (\d+) \(", run.log(f"{robot}.linux"))
        assert heard and int(heard[1]) >= 40  # of 50 that are sent
