#!/usr/bin/python3
"""Counts the robots on a black spot, and moves the spot to the other side once half of them are there.

A mission program of scenarios/moving_spot.toml: what the tracker sees comes in, score and commands go
out (docs/missions.md). It could as well use nothing but json and standard input and output.
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "clients/python"))
from puckloop.mission import Mission  # noqa: E402

RADIUS = 0.3  # m


def main() -> None:
    side, moved = 1, 0
    with Mission() as mission:
        for frame in mission:
            inside = [robot for robot in frame.robots if math.hypot(robot.x, robot.y - 0.6 * side) <= RADIUS]
            mission.score += len(inside)
            if len(inside) * 2 < len(mission.robots):
                continue
            side, moved = -side, moved + 1
            mission.act(f"set white grey {0 if side < 0 else 1}")
            mission.act(f"set black grey {0 if side > 0 else 1}")
            print(f"{frame.time:.1f} s: {len(inside)} robots are there, the spot moves")
            if moved == 10:
                mission.end("the spot moved ten times")


if __name__ == "__main__":
    main()
