"""What a client can call. Each tool is a function with a schema of its arguments; results are JSON objects."""

from __future__ import annotations

import dataclasses
import json
import pathlib
from typing import Any, Callable, Mapping

from ..errors import RunEnded
from ..records import Ended
from .arguments import (BOOLEAN, FAULTS, FIRMWARE, Schema, integer, object_of, one_of_texts, refuse_what_does_not_fit,
                        text)
from .commands import checked, ended, why
from .folders import Folders, Refused
from .names import one_of
from .runs import Call, Cancelled, Kept, Runs, picoseconds

_MOST_ROWS = 5000
_MOST_LOG = 20000  # characters
_PROTOCOLS = ("epuck", "xbee", "bluetooth", "bytes", "i2c", "can", "rab", "ircom", "mesh", "fault")

Arguments = Mapping[str, Any]
Result = dict[str, Any]

RUN = text("a run's name, of start_run or list_runs")
TIME = text("simulated time with a unit, such as '20 ms'")


@dataclasses.dataclass(frozen=True)
class Tool:
    name: str
    description: str
    schema: Schema
    function: Callable[[Arguments, Call], Result]
    changes: bool  #: something of a run or a file

    def listed(self) -> Result:
        return {"name": self.name, "description": self.description, "inputSchema": self.schema,
                "annotations": {"readOnlyHint": not self.changes, "destructiveHint": False, "openWorldHint": False}}


