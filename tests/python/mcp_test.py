"""`puckloop mcp`: a scripted client against real runs, and one that does everything wrong."""

import json
import os
import pathlib
import queue
import shutil
import subprocess
import sys
import threading
import time
import unittest

from kit import PROGRAM, SOURCE, InFolder, problems, puckloop

PATIENCE = 60  # seconds of wall time

ROOM = """
[run]
duration = "5 s"
allow = ["program"]

[arena]
size = ["1 m", "1 m"]

[[box]]
name = "carton"
centre = ["30 cm", "0 cm"]
size = ["10 cm", "10 cm", "10 cm"]

[[robot]]
position = ["0 m", "0 m"]
[robot.pic]
firmware = "own"
[robot.linux]
program = ["puckloop-control", "--behaviour", "wander", "--duration", "60"]
start = "20 ms"

[[expect]]
link = "robot0.uart"
from = "robot0.linux"
bytes = "01"
by = "1 s"
"""


class Client:
    """Speaks to a server line by line; `get` waits for the answer to a request."""

    def __init__(self, folder, *words, command=(sys.executable, "-B", "-m", "puckloop.mcp")):
        self.process = subprocess.Popen([*command, "--folder", str(folder), *words], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        env={**os.environ, "PUCKLOOP": PROGRAM})
        self.answers, self.others, self.lines = {}, [], queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()
        self.last = 0

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(line)
        self.lines.put(b"")

    def say(self, message):
        text = message if isinstance(message, bytes) else json.dumps(message).encode()
        self.process.stdin.write(text + b"\n")
        self.process.stdin.flush()

    def next(self, patience=PATIENCE):
        """The next message; None: the server has closed its end."""
        line = self.lines.get(timeout=patience)
        return json.loads(line) if line else None

    def ask(self, method, params=None, **more):
        self.last += 1
        self.say({"jsonrpc": "2.0", "id": self.last, "method": method,
                  **({"params": params} if params is not None else {}), **more})
        return self.last

    def get(self, number):
        while number not in self.answers:
            message = self.next()
            assert message is not None, "the server has gone: " + self.process.stderr.read().decode()
            if "id" in message and message["id"] is not None:
                self.answers[message["id"]] = message
            else:
                self.others.append(message)
        return self.answers.pop(number)

    def tool(self, name, **arguments):
        return self.get(self.ask("tools/call", {"name": name, "arguments": arguments}))

    def begin(self, version="2025-06-18"):
        reply = self.get(self.ask("initialize", {"protocolVersion": version, "capabilities": {},
                                                 "clientInfo": {"name": "test", "version": "0"}}))
        self.say({"jsonrpc": "2.0", "method": "notifications/initialized"})
        return reply["result"]

    def close(self):
        try:
            self.process.stdin.close()
        except BrokenPipeError:
            pass
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()
        self.process.stderr.close()


class Served(InFolder):
    def client(self, *words, begin="2025-06-18", **more):
        client = Client(self.folder, *words, **more)
        self.addCleanup(client.close)
        if begin:
            client.begin(begin)
        return client

    def done(self, reply):
        self.assertFalse(reply["result"]["isError"], reply)
        structured = reply["result"]["structuredContent"]
        self.assertEqual(json.loads(reply["result"]["content"][0]["text"]), structured)
        return structured

    def failed(self, reply, *parts):
        self.assertTrue(reply["result"]["isError"], reply)
        text = reply["result"]["content"][0]["text"]
        self.assertNotIn("\n", text)
        for part in parts:
            self.assertIn(part, text)

    def error(self, reply, code, *parts):
        self.assertEqual(reply["error"]["code"], code, reply)
        for part in parts:
            self.assertIn(part, reply["error"]["message"])


