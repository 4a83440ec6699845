"""`puckloop dap`: an editor's part of the Debug Adapter Protocol, played by a script, at the three chips' images."""

import base64
import json
import os
import pathlib
import re
import shutil
import subprocess
import threading
import unittest

from kit import PROGRAM, SOURCE, InFolder

EPUCK = SOURCE / "firmware" / "epuck"
RAB = SOURCE / "firmware" / "rab"
LAMP = SOURCE / "tests" / "debug" / "programs" / "lamp.c"
IMAGES = os.environ.get("PUCKLOOP_IMAGES", "")
SECONDS = 120  # of wall time, for an answer


class Editor:
    def __init__(self, folder):
        self.process = subprocess.Popen([PROGRAM, "dap"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        cwd=folder)
        self.seq, self.events, self.responses = 0, [], {}
        self.news = threading.Condition()
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        while True:
            header = self.process.stdout.readline()
            if not header:
                break
            length = int(header.split(b":")[1])
            self.process.stdout.readline()
            message = json.loads(self.process.stdout.read(length))
            with self.news:
                if message["type"] == "event":
                    self.events.append(message)
                else:
                    self.responses[message["request_seq"]] = message
                self.news.notify_all()

    def send(self, command, **arguments):
        self.seq += 1
        text = json.dumps({"seq": self.seq, "type": "request", "command": command, "arguments": arguments}).encode()
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(text) + text)
        self.process.stdin.flush()
        return self.seq

    def answer(self, seq):
        with self.news:
            if not self.news.wait_for(lambda: seq in self.responses, SECONDS):
                raise AssertionError(f"no answer to request {seq}; events: {self.events}")
            return self.responses.pop(seq)

    def ask(self, command, **arguments):
        answer = self.answer(self.send(command, **arguments))
        if not answer["success"]:
            raise AssertionError(answer["message"])
        return answer.get("body", {})

    def refused(self, command, **arguments):
        answer = self.answer(self.send(command, **arguments))
        if answer["success"]:
            raise AssertionError(f"{command} was not refused")
        return answer["message"]

    def event(self, name):
        with self.news:
            found = self.news.wait_for(lambda: any(one["event"] == name for one in self.events), SECONDS)
            if not found:
                raise AssertionError(f"no event {name}: {self.events}")
            at = next(i for i, one in enumerate(self.events) if one["event"] == name)
            return self.events.pop(at)["body"]

    def top(self):
        return self.ask("stackTrace", threadId=1)["stackFrames"][0]

    def go(self, command, **arguments):
        """The reason for which it stands still then, and the innermost frame."""
        self.ask(command, threadId=1, **arguments)
        return self.event("stopped")["reason"], self.top()

    def end(self):
        self.ask("disconnect")
        self.event("terminated")
        return self.process.wait(SECONDS)


