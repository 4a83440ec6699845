"""A pytest plugin: `pytest -p puckloop.pytest_plugin`, or `pytest_plugins = ["puckloop.pytest_plugin"]` in conftest.py.

    @pytest.mark.puckloop("hello", at="2 s", seeds=[1, 2], faults=["", "drop link=robot0.uart at=2.5s"])
    def test_the_robot_goes_on(swarm, robot, board):
        robot.linux.expect("\\x00m", timeout="2 s")
        assert board.register("PORTA").value

    def test_by_hand(puckloop_start):
        run = puckloop_start("hello.toml")

Runs are closed when their test is over. Results folders are in pytest's temporary folders, which keep the last three
sessions; of a test that failed they are named, with the last frames of the run and the command that began it.
"""

from __future__ import annotations

import dataclasses
import itertools
import os
import pathlib
import shlex
from typing import Any, Callable, Iterator, Mapping, Sequence

import pytest

from .run import Board, Dut, Run, from_snapshot, start
from .scenario import Scenario
from .session import Time

_FRAMES = 10  # of a run whose test failed, shown
_TAIL_BYTES = 4096  # of trace.csv, in which they are
_SHORT = 40  # characters of a fault in a test's name

_RUNS: pytest.StashKey[list[Run]] = pytest.StashKey()

Start = Callable[..., Run]


def _runs_of(request: pytest.FixtureRequest) -> list[Run]:
    runs: list[Run] = request.node.stash.setdefault(_RUNS, [])
    return runs


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

    def begin(scenario: str | os.PathLike[str], at: Time, *, faults: Sequence[str] = (),
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


# Runs by a marker: one test for each image, fault and seed.
@dataclasses.dataclass(frozen=True)
class Case:
    """What one test of a marked function has of images, faults and seeds."""

    scenario: str | os.PathLike[str]
    keywords: Mapping[str, Any]  #: of start(), and `at`
    firmware: Mapping[str, str | os.PathLike[str]] | None
    faults: tuple[str, ...]
    seed: int | None

    def __str__(self) -> str:
        parts = [os.path.basename(os.fspath(image)) for image in (self.firmware or {}).values()]
        parts += [fault if len(fault) <= _SHORT else fault[:_SHORT - 3] + "..." for fault in self.faults]
        parts += [f"seed{self.seed}"] if self.seed is not None else []
        return "-".join(parts) or "as it is"


def _cases(marker: pytest.Mark, seeds: Sequence[int]) -> list[Case]:
    keywords = dict(marker.kwargs)
    images = keywords.pop("images", None) or [None]
    faults = keywords.pop("faults", None) or [""]
    of_marker = keywords.pop("seeds", None)
    if len(marker.args) != 1:
        raise pytest.UsageError('mark.puckloop takes one scenario, such as @pytest.mark.puckloop("hello")')
    return [Case(marker.args[0], keywords, firmware,
                 ((fault,) if fault else ()) if isinstance(fault, str) else tuple(fault), seed)
            for firmware, fault, seed in itertools.product(images, faults, seeds or of_marker or [None])]


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("puckloop")
    group.addoption("--puckloop-seeds", metavar="N,...", default="",
                    help="seeds of every test with mark.puckloop, in place of its own")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "puckloop(scenario, at=..., images=[{board: file}], faults=[...], seeds=[...], "
                            "**start): the run of the fixtures swarm, robot, board and fault, once for each of them")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "puckloop_case" not in metafunc.fixturenames:
        return
    marker = metafunc.definition.get_closest_marker("puckloop")
    if marker is None:
        raise pytest.UsageError(f"{metafunc.definition.nodeid}: swarm, robot, board and fault need "
                                '@pytest.mark.puckloop("SCENARIO")')
    text = str(metafunc.config.getoption("--puckloop-seeds"))
    try:
        seeds = [int(one) for one in text.split(",")] if text else []
    except ValueError:
        raise pytest.UsageError(f"--puckloop-seeds {text}: numbers and commas are expected") from None
    cases = _cases(marker, seeds)
    metafunc.parametrize("puckloop_case", cases, ids=[str(one) for one in cases])


class Robot:
    """A robot of a run by its name."""

    def __init__(self, run: Run, name: str) -> None:
        self.run, self.name = run, name
        self._duts: dict[str, Dut] = {}

    @property
    def pic(self) -> Board:
        """Its main board."""
        return self.run.board(f"{self.name}.pic")

    @property
    def rab(self) -> Board:
        """Its range-and-bearing board."""
        return self.run.board(f"{self.name}.rab")

    def sent_by(self, node: str) -> Dut:
        """What "pic" or "linux" sends on the line between them, from the first call on."""
        if node not in self._duts:
            self._duts[node] = self.run.dut(f"{self.name}.uart", f"{self.name}.{node}")
        return self._duts[node]

    @property
    def linux(self) -> Dut:
        """What its Linux program sends to the main board."""
        return self.sent_by("linux")

    @property
    def log(self) -> str:
        """Of its Linux program, so far."""
        return self.run.log(f"{self.name}.linux")


@pytest.fixture
def swarm(puckloop_case: Case, puckloop_start: Start, puckloop_from: Start) -> Run:
    """The marker's run; with `at` it waits there, after a boot that the session does once."""
    keywords = dict(puckloop_case.keywords)
    if puckloop_case.firmware is not None:
        keywords["firmware"] = dict(puckloop_case.firmware)
    if puckloop_case.seed is not None:
        keywords["seed"] = puckloop_case.seed
    begin = puckloop_from if "at" in keywords else puckloop_start
    return begin(puckloop_case.scenario, faults=puckloop_case.faults, **keywords)


@pytest.fixture
def robot(swarm: Run) -> Robot:
    """The first robot of the run."""
    names = [node.removesuffix(".pic") for node in swarm.boards if node.endswith(".pic")]
    if not names:
        pytest.fail(f"the run has no robot; its boards are {', '.join(swarm.boards)}")
    return Robot(swarm, names[0])


@pytest.fixture
def board(swarm: Run) -> Board:
    """The first board of the run: of a robot its main board."""
    return swarm.board(next((name for name in swarm.boards if name.endswith(".pic")), swarm.boards[0]))


@pytest.fixture
def fault(puckloop_case: Case) -> tuple[str, ...]:
    """The faults of this test's run, as --fault has them."""
    return puckloop_case.faults


# What there is of a test that failed.
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


@pytest.hookimpl(hookwrapper=True)  # type: ignore[misc]  # pytest 7.2 has no types for it
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    outcome: Any = yield
    report = outcome.get_result()
    if report.when != "call" or not report.failed:
        return
    for run in item.stash.get(_RUNS, []):
        report.sections.append((f"puckloop {run.results.name}", _describe(run)))
