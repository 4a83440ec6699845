"""The robot of `hello` drives and does not leave the arena."""

import math

import puckloop


def test_it_drives(puckloop_start):
    run = puckloop_start("hello", duration="6 s")
    run.step(to="5 s")
    assert run.end().success
    places = puckloop.table(run.results, "trajectory")
    way = sum(math.hypot(b["x_m"] - a["x_m"], b["y_m"] - a["y_m"]) for a, b in zip(places, places[1:]))
    assert 0.2 < way < 1.0  # m; full speed is 0.13 m/s
    assert all(abs(place["x_m"]) < 0.6 and abs(place["y_m"]) < 0.45 for place in places)