class Dap(InFolder):
    def begin(self, program, **arguments):
        editor = Editor(self.folder)
        self.addCleanup(lambda: [editor.process.kill(), editor.process.wait(), editor.reader.join(), editor.process.stdin.close(),
                                 editor.process.stdout.close(), editor.process.stderr.close()])
        self.assertTrue(editor.ask("initialize", adapterID="puckloop", linesStartAt1=True)["supportsStepBack"])
        editor.ask("launch", program=str(program), **arguments)
        editor.event("initialized")
        return editor

    def lamp(self):
        if shutil.which("avr-gcc") is None or not pathlib.Path("/usr/lib/avr/include/avr/io.h").exists():
            self.skipTest("avr-gcc with avr-libc is not installed")
        subprocess.run(["avr-gcc", "-mmcu=atmega1284p", "-g", "-O1", "-o", self.folder / "lamp.elf", LAMP], check=True)
        return self.folder / "lamp.elf"

    def test_main_board(self):
        editor = self.begin(EPUCK / "epuck.elf", board="pic", sources=[str(EPUCK)], stopOnEntry=True)
        source = (EPUCK / "main.c").read_text().splitlines()
        line = next(i for i, text in enumerate(source, 1) if "leds_start();" in text)
        made = editor.ask("setBreakpoints", source={"path": str(EPUCK / "main.c")}, breakpoints=[{"line": line}])["breakpoints"]
        self.assertEqual([(one["verified"], one["line"]) for one in made], [(True, line)])
        editor.ask("setExceptionBreakpoints", filters=[])
        editor.ask("configurationDone")
        self.assertEqual(editor.event("stopped")["reason"], "entry")
        self.assertEqual(editor.ask("threads")["threads"], [{"id": 1, "name": "dspic30f6014a"}])
        reason, frame = editor.go("continue")
        self.assertEqual((reason, frame["line"], frame["source"]["path"]), ("breakpoint", line, str(EPUCK / "main.c")))
        begin = frame["instructionPointerReference"]
        reason, frame = editor.go("stepIn")
        self.assertRegex(frame["name"], "^leds_start")
        reason, frame = editor.go("stepIn")
        while not frame["name"].startswith("leds_set"):
            reason, frame = editor.go("stepIn")
        frames = editor.ask("stackTrace", threadId=1)["stackFrames"]
        self.assertEqual([re.match(r"\w+", one["name"])[0] for one in frames[:3]], ["leds_set", "leds_start", "main"])
        self.assertEqual(frames[2]["line"], line)
        reason, frame = editor.go("stepOut")
        self.assertRegex(frame["name"], "^leds_start")
        reason, frame = editor.go("stepOut")
        self.assertRegex(frame["name"], "^main")
        self.assertIn("motors_start();", source[frame["line"] - 1])
        reason, frame = editor.go("stepBack")
        self.assertEqual((frame["line"], frame["instructionPointerReference"]), (line, begin))
        editor.go("next")
        reason, frame = editor.go("reverseContinue")
        self.assertEqual((reason, frame["instructionPointerReference"]), ("breakpoint", begin))

        scopes = {one["name"]: one["variablesReference"] for one in editor.ask("scopes", frameId=1)["scopes"]}
        core = {one["name"]: one["value"] for one in editor.ask("variables", variablesReference=scopes["Core registers"])["variables"]}
        self.assertEqual(int(core["pc"], 16), int(begin, 16))
        special = {one["name"]: one for one in editor.ask("variables", variablesReference=scopes["Registers"])["variables"]}
        fields = editor.ask("variables", variablesReference=special["T1CON"]["variablesReference"])["variables"]
        self.assertIn("TON", [one["name"] for one in fields])
        variables = editor.ask("variables", variablesReference=scopes["Variables"])["variables"]
        array = next(one for one in variables if one["variablesReference"])
        parts = editor.ask("variables", variablesReference=array["variablesReference"])["variables"]
        self.assertGreater(len(parts), 1)
        self.assertEqual(editor.ask("evaluate", expression="T1CON.TON")["result"], "0")
        self.assertIn("did you mean", editor.refused("evaluate", expression="T1COM"))

        code = editor.ask("disassemble", memoryReference=begin, instructionOffset=-2, instructionCount=6)["instructions"]
        self.assertEqual((len(code), int(code[2]["address"], 16)), (6, int(begin, 16)))
        self.assertEqual(code[2]["line"], line)
        self.assertEqual(len(editor.ask("disassemble", memoryReference="0x000000", instructionOffset=-5, instructionCount=10)["instructions"]), 10)
        far = editor.ask("disassemble", memoryReference="0x7ffffe", instructionOffset=-3, instructionCount=6)["instructions"]
        self.assertEqual([one["presentationHint"] for one in far], ["invalid"] * 6)
        self.assertEqual(editor.end(), 0)

    def test_range_and_bearing_board(self):
        editor = self.begin(RAB / "rab.elf", sources=[str(RAB)])  # the board by its image
        made = editor.ask("setFunctionBreakpoints", breakpoints=[{"name": "main"}, {"name": "mian"}])["breakpoints"]
        self.assertEqual([one["verified"] for one in made], [True, False])
        self.assertIn("did you mean \"main\"", made[1]["message"])
        editor.ask("configurationDone")
        self.assertEqual(editor.event("stopped")["reason"], "breakpoint")
        self.assertRegex(editor.top()["name"], "^main")
        self.assertEqual(editor.end(), 0)

    def test_tam_while_it_runs(self):
        editor = self.begin(self.lamp(), mcu="atmega1284p", sources=[str(LAMP.parent)])
        editor.ask("configurationDone")  # and off it goes
        self.assertEqual(len(editor.ask("threads")["threads"]), 1)
        made = editor.ask("setBreakpoints", source={"name": "lamp.c"}, breakpoints=[{"line": 21}, {"line": 9999}])["breakpoints"]
        self.assertEqual([one["verified"] for one in made], [True, False])
        self.assertEqual(editor.event("stopped")["reason"], "breakpoint")
        frames = editor.ask("stackTrace", threadId=1)["stackFrames"]
        self.assertEqual([(one["name"].split("+")[0], one["line"]) for one in frames[:2]], [("remember", 21), ("main", 39)])
        editor.ask("setBreakpoints", source={"name": "lamp.c"}, breakpoints=[])
        editor.ask("continue", threadId=1)
        editor.ask("pause", threadId=1)
        self.assertEqual(editor.event("stopped")["reason"], "pause")
        info = editor.ask("dataBreakpointInfo", name="levels")
        editor.ask("setDataBreakpoints", breakpoints=[{"dataId": info["dataId"], "accessType": "write"}])
        reason, _ = editor.go("continue")
        self.assertEqual(reason, "data breakpoint")
        levels = next(one for one in editor.ask("variables", variablesReference=1)["variables"] if one["name"] == "levels")
        data = editor.ask("readMemory", memoryReference=levels["memoryReference"], count=4)
        shown = base64.b64decode(data["data"])
        self.assertEqual(len(shown), 4)
        self.assertEqual(editor.ask("evaluate", expression="levels[1]")["result"].split()[0], str(shown[1]))
        beyond = editor.ask("readMemory", memoryReference="0x80fff0", count=64)
        self.assertEqual(beyond["unreadableBytes"], 64)
        self.assertEqual(editor.end(), 0)

    @unittest.skipUnless(IMAGES, "PUCKLOOP_IMAGES names no folder: real images are skipped")
    def test_real_images_of_xc16_and_c30(self):
        for name in ("demoGCtronic.X.production.elf", "randb.cof"):
            image = pathlib.Path(IMAGES) / name
            if not image.exists():
                self.skipTest(f"{image} is not there")
            self.check_real_image(image)

    def check_real_image(self, image):
        editor = self.begin(image, stopOnEntry=True)
        editor.ask("setFunctionBreakpoints", breakpoints=[{"name": "main"}])
        editor.ask("configurationDone")
        editor.event("stopped")
        reason, frame = editor.go("continue")
        self.assertEqual((reason, frame["source"]["name"][-2:]), ("breakpoint", ".c"))
        begin = frame["instructionPointerReference"]
        editor.go("next")
        self.assertEqual(editor.go("stepBack")[1]["instructionPointerReference"], begin)
        self.assertEqual(editor.end(), 0)

    def test_what_cannot_be(self):
        editor = Editor(self.folder)
        self.addCleanup(lambda: [editor.process.kill(), editor.process.wait(), editor.reader.join(), editor.process.stdin.close(),
                                 editor.process.stdout.close(), editor.process.stderr.close()])
        self.assertIn("launch first", editor.refused("stackTrace", threadId=1))
        self.assertIn("nothing.elf", editor.refused("launch", program="nothing.elf"))
        self.assertIn("program", editor.refused("launch"))
        self.assertIn("cannot be used", editor.refused("launch", program=7))
        self.assertIn("did you mean \"continue\"", editor.refused("contineu"))
        editor.ask("launch", program=str(EPUCK / "epuck.elf"))
        self.assertIn("already", editor.refused("launch", program=str(EPUCK / "epuck.elf")))
        self.assertIn("is no address", editor.refused("readMemory", memoryReference="here", count=1))
        self.assertIn("too many", editor.refused("disassemble", memoryReference="0x100", instructionCount=10**9))
        self.assertEqual(editor.end(), 0)

    def test_extension_of_vs_code(self):
        folder = SOURCE / "clients" / "vscode"
        package = json.loads((folder / "package.json").read_text())
        self.assertEqual(package["version"], os.environ["PUCKLOOP_VERSION"])
        debugger = package["contributes"]["debuggers"][0]
        ended = subprocess.run([folder / debugger["program"]], input=b"", capture_output=True, timeout=SECONDS, check=False)
        self.assertEqual((ended.returncode, ended.stderr), (0, b""))
        # What it offers, and what `puckloop new` writes, is what `launch` takes.
        offered = debugger["configurationAttributes"]["launch"]["properties"]
        taken = set(re.findall(r'arguments, "(\w+)"', (SOURCE / "bench/debugger/dap_server.cpp").read_text())) | {"uart1", "uart2"}
        self.assertEqual(set(offered) - taken, set())
        subprocess.run([PROGRAM, "new", "mine"], cwd=self.folder, check=True, capture_output=True)
        made = json.loads((self.folder / "mine" / ".vscode" / "launch.json").read_text())["configurations"][0]
        self.assertEqual(made["type"], debugger["type"])
        self.assertEqual(set(made) - {"name", "type", "request"} - set(offered), set())

    def test_bytes_that_are_no_messages(self):
        for bytes_, status in ((b"", 0), (b"GET / HTTP/1.1\r\n\r\n", 2), (b"Content-Length: 9999999999\r\n\r\n", 2),
                               (b"Content-Length: 5\r\n\r\nabcde", 2), (b"x" * 5000, 2),
                               (b"Content-Length: 2\r\n\r\n{}" * 3, 0), (b'Content-Length: 13\r\n\r\n{"type":true}', 0)):
            ended = subprocess.run([PROGRAM, "dap"], input=bytes_, capture_output=True, timeout=SECONDS, check=False)
            self.assertEqual(ended.returncode, status, (bytes_[:40], ended.stderr))
            self.assertEqual(ended.stderr.count(b"\n"), 1 if status else 0)


if __name__ == "__main__":
    unittest.main()