class Runs(Served):
    def test_a_run_from_its_list_to_its_verdict(self):
        self.file("room.toml", ROOM)
        client = self.client()
        listed = self.done(client.tool("list_scenarios"))
        self.assertIn("hello", [one["name"] for one in listed["scenarios"]])
        self.assertEqual([pathlib.Path(one).name for one in listed["files"]], ["room.toml"])
        self.assertTrue(self.done(client.tool("check_scenario", scenario="room.toml")))
        begun = self.done(client.tool("start_run", scenario="room.toml", seed=3))
        run = begun["run"]
        self.assertEqual((begun["time_s"], begun["boards"]), (0.0, ["robot0.pic"]))
        seen = self.done(client.tool("expect", **{"run": run, "link": "robot0.uart", "from": "robot0.linux",
                                                  "bytes": "01", "timeout": "1 s"}))
        self.assertTrue(seen["met"])
        self.assertEqual(seen["sent_hex"], "01")
        never = self.done(client.tool("expect", **{"run": run, "link": "robot0.uart", "from": "robot0.linux",
                                                   "text": "never", "timeout": "50 ms"}))
        self.assertFalse(never["met"])
        self.assertAlmostEqual(never["time_s"], seen["time_s"] + 0.05)
        step = self.done(client.tool("step", **{"run": run, "for": "1 s", "until": {
            "frame": {"link": "robot0.uart", "from": "robot0.pic"}}}))
        self.assertTrue(step["met"])
        self.assertEqual(step["frame"]["sender"], "robot0.pic")
        self.assertEqual(self.done(client.tool("step", run=run, to="500 ms"))["time_s"], 0.5)
        frames = self.done(client.tool("decode", run=run, protocol="epuck", limit=3))
        self.assertEqual(len(frames["frames"]), 3)
        self.assertTrue(frames["more"])
        self.assertIn(frames["frames"][-1]["record"], ("actuators", "sensors"))
        self.assertLessEqual(frames["frames"][-1]["begin_s"], 0.5)
        register = self.done(client.tool("read", run=run, board="robot0.pic", register="TRISA"))
        self.assertEqual((register["bits"], register["name"]), (16, "TRISA"))
        self.done(client.tool("write", run=run, board="robot0.pic", memory=0x2600, data="01ff"))
        memory = self.done(client.tool("read", run=run, board="robot0.pic", memory=0x2600, bytes=2))
        self.assertEqual((memory["data"], memory["value"], memory["signed"]), ("01ff", 0xFF01, -255))
        self.done(client.tool("act", run=run, command="move carton to 20 cm, 5 cm"))
        acted = self.done(client.tool("step", **{"run": run, "for": "100 ms"}))
        self.assertIn("done", acted["acts"][0])
        self.assertIn("session started", self.done(client.tool("log", run=run, node="robot0.linux"))["log"])
        self.assertFalse(self.done(client.tool("list_runs"))["runs"][0]["ended"])
        verdict = self.done(client.tool("end_run", run=run))
        self.assertTrue(verdict["success"], verdict)
        self.assertTrue(verdict["expectations"][0]["met"])
        results = pathlib.Path(verdict["results"])
        self.assertIn(self.folder.resolve(), results.parents)
        self.assertEqual(json.loads((results / "report.json").read_text())["seed"], 3)
        self.failed(client.tool("read", run=run, board="robot0.pic", register="PC"), "the run is over")
        self.assertTrue(self.done(client.tool("list_runs"))["runs"][0]["ended"])

    def test_typing_and_flashing(self):
        self.file("room.toml", ROOM)
        client = self.client()
        run = self.done(client.tool("start_run", scenario="room.toml"))["run"]
        self.done(client.tool("step", run=run, to="300 ms"))
        self.done(client.tool("type", **{"run": run, "link": "robot0.uart", "from": "robot0.pic", "text": "hi"}))
        self.done(client.tool("type", **{"run": run, "link": "robot0.uart", "from": "robot0.pic", "data": "0d0a"}))
        seen = self.done(client.tool("expect", **{"run": run, "link": "robot0.uart", "from": "robot0.pic", "text": "i",
                                                  "timeout": "10 ms"}))
        self.assertFalse(seen["met"])  # what is typed is marked: nobody sent it
        self.failed(client.tool("type", **{"run": run, "link": "robot0.uart", "from": "robot0.pic"}), "one of 'text'")
        shutil.copy(SOURCE / "firmware/ears/ears.hex", self.folder / "ears.hex")
        for image, part in (("none.hex", "no such image"), ("/etc/passwd", "outside of"), ("own", "a file"),
                            ("room.toml", "no known image format")):
            self.failed(client.tool("flash", run=run, board="robot0.pic", image=image), part)
        for fault in ("flash node=robot0.pic image=/etc/passwd", "kind=flash node=robot0.pic image=/etc/passwd"):
            self.failed(client.tool("inject_fault", run=run, fault=fault), "the tool flash")
            self.failed(client.tool("start_run", scenario="room.toml", faults=[fault]), "the tool flash")
        self.done(client.tool("flash", run=run, board="robot0.pic", image="ears.hex"))
        self.done(client.tool("step", run=run, to="500 ms"))
        self.assertEqual(self.done(client.tool("end_run", run=run))["faults"][-1]["fired"], 1)

    def test_a_snapshot_is_gone_on_from_with_a_fault(self):
        self.file("room.toml", ROOM)
        client = self.client()
        run = self.done(client.tool("start_run", scenario="room.toml"))["run"]
        self.done(client.tool("step", run=run, to="400 ms"))
        self.done(client.tool("save_snapshot", run=run, file="a.snapshot"))
        self.assertTrue((self.folder / "a.snapshot").is_file())
        self.failed(client.tool("inject_fault", run=run, fault="dropp link=robot0.uart begin=1s"), "did you mean")
        self.assertEqual(self.done(client.tool("step", run=run, to="500 ms"))["time_s"], 0.5)  # nothing was lost
        self.assertEqual(self.done(client.tool("go_back", run=run, to="450 ms"))["time_s"], 0.45)
        self.failed(client.tool("go_back", run=run, to="2 s"), "an earlier time")
        drop = "drop link=robot0.uart from=robot0.pic begin=600ms"
        self.assertEqual(self.done(client.tool("inject_fault", run=run, fault=drop))["faults"], [drop])
        other = self.done(client.tool("start_from_snapshot", file="a.snapshot", faults=[drop]))
        self.assertEqual(other["time_s"], 0.4)
        for one in (run, other["run"]):
            self.done(client.tool("step", run=one, to="800 ms"))
            wrong = self.done(client.tool("decode", run=one, errors=True, protocol="epuck"))["frames"]
            self.assertTrue(wrong)
            self.assertTrue(all(frame["end_s"] > 0.6 for frame in wrong), wrong[:1])
            self.assertTrue(self.done(client.tool("end_run", run=one))["faults"])

    def test_a_scenario_is_run_to_its_end(self):
        self.file("room.toml", ROOM.replace('bytes = "01"', 'bytes = "FE ED"'))
        client = self.client()
        verdict = self.done(client.tool("run_scenario", scenario="room.toml", duration="1 s"))
        self.assertFalse(verdict["success"])
        self.assertFalse(verdict["expectations"][0]["met"])
        run = self.done(client.tool("start_run", scenario="hello", duration="300 ms", in_process=False))["run"]
        ended = self.done(client.tool("step", run=run, to="1 s"))
        self.assertTrue(ended["ended"])
        self.assertIn("duration", ended["ended_why"])

    def test_a_call_that_is_cancelled_stops_and_has_no_answer(self):
        client = self.client()
        run = self.done(client.tool("start_run", scenario="hello"))["run"]
        number = client.ask("tools/call", {"name": "step", "arguments": {"run": run, "to": "1 h"},
                                           "_meta": {"progressToken": "far"}})
        while not any(one.get("method") == "notifications/progress" for one in client.others):
            message = client.next()
            client.others.append(message)
        progress = client.others[-1]["params"]
        self.assertEqual((progress["progressToken"], progress["total"]), ("far", 3600.0))
        begun = time.monotonic()
        client.get(client.ask("ping"))  # answered while the run goes on
        client.say({"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": number}})
        listed = self.done(client.tool("step", **{"run": run, "for": "10 ms"}))
        self.assertLess(time.monotonic() - begun, PATIENCE / 2)
        self.assertLess(listed["time_s"], 60)
        self.assertNotIn(number, client.answers)
        # A command that is cancelled, and a number that nobody knows.
        number = client.ask("tools/call", {"name": "run_scenario", "arguments": {"scenario": "hello",
                                                                                 "duration": "30 min"}})
        time.sleep(0.3)
        client.say({"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": number}})
        client.say({"jsonrpc": "2.0", "method": "notifications/cancelled", "params": {"requestId": 99}})
        self.assertEqual(client.get(client.ask("ping"))["result"], {})
        self.done(client.tool("end_run", run=run))
        client.close()
        self.assertNotIn(number, client.answers)
        self.assertEqual(client.process.returncode, 0)

    def test_the_command(self):
        client = self.client(command=(PROGRAM, "mcp"))
        run = self.done(client.tool("start_run", scenario="hello"))["run"]
        self.assertEqual(self.done(client.tool("step", run=run, to="20 ms"))["time_s"], 0.02)
        ended = puckloop("mcp", "--folder", "nowhere", folder=self.folder)
        self.refused(ended, "nowhere: is no folder")
        self.refused(puckloop("mcp", env={"PATH": str(self.folder)}), "python3: No such file")

    def test_runs_end_with_their_client(self):
        client = self.client()
        results = pathlib.Path(self.done(client.tool("start_run", scenario="hello"))["results"])
        client.process.stdin.close()
        self.assertEqual(client.process.wait(PATIENCE), 0)
        self.assertEqual(json.loads((results / "control.json").read_text()), {"ended": True})
        client = self.client()
        results = pathlib.Path(self.done(client.tool("start_run", scenario="hello"))["results"])
        client.process.terminate()
        self.assertEqual(client.process.wait(PATIENCE), 0)
        self.assertEqual(json.loads((results / "control.json").read_text()), {"ended": True})


