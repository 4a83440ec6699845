"""Two futures of one past: the same until something is changed."""

import puckloop


def test_what_if(puckloop_start, tmp_path):
    run = puckloop_start("hello", duration="5 s")
    run.step(to="3 s")
    saved = run.save(tmp_path / "run.snapshot")
    run.step(to="4 s")
    there = run.board("robot0.pic").memory(0x0800, 2048)
    with puckloop.from_snapshot(saved, out=tmp_path / "again") as again:
        again.step(to="4 s")
        assert again.board("robot0.pic").memory(0x0800, 2048) == there
    with puckloop.from_snapshot(saved, out=tmp_path / "other", faults=["reset node=robot0.pic at=3.5s"]) as other:
        other.step(to="4 s")
        assert other.board("robot0.pic").memory(0x0800, 2048) != there
