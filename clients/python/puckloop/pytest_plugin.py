"""A pytest plugin: `pytest -p puckloop.pytest_plugin`, or `pytest_plugins = ["puckloop.pytest_plugin"]` in conftest.py.

    def test_the_robot_is_woken(puckloop_start):
        run = puckloop_start("hello.toml")
        run.dut("robot0.uart", "robot0.linux").expect("\\x00m", timeout="2 s")

Runs are closed when their test is over. Results folders are in pytest's temporary folders, which keep the last three
sessions; of a test that failed they are named, with the last frames of the run and the command that began it.
"""

from __future__ import annotations

import os
import pathlib
import shlex
from typing import Any, Callable, Iterator

import pytest

from .run import Run, Time, from_snapshot, start
from .scenario import Scenario

_FRAMES = 10  # of a run whose test failed, shown
_TAIL_BYTES = 4096  # of trace.csv, in which they are

_RUNS: pytest.StashKey[list[Run]] = pytest.StashKey()

Start = Callable[..., Run]


def _runs_of(request: pytest.FixtureRequest) -> list[Run]:
    return request.node.stash.setdefault(_RUNS, [])


def _keep(request: pytest.FixtureRequest, run: Run) -> Run:
    _runs_of(request).append(run)
    request.addfinalizer(run.close)
    return run


@pytest.fixture
def puckloop_start(request: pytest.FixtureRequest, tmp_path: pathlib.Path) -> Start:
    """puckloop.start(), with the results in the test's folder and the run closed at its end."""

    def begin(scenario: str | os.PathLike[str] | Scenario, **keywords: Any) -> Run:
        keywords.setdefault("out", tmp_path / f"run{len(_runs_of(request))}")
        return _keep(request, start(scenario, **keywords))

    return begin


@pytest.fixture(scope="session")
def _snapshots(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, pathlib.Path]]:
    yield {}


@pytest.fixture
def puckloop_from(request: pytest.FixtureRequest, tmp_path: pathlib.Path, tmp_path_factory: pytest.TempPathFactory,
                  _snapshots: dict[str, pathlib.Path]) -> Start:
    """A run that waits at `at`, after its boot: puckloop_from("hello.toml", at="40 s", faults=[...]).

    The first test of a session that asks for a scenario, a time and start()'s keywords runs to there and saves; from
    then on each goes on from the snapshot. `faults` and `duration` are the test's own.
    """

    def begin(scenario: str | os.PathLike[str], at: Time, *, faults: tuple[str, ...] | list[str] = (),
              duration: Time | None = None, **keywords: Any) -> Run:
        key = repr((os.fspath(scenario), at, sorted(keywords.items())))
        if key not in _snapshots:
            folder = tmp_path_factory.mktemp("puckloop-boot")
            with start(scenario, out=folder / "results", **keywords) as run:
                run.step(to=at)
                _snapshots[key] = run.save(folder / "run.snapshot")
        out = tmp_path / f"run{len(_runs_of(request))}"
        return _keep(request, from_snapshot(_snapshots[key], out=out, faults=faults, duration=duration))

    return begin


def _last_frames(run: Run) -> list[str]:
    file = run.results / "trace.csv"
    if not file.is_file():
        return []
    with open(file, "rb") as trace:
        trace.seek(max(0, file.stat().st_size - _TAIL_BYTES))
        rows = trace.read().decode(errors="replace").splitlines()
    return rows[1:][-_FRAMES:]  # the first may be cut


def _describe(run: Run) -> str:
    lines = [f"results: {run.results}", f"simulated: {run.time_s:.6f} s", "begun by: " + shlex.join(run.command)]
    return "\n".join(lines + ["last frames (trace.csv):"] + ["  " + row for row in _last_frames(run)])


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    outcome: Any = yield
    report = outcome.get_result()
    if report.when != "call" or not report.failed:
        return
    for run in item.stash.get(_RUNS, []):
        report.sections.append((f"puckloop {run.results.name}", _describe(run)))