class Refusals(Served):
    def test_versions(self):
        for asked, got in (("2025-06-18", "2025-06-18"), ("2024-11-05", "2024-11-05"), ("1999-01-01", "2025-06-18")):
            client = self.client(begin=None)
            answer = client.begin(asked)
            self.assertEqual(answer["protocolVersion"], got)
            self.assertEqual(answer["serverInfo"]["name"], "puckloop")
            self.assertEqual("structuredContent" in client.tool("list_runs")["result"], got >= "2025-06-18")
        client = self.client(begin=None)
        self.error(client.get(client.ask("tools/list")), -32600, "before 'initialize'")
        self.error(client.get(client.ask("initialize", {})), -32602, "protocolVersion", "2025-06-18")
        self.assertEqual(client.get(client.ask("ping"))["result"], {})
        client.begin()
        self.error(client.get(client.ask("initialize", {"protocolVersion": "2025-06-18"})), -32600, "second time")

    def test_messages_that_are_none(self):
        client = self.client()
        for line, code in ((b"{", -32700), (b"\xff\xfe", -32700), (b"[" * 100000, -32700), (b"1", -32600),
                           (b"[]", -32600), (b'[{"jsonrpc":"2.0","id":1,"method":"ping"}]', -32600),
                           (b'{"id":1,"method":"ping"}', -32600), (b'{"jsonrpc":"1.0","id":1,"method":"ping"}', -32600),
                           (b'{"jsonrpc":"2.0","id":1}', -32600),
                           (b'{"jsonrpc":"2.0","id":null,"method":"ping"}', -32600),
                           (b'{"jsonrpc":"2.0","id":1.5,"method":"ping"}', -32600),
                           (b'{"jsonrpc":"2.0","id":1,"method":"ping","params":[1]}', -32602),
                           (b'{"jsonrpc":"2.0","id":1,"method":7}', -32600)):
            client.say(line)
            self.error(client.next(), code)
        for line in (b"", b"  ", b'{"jsonrpc":"2.0","method":"no/such"}', b'{"jsonrpc":"2.0","id":5,"result":{}}',
                     b'{"jsonrpc":"2.0","method":"notifications/cancelled","params":{"requestId":[1]}}',
                     b'{"jsonrpc":"2.0","method":"notifications/cancelled","params":3}'):
            client.say(line)
        self.error(client.get(client.ask("tools/cal")), -32601, "did you mean tools/call")
        self.error(client.get(client.ask("tools/list", {"cursor": "x"})), -32602, "cursor")
        self.assertEqual(client.get(client.ask("ping"))["result"], {})  # all of them were survived

    def test_batches_of_the_version_that_has_them(self):
        client = self.client(begin="2025-03-26")
        client.say([{"jsonrpc": "2.0", "id": "a", "method": "ping"}, {"jsonrpc": "2.0", "method": "x"}, 3,
                    {"jsonrpc": "2.0", "id": "b", "method": "tools/call", "params": {"name": "list_runs"}}])
        got = [client.next() for _ in range(3)]
        self.assertEqual({one["id"] for one in got}, {"a", "b", None})

    def test_big_messages(self):
        client = self.client()
        big = {"jsonrpc": "2.0", "id": "big", "method": "ping", "params": {"x": "y" * (4 << 20)}}
        client.say(big)
        self.assertEqual(client.get("big")["result"], {})
        client.say(b'{"jsonrpc":"2.0","id":1,"method":"' + b"z" * (20 << 20) + b'"}')
        self.error(client.next(), -32600, "longer than")
        self.assertEqual(client.get(client.ask("ping"))["result"], {})

    def test_tools_are_listed_with_schemas_and_unknown_ones_refused(self):
        client = self.client()
        tools = client.get(client.ask("tools/list"))["result"]["tools"]
        self.assertGreaterEqual(len(tools), 16)
        for tool in tools:
            self.assertEqual(tool["inputSchema"]["type"], "object")
            self.assertTrue(tool["description"].endswith("."), tool["name"])
            self.assertTrue(set(tool["inputSchema"]["required"]) <= set(tool["inputSchema"]["properties"]))
        step = next(tool["inputSchema"] for tool in tools if tool["name"] == "step")
        self.assertEqual(problems({"run": "run1", "to": "1 s"}, step), [])
        self.error(client.tool("stepp"), -32602, '"stepp"', "did you mean step")
        self.error(client.get(client.ask("tools/call", {})), -32602)
        self.error(client.get(client.ask("tools/call", {"name": "step", "arguments": [1]})), -32602)

    def test_arguments_that_do_not_fit(self):
        client = self.client()
        run = self.done(client.tool("start_run", scenario="hello"))["run"]
        for name, arguments, parts in (
                ("step", {}, ("'run' is missing",)),
                ("step", {"run": run, "too": "1 s"}, ("there is no 'too'", "did you mean to")),
                ("step", {"run": run, "to": 1}, ("to: expected string",)),
                ("step", {"run": run, "to": "1 cm"}, ("to: '1 cm' is no time",)),
                ("step", {"run": run, "to": "-1 s"}, ("is no time",)),
                ("step", {"run": run, "to": "nan s"}, ("is no time",)),
                ("step", {"run": run, "to": "9999999 h"}, ("is no time",)),
                ("step", {"run": run, "to": "0 s"}, ("is not after now",)),
                ("step", {"run": run}, ("needs one of",)),
                ("step", {"run": run, "for": "1 s", "until": {"node": "robot0.pik", "register": "PC", "value": 1}},
                 ('did you mean "robot0.pic"',)),
                ("step", {"run": run + "x", "to": "1 s"}, ("there is no run", f"did you mean {run}")),
                ("expect", {"run": run, "link": "robot0.uar", "from": "robot0.pic", "text": "x"},
                 ("did you mean robot0.uart",)),
                ("expect", {"run": run, "link": "robot0.uart", "from": "robot0.pi", "text": "x"}, ("did you mean",)),
                ("expect", {"run": run, "link": "robot0.uart", "from": "robot0.pic", "bytes": "xy"}, ("no bytes",)),
                ("expect", {"run": run, "link": "robot0.uart", "from": "robot0.pic", "text": "\u20ac"}, ("no bytes",)),
                ("read", {"run": run, "board": "robot0.pic", "register": "TRISAA"}, ('did you mean "TRISA"',)),
                ("read", {"run": run, "board": "robot0.pic"}, ("one of 'register'",)),
                ("read", {"run": run, "board": "robot0.pic", "memory": True}, ("expected integer",)),
                ("decode", {"run": run, "protocol": "epuk"}, ("'epuk' is none of",)),
                ("decode", {"run": run, "limit": 0}, ("outside of 1 to",)),
                ("act", {"run": run, "command": "fly"}, ()),
                ("log", {"run": run, "node": "robot0"}, ("did you mean",)),
                ("inject_fault", {"run": run, "fault": "--linux /bin/sh"}, ("is no fault",)),
                ("start_run", {"scenario": "hello", "faults": ["--out /"]}, ("is no fault",)),
                ("start_run", {"scenario": "hello", "firmware": {"--out": "own"}}, ("is no board's name",)),
                ("start_run", {"scenario": "helo"}, ("helo",)),
                ("start_run", {"scenario": "--help"}, ("there is no such file",)),
                ("check_scenario", {"scenario": "nowhere.toml"}, ("there is no such file",))):
            with self.subTest(name=name, arguments=arguments):
                self.failed(client.tool(name, **arguments), *parts)
        self.assertEqual(self.done(client.tool("step", run=run, to="10 ms"))["time_s"], 0.01)  # nothing was lost

    def test_files_outside_of_the_folders(self):
        (self.folder / "within").mkdir()
        self.file("outside.toml", ROOM)
        os.symlink(self.folder / "outside.toml", self.folder / "within" / "link.toml")
        client = Client(self.folder / "within")
        self.addCleanup(client.close)
        client.begin()
        for scenario in ("../outside.toml", str(self.folder / "outside.toml"), "link.toml", "/etc/passwd", ""):
            self.failed(client.tool("start_run", scenario=scenario))
        run = self.done(client.tool("start_run", scenario="hello", duration="1 s"))["run"]
        for file in ("../a.snapshot", "/tmp/a.snapshot", "a.toml", "a\0.snapshot"):
            self.failed(client.tool("save_snapshot", run=run, file=file))
        self.failed(client.tool("start_run", scenario="hello", firmware={"robot0.pic": "/etc/passwd"}), "outside of")
        self.assertEqual({one.name for one in self.folder.iterdir()}, {"within", "outside.toml"})

    def test_what_cannot_be_served(self):
        ended = subprocess.run([sys.executable, "-B", "-m", "puckloop.mcp", "--folder", "nowhere"],
                               capture_output=True, text=True, env={**os.environ, "PUCKLOOP": PROGRAM}, check=False)
        self.assertEqual((ended.returncode, ended.stderr), (2, "puckloop: mcp: nowhere: is no folder\n"))
        ended = subprocess.run([sys.executable, "-B", "-m", "puckloop.mcp"], capture_output=True, text=True,
                               env={**os.environ, "PUCKLOOP": "/bin/true"}, check=False)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("/bin/true: is no puckloop", ended.stderr)


if __name__ == "__main__":
    unittest.main()