class Toolbox:
    def __init__(self, runs: Runs, folders: Folders) -> None:
        self._runs, self._folders = runs, folders
        tools = [
            Tool("list_scenarios", "Shipped scenarios, campaigns and images, and scenario files of the user's folders.",
                 object_of({}), self._list, False),
            Tool("check_scenario", "Checks a scenario without running it, and estimates what a run costs.",
                 object_of({"scenario": text("file, or a shipped scenario's name")}, "scenario"), self._check, False),
            Tool("run_scenario", "Runs a scenario to its end and returns the verdict, with its [[expect]] tables.",
                 object_of({"scenario": text("file, or a shipped scenario's name"), "duration": TIME,
                            "seed": integer("of every random stream", 0), "faults": FAULTS, "firmware": FIRMWARE},
                           "scenario"), self._run, True),
            Tool("start_run", "Starts a scenario; it stands still at 0 s and is driven by step and expect.",
                 object_of({"scenario": text("file, or a shipped scenario's name"), "duration": TIME,
                            "seed": integer("of every random stream", 0), "faults": FAULTS, "firmware": FIRMWARE,
                            "in_process": BOOLEAN}, "scenario"), self._start, True),
            Tool("start_from_snapshot", "Starts a run that goes on from a snapshot, perhaps with faults.",
                 object_of({"file": text("of save_snapshot"), "faults": FAULTS, "duration": TIME}, "file"),
                 self._start_from, True),
            Tool("list_runs", "Runs that were started, and how they are.", object_of({}), self._list_runs, False),
            Tool("step", "Lets a run go on to a time, or for a span, or until a frame or a register's value is seen.",
                 object_of({"run": RUN, "to": TIME, "for": TIME, "until": {
                     "type": "object", "description":
                     "{\"frame\": {\"link\": ..., \"from\": ..., \"value\": ...}}, or {\"node\": ..., "
                     "\"register\": ..., \"is\": \">=\", \"value\": ...}"}}, "run"), self._step, True),
            Tool("expect", "Lets a run go on until a text or bytes were sent on a serial line, or a time is over.",
                 object_of({"run": RUN, "link": text("such as robot0.uart"), "from": text("the node that sends"),
                            "text": text("characters of Latin-1"), "bytes": text("hexadecimal, such as 'F4 01'"),
                            "timeout": TIME}, "run", "link", "from"), self._expect, True),
            Tool("decode", "Frames of a run's links by protocol, with what is wrong in them; the last ones.",
                 object_of({"run": RUN, "link": text("only this link"), "protocol": one_of_texts(_PROTOCOLS),
                            "from": integer("begin, ms of simulated time", 0),
                            "to": integer("end, ms of simulated time", 0), "errors": BOOLEAN,
                            "limit": integer("most frames", 1, _MOST_ROWS)}, "run"), self._decode, False),
            Tool("read", "Reads a register, a variable of the firmware or data memory, without side effects.",
                 object_of({"run": RUN, "board": text("such as robot0.pic"), "register": text("such as TMR1 or PC"),
                            "variable": text("a symbol"), "memory": integer("data address", 0),
                            "bytes": integer("length", 1, 65536)}, "run", "board"), self._read, False),
            Tool("write", "Writes a register, a variable or data memory of a board, as its program would.",
                 object_of({"run": RUN, "board": text("such as robot0.pic"), "register": text("such as LATA"),
                            "variable": text("a symbol"), "memory": integer("data address", 0),
                            "value": integer("a number", 0), "data": text("bytes, hexadecimal")}, "run", "board"),
                 self._write, True),
            Tool("act", "Does something to the world in its next step, such as 'move can to 10 cm, 0 cm'.",
                 object_of({"run": RUN, "command": text("as of puckloop act")}, "run", "command"), self._act, True),
            Tool("go_back", "Takes the run back to an earlier time; what was done to it from then on is taken back.",
                 object_of({"run": RUN, "to": TIME}, "run", "to"), self._back, True),
            Tool("inject_fault", "Goes on with a fault that begins now or later; a refused one leaves the run alone.",
                 object_of({"run": RUN, "fault": text("such as 'drop link=robot0.uart begin=2s count=1'")}, "run",
                           "fault"), self._fault, True),
            Tool("type", "Types into a serial line from now on, as if one of its ends had sent it.",
                 object_of({"run": RUN, "link": text("such as robot0.uart1"), "from": text("the end that sends"),
                            "text": text("UTF-8"), "data": text("bytes, hexadecimal")}, "run", "link", "from"),
                 self._type, True),
            Tool("flash", "Writes another firmware image into a board and resets its chip; RAM stays.",
                 object_of({"run": RUN, "board": text("such as robot0.pic"), "image": text("file of the user's folders")},
                           "run", "board", "image"), self._flash, True),
            Tool("save_snapshot", "Saves the whole run as it is; the run goes on.",
                 object_of({"run": RUN, "file": text("a name that ends with .snapshot")}, "run", "file"), self._save,
                 True),
            Tool("log", "The end of what a node wrote into its log.",
                 object_of({"run": RUN, "node": text("such as robot0.linux")}, "run", "node"), self._log, False),
            Tool("end_run", "Ends a run: programs get their end signal, results are written; verdict and report.",
                 object_of({"run": RUN}, "run"), self._end, True),
        ]
        self.tools = {tool.name: tool for tool in tools}

    def call(self, name: str, arguments: Arguments, call: Call) -> Result:
        """Refused and other PuckloopErrors: one line."""
        tool = self.tools[name]
        refuse_what_does_not_fit(arguments, tool.schema)
        return tool.function(arguments, call)

    def close(self) -> None:
        self._runs.close()

    # Without a run.
    def _list(self, _: Arguments, call: Call) -> Result:
        found: Result = json.loads(checked(["list", "--json"], call, self._folders.folders[0]))
        files = [path for folder in self._folders.folders for path in sorted(folder.glob("*.toml"))]
        return {**found, "files": [str(path) for path in files], "folders": [str(one) for one in self._folders.folders]}

    def _check(self, it: Arguments, call: Call) -> Result:
        result: Result = json.loads(checked(["check", self._folders.scenario(it["scenario"]), "--json"], call,
                                            self._folders.folders[0]))
        return result

    def _run(self, it: Arguments, call: Call) -> Result:
        words = ["run", self._folders.scenario(it["scenario"]), "--in-process"]
        words += ["--duration", f"{picoseconds('duration', it['duration']) / 1e12} s"] if "duration" in it else []
        words += ["--seed", str(it["seed"])] if "seed" in it else []
        for fault in self._runs.check_faults(it.get("faults", ())):
            words += ["--fault", fault]
        for board, image in self._runs.check_images(it.get("firmware", {})).items():
            words += ["--firmware", f"{board}={image}"]
        out = self._folders.new_results()
        status, _, errors = ended([*words, "--out", str(out)], call, self._folders.folders[0])
        file = out / "report.json"
        if status > 1 or not file.is_file():
            raise Refused(why(status, errors))
        report = json.loads(file.read_text())
        return self._verdict(Ended(report["success"], report["ended_why"], report), out)

    # Runs.
    @staticmethod
    def _verdict(ended: Ended, results: pathlib.Path) -> Result:
        kept = {key: ended.report[key] for key in ("failures", "expectations", "mission", "faults", "warnings",
                                                   "simulated_s", "trace_sha256") if key in ended.report}
        return {"success": ended.success, "ended_why": ended.why, **kept, "results": str(results)}

    def _begun(self, kept: Kept, call: Call) -> Result:
        run = kept.run
        try:
            call.look()
        except Cancelled:
            run.close()
            raise
        return {"run": kept.name, "time_s": run.time_s, "boards": run.boards, "links": run.links, "nodes": run.nodes,
                "results": str(run.results)}

    def _start(self, it: Arguments, call: Call) -> Result:
        return self._begun(self._runs.start(it["scenario"], it.get("firmware", {}), it.get("faults", ()),
                                            it.get("seed"), it.get("duration"), it.get("in_process", True)), call)

    def _start_from(self, it: Arguments, call: Call) -> Result:
        return self._begun(self._runs.go_on(it["file"], it.get("faults", ()), it.get("duration")), call)

    def _list_runs(self, _: Arguments, __: Call) -> Result:
        return {"runs": [{"run": kept.name, "time_s": kept.run.time_s, "ended": kept.run.ended is not None,
                          **({"success": kept.run.ended.success, "ended_why": kept.run.ended.why}
                             if kept.run.ended else {}), "results": str(kept.run.results)}
                         for kept in self._runs.all()]}

    def _ended(self, kept: Kept, error: RunEnded) -> Result:
        ended = kept.run.ended or Ended(error.success, str(error), {})
        return {"time_s": kept.run.time_s, "met": False, "ended": True, **self._verdict(ended, kept.run.results)}

    def _step(self, it: Arguments, call: Call) -> Result:
        if ("to" in it) == ("for" in it):
            raise Refused("step needs one of 'to' and 'for'")
        until = it.get("until")
        if until is not None and "text" in until:
            raise Refused("until: a text is waited for by expect")
        kept = self._runs.named(it["run"])
        with kept.turn:
            end = picoseconds("to", it["to"]) if "to" in it else kept.run.time_ps + picoseconds("for", it["for"])
            if kept.run.ended is None and end <= kept.run.time_ps:
                raise Refused(f"{end / 1e12:.9f} s is not after now, {kept.run.time_s:.9f} s")
            try:
                step = kept.step(call, end, until)
            except RunEnded as error:
                return self._ended(kept, error)
            frame = dataclasses.asdict(step.frame) if step.frame else None
            return {"time_s": step.time_s, "met": step.met, "ended": False, **({"frame": frame} if frame else {}),
                    "acts": list(step.acts)}

    def _expect(self, it: Arguments, call: Call) -> Result:
        if ("text" in it) == ("bytes" in it):
            raise Refused("expect needs one of 'text' and 'bytes'")
        try:
            wanted = it["text"].encode("latin-1") if "text" in it else bytes.fromhex(it["bytes"])
        except ValueError:
            raise Refused(f"{it.get('text', it.get('bytes'))!r} are no bytes: Latin-1, or hexadecimal") from None
        kept = self._runs.named(it["run"])
        with kept.turn:
            link = one_of("link", it["link"], kept.run.links)
            sender = one_of("node", it["from"], kept.run.nodes)
            try:
                met, sent = kept.expect(call, link, sender, wanted, picoseconds("timeout", it.get("timeout", "1 s")))
            except RunEnded as error:
                return self._ended(kept, error)
            return {"time_s": kept.run.time_s, "met": met, "ended": False, "sent": sent.decode("latin-1"),
                    "sent_hex": sent.hex()}

    def _decode(self, it: Arguments, call: Call) -> Result:
        kept = self._runs.named(it["run"])
        words = ["trace", "decode", str(kept.run.results), "--json"]
        if "link" in it:
            words += ["--link", one_of("link", it["link"], kept.run.links)]
        words += ["--protocol", it["protocol"]] if "protocol" in it else []
        for key in ("from", "to"):
            words += [f"--{key}", str(it[key] / 1000)] if key in it else []
        words += ["--errors"] if it.get("errors") else []
        limit = it.get("limit", 100)
        with kept.turn:
            rows = checked(words, call, self._folders.folders[0], limit + 1).splitlines()
        return {"frames": [json.loads(row) for row in rows[-limit:]], "more": len(rows) > limit}

    # Boards, the world, faults.
    @staticmethod
    def _place(it: Arguments) -> str:
        places = [key for key in ("register", "variable", "memory") if key in it]
        if len(places) != 1:
            raise Refused("one of 'register', 'variable' and 'memory' is needed")
        return places[0]

    def _read(self, it: Arguments, _: Call) -> Result:
        place, kept = self._place(it), self._runs.named(it["run"])
        with kept.turn:
            board = kept.run.board(it["board"])
            if place == "register":
                return {"time_s": kept.run.time_s, **dataclasses.asdict(board.register(it["register"]))}
            value = board.variable(it["variable"], it.get("bytes")) if place == "variable" else \
                board.memory(it["memory"], it.get("bytes", 2))
            number = {"value": value.value, "signed": value.signed} if len(value.data) <= 8 else {}
            return {"time_s": kept.run.time_s, "address": value.address, "data": value.data.hex(), **number}

    def _write(self, it: Arguments, _: Call) -> Result:
        place, kept = self._place(it), self._runs.named(it["run"])
        if ("value" in it) == ("data" in it):
            raise Refused("write needs one of 'value' and 'data'")
        try:
            data = bytes.fromhex(it.get("data", ""))
        except ValueError:
            raise Refused(f"{it['data']!r} is not hexadecimal") from None
        with kept.turn:
            board = kept.run.board(it["board"])
            if place == "register":
                board.set_register(it["register"], it["value"] if "value" in it else int.from_bytes(data, "little"))
            elif place == "variable":
                board.set_variable(it["variable"], it.get("value", data))
            elif "data" in it:
                board.set_memory(it["memory"], data)
            else:
                raise Refused("memory is written with 'data'")
            return {"time_s": kept.run.time_s}

    def _act(self, it: Arguments, _: Call) -> Result:
        kept = self._runs.named(it["run"])
        with kept.turn:
            kept.run.act(it["command"])
            return {"time_s": kept.run.time_s, "done": "with the next step, which reports it in acts"}

    def _fault(self, it: Arguments, _: Call) -> Result:
        kept = self._runs.named(it["run"])
        (fault,) = self._runs.check_faults([it["fault"]])
        with kept.turn:
            kept.drain()
            kept.run.fault(fault)
            return {"time_s": kept.run.time_s, "faults": kept.run.faults}

    def _type(self, it: Arguments, _: Call) -> Result:
        kept = self._runs.named(it["run"])
        if ("text" in it) == ("data" in it):
            raise Refused("one of 'text' and 'data' is typed")
        try:
            typed: str | bytes = it["text"] if "text" in it else bytes.fromhex(it["data"])
        except ValueError:
            raise Refused(f"{it['data']!r} is not hexadecimal") from None
        with kept.turn:
            kept.drain()
            kept.run.type(it["link"], it["from"], typed)
            return {"time_s": kept.run.time_s}

    def _flash(self, it: Arguments, _: Call) -> Result:
        image, kept = self._folders.image(it["image"]), self._runs.named(it["run"])
        if image == "own":
            raise Refused("a file is flashed, not 'own'")
        with kept.turn:
            kept.drain()
            kept.run.flash(it["board"], image)
            return {"time_s": kept.run.time_s, "flashed": "from the next step on"}

    def _back(self, it: Arguments, _: Call) -> Result:
        kept = self._runs.named(it["run"])
        with kept.turn:
            kept.back(it["to"])
            return {"time_s": kept.run.time_s}

    def _save(self, it: Arguments, _: Call) -> Result:
        file, kept = self._folders.snapshot(it["file"]), self._runs.named(it["run"])
        with kept.turn:
            return {"time_s": kept.run.time_s, "file": str(kept.run.save(file))}

    def _log(self, it: Arguments, _: Call) -> Result:
        kept = self._runs.named(it["run"])
        written = kept.run.log(one_of("node", it["node"], kept.run.nodes))
        return {"log": written[-_MOST_LOG:], "cut": len(written) > _MOST_LOG}

    def _end(self, it: Arguments, _: Call) -> Result:
        kept = self._runs.named(it["run"])
        with kept.turn:
            return self._verdict(kept.run.end(), kept.run.results)
