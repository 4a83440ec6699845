"""The process of a run: how it is begun and what is left of it."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
from typing import Any, Mapping, Sequence

from .errors import StartError
from .records import Ended
from .scenario import Scenario
from .session import Time

START_SECONDS = 120.0  #: of wall time, until the run listens
END_SECONDS = 60.0  #: of wall time, until it has written its results
POLL_SECONDS = 0.005


def program() -> str:
    """The puckloop that is driven: PUCKLOOP, else the one in PATH. StartError: there is none."""
    found = os.environ.get("PUCKLOOP") or shutil.which("puckloop")
    if not found:
        raise StartError("no puckloop in PATH, and PUCKLOOP names none")
    return found


@dataclasses.dataclass(frozen=True)
class Plan:
    """How a run is begun: words of `puckloop run`."""

    scenario: str | os.PathLike[str] | Scenario | None  #: None: from a snapshot
    words: Sequence[str]
    out: str | os.PathLike[str] | None
    in_process: bool
    faults: Sequence[str]


def of_scenario(scenario: str | os.PathLike[str] | Scenario, *, out: str | os.PathLike[str] | None,
                firmware: Mapping[str, str | os.PathLike[str]] | None, linux: Sequence[str] | None,
                faults: Sequence[str], seed: int | None, duration: Time | None, in_process: bool,
                options: Sequence[str]) -> Plan:
    words = ["--duration", str(duration)] if duration is not None else []
    words += ["--seed", str(seed)] if seed is not None else []
    for board, image in (firmware or {}).items():
        words += ["--firmware", f"{board}={os.fspath(image)}"]
    for fault in faults:
        words += ["--fault", fault]
    words += options
    if linux is not None:
        words += ["--linux", *linux]
    return Plan(scenario, words, out, in_process, tuple(faults))


def of_snapshot(file: str | os.PathLike[str], *, out: str | os.PathLike[str] | None, faults: Sequence[str],
                duration: Time | None, in_process: bool) -> Plan:
    words = ["--from", os.fspath(file)]
    words += ["--duration", str(duration)] if duration is not None else []
    for fault in faults:
        words += ["--fault", fault]
    return Plan(None, words, out, in_process, tuple(faults))


class Launched:
    """A process that runs a plan. StartError: the program is not there."""

    patience = START_SECONDS

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._temporary = tempfile.TemporaryDirectory(prefix="puckloop-") if plan.out is None else None
        folder = pathlib.Path(self._temporary.name) / "results" if self._temporary else \
            pathlib.Path(os.fspath(plan.out or ""))
        self.results = folder.absolute()
        self.results.mkdir(parents=True, exist_ok=True)
        self.command = [program(), "run"]
        if isinstance(plan.scenario, Scenario):
            # Not within: a snapshot takes what is in the results folder for the run's own.
            self.command.append(str(plan.scenario.write(self.results.with_name(self.results.name + ".toml"))))
        elif plan.scenario is not None:
            self.command.append(os.fspath(plan.scenario))
        self.command += ["--control", "--out", str(self.results)]
        self.command += (["--in-process"] if plan.in_process else []) + list(plan.words)
        (self.results / "control.json").unlink(missing_ok=True)
        try:
            with open(self.results / "puckloop.log", "wb") as log:
                self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        except OSError as error:
            self.remove()
            raise StartError(f"{self.command[0]}: {error.strerror}") from None

    def socket(self) -> str | None:
        """Where it listens; None: not yet. StartError: it has ended, with the last line that it wrote."""
        ended = self.gone()
        path = _control(self.results).get("control")
        if path is None and ended:
            said = (self.results / "puckloop.log").read_text(errors="replace").strip().splitlines()
            raise StartError(said[-1] if said else "the run ended at once")
        return path

    def gone(self) -> bool:
        """It has ended."""
        return self.process.poll() is not None

    def kill(self) -> None:
        """At once; what is left of a run that does not end by itself."""
        if not self.gone():
            self.process.kill()
            self.process.wait()

    def report(self, reply: Mapping[str, Any]) -> Ended:
        """Of a run that is over, with its last reply."""
        return _report(self.results, reply)

    def remove(self) -> None:
        """A results folder that nobody asked for."""
        if self._temporary:
            self._temporary.cleanup()


class Found:
    """A run that somebody else began with --control. StartError: there is none in this results folder."""

    patience = 5.0  #: seconds of wall time, until control.json is written to its end and its socket served

    def __init__(self, results: str | os.PathLike[str]) -> None:
        self.results = pathlib.Path(results).absolute()
        self.command: list[str] = []
        if not (self.results / "control.json").is_file():
            raise StartError(f"{self.results}: no run with --control has these results (there is no control.json)")

    def socket(self) -> str | None:
        """Where it listens; None: not yet. StartError: it is over."""
        if self.gone():
            raise StartError(f"{self.results}: the run is over")
        return _control(self.results).get("control")

    def gone(self) -> bool:
        return bool(_control(self.results).get("ended"))

    def kill(self) -> None:
        """Not our process."""

    def report(self, reply: Mapping[str, Any]) -> Ended:
        return _report(self.results, reply)

    def remove(self) -> None:
        """Not our folder."""


def _control(results: pathlib.Path) -> dict[str, Any]:
    try:
        note = json.loads((results / "control.json").read_text())
    except (OSError, ValueError):  # not yet written, or not to its end
        return {}
    return note if isinstance(note, dict) else {}


def _report(results: pathlib.Path, reply: Mapping[str, Any]) -> Ended:
    file = results / "report.json"
    report = json.loads(file.read_text()) if file.is_file() and file.stat().st_size else {}
    return Ended(bool(report.get("success", reply.get("success", False))),
                 str(report.get("ended_why", reply.get("ended_why", ""))), report)
