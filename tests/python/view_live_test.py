"""`puckloop view` over a run that goes on: the page drives it, in a headless Chromium."""

import json
import pathlib
import signal
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.error
import urllib.request

from browser import Browser, find_chromium
from kit import PROGRAM, SOURCE, puckloop

SCENARIO = SOURCE / "scenarios/hello.toml"


class Live(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.out = self.folder / "o"

    def start(self, duration, scenario=SCENARIO):
        """A run that waits for its client, and a viewer: its address."""
        # pylint: disable=consider-using-with
        self.run = subprocess.Popen([PROGRAM, "run", scenario, "--control", "--duration", str(duration), "--out",
                                     self.out], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, self.run)
        until = time.monotonic() + 60
        while "control" not in self.note() and time.monotonic() < until:
            time.sleep(0.02)
        self.viewer = subprocess.Popen([PROGRAM, "view", self.out], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                       text=True)
        self.addCleanup(self.end, self.viewer)
        return self.viewer.stdout.readline().strip()

    def note(self):
        try:
            return (self.out / "control.json").read_text()
        except OSError:
            return ""

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def report(self, folder=None):
        return json.loads(((folder or self.out) / "report.json").read_text())

    def ask(self, address, request, origin=None):
        """Status and text of a POST."""
        root = address.split("/", 3)
        headers = {"Origin": "/".join(root[:3])} if origin is None else {"Origin": origin} if origin else {}
        post = urllib.request.Request(address + "drive", json.dumps(request).encode(), headers, method="POST")
        try:
            with urllib.request.urlopen(post, timeout=60) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read().decode()

    def state(self, address):
        with urllib.request.urlopen(address + "drive", timeout=60) as answer:
            return json.loads(answer.read())

    def wait(self, address, condition, limit=120):
        until = time.monotonic() + limit
        while not condition(self.state(address)):
            self.assertLess(time.monotonic(), until, self.state(address))
            time.sleep(0.02)
        return self.state(address)

    def test_the_trace_with_a_viewer_is_the_one_without(self):
        plain = self.folder / "plain"
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--out", plain).returncode, 0)
        address = self.start(2)
        self.assertEqual(self.ask(address, {"page": "a", "do": "step", "ms": 1})[0], 200)
        self.assertAlmostEqual(self.wait(address, lambda s: s["time_s"] > 0)["time_s"], 0.001)
        self.assertEqual(self.ask(address, {"page": "a", "do": "play", "speed": 0})[0], 200)
        self.wait(address, lambda s: s["over"])
        self.assertEqual(self.run.wait(60), 0)
        self.assertEqual(self.report()["trace_sha256"], self.report(plain)["trace_sha256"])

    def test_what_its_user_did_replays_to_the_same_trace(self):
        address = self.start(2)
        self.ask(address, {"page": "a", "do": "step", "ms": 700})
        self.wait(address, lambda s: s["time_s"] > 0.69)
        self.ask(address, {"page": "a", "do": "act", "command": "move can to 10 cm, 5 cm"})
        self.ask(address, {"page": "a", "do": "act", "command": "move nobody to 10 cm, 5 cm"})
        self.ask(address, {"page": "a", "do": "play", "speed": 0})
        state = self.wait(address, lambda s: s["over"])
        self.assertIn("can", state["acts"][0]["answer"])
        self.assertFalse(state["acts"][0]["refused"])
        self.assertTrue(state["acts"][1]["refused"])
        self.run.wait(60)
        again = self.folder / "again"
        events = self.folder / "events.toml"
        events.write_text((self.out / "events.toml").read_text())
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--events", events, "--out",
                                  again).returncode, 0)
        self.assertEqual(self.report()["trace_sha256"], self.report(again)["trace_sha256"])

    def test_one_page_drives_and_others_look_on(self):
        address = self.start(2)
        self.assertEqual(self.ask(address, {"page": "a", "do": "step", "ms": 10})[0], 200)
        self.assertEqual(self.ask(address, {"page": "b", "do": "step", "ms": 10}), (409, "another page drives"))
        self.assertEqual(self.ask(address, {"page": "b", "do": "take"})[0], 200)
        self.assertEqual(self.ask(address, {"page": "a", "do": "pause"})[0], 409)
        for request in ([], {}, {"page": "b"}, {"page": "b", "do": "fly"}, {"page": "b", "do": "step", "ms": 0},
                        {"page": "b", "do": "step", "ms": "x"}, {"page": "b", "do": "play", "speed": -1},
                        {"page": "b", "do": "act", "command": ""}, {"page": "x" * 100, "do": "pause"}):
            self.assertEqual(self.ask(address, request)[0], 409, request)
        for origin in ("", "http://evil.example", "null"):
            self.assertEqual(self.ask(address, {"page": "b", "do": "pause"}, origin)[0], 403)
        self.assertEqual(self.ask(address, {"page": "b", "do": "act", "command": "x" * 5000})[0], 413)
        # A second viewer finds the run taken.
        second = puckloop("view", self.out)
        self.assertEqual(second.returncode, 2)
        self.assertIn("one drives at a time", second.stderr)
        # Ctrl-C of the viewer ends the run.
        self.viewer.send_signal(signal.SIGINT)
        self.assertEqual(self.viewer.wait(60), 0)
        self.assertEqual(self.run.wait(60), 0)
        self.assertEqual(self.report()["ended_why"].split(":")[-1].strip(), "its client ended the run")

    def test_a_run_goes_back_takes_a_fault_and_is_looked_into(self):
        plain = self.folder / "plain"
        drop = "drop link=robot0.uart from=robot0.pic begin=900ms count=1"
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--fault", drop, "--out",
                                  plain).returncode, 0)
        address = self.start(2)
        with urllib.request.urlopen(address + "possible", timeout=60) as answer:
            possible = json.loads(answer.read())
        self.assertIn("robot0.pic", possible["boards"])
        self.assertIn("drop", [kind["name"] for kind in possible["kinds"] if kind["on"] == "uart"])
        self.assertIn({"name": "robot0.uart", "on": "uart", "key": "link", "ends": ["robot0.linux", "robot0.pic"]},
                      possible["places"])
        self.ask(address, {"page": "a", "do": "look", "board": "robot0.pic", "items": [
            "TMR1", "NONE", "0x850:4", "U2STA.TRMT", "nonsense <"]})
        self.ask(address, {"page": "a", "do": "until", "condition": "T1CON >= 0x8000", "board": "robot0.pic",
                           "ms": 500})
        state = self.wait(address, lambda s: s["acts"])
        self.assertIn("it holds", state["acts"][0]["answer"])
        state = self.wait(address, lambda s: s["look"] and s["look"]["time_s"] == s["time_s"])
        look = state["look"]
        self.assertEqual([value["ok"] for value in look["values"]], [True, False, True, True, False])
        self.assertEqual(len(look["values"][2]["data"]), 8)
        self.assertIn(look["values"][3]["text"], ("0", "1"))
        self.assertTrue(look["where"]["instructions"])
        self.ask(address, {"page": "a", "do": "step", "ms": 800})
        self.ask(address, {"page": "a", "do": "act", "command": "move can to 10 cm, 5 cm"})
        self.ask(address, {"page": "a", "do": "step", "ms": 200})
        self.ask(address, {"page": "a", "do": "back", "to_s": 0.6})
        self.ask(address, {"page": "a", "do": "fault", "fault": "dropp link=robot0.uart"})
        self.ask(address, {"page": "a", "do": "fault", "fault": drop})
        state = self.wait(address, lambda s: s["epoch"] == 2)
        self.assertEqual(state["time_s"], 0.6)
        refused = [act for act in state["acts"] if act["refused"]]
        self.assertEqual(len(refused), 1)
        self.assertIn("did you mean", refused[0]["answer"])
        for request in ({"do": "back"}, {"do": "back", "to_s": "x"}, {"do": "fault"}, {"do": "until"},
                        {"do": "flash"}, {"do": "flash", "board": "robot0.pic"}, {"do": "flash", "file": "x"},
                        {"do": "flash", "board": "x" * 65, "file": "x"},
                        {"do": "flash", "board": "robot0.pic", "file": "x" * 1001},
                        {"do": "until", "condition": {}}, {"do": "until", "condition": "TMR1 > 2", "ms": 1e9},
                        {"do": "until", "condition": "x" * 1001}, {"do": "type"},
                        {"do": "type", "link": "robot0.uart", "from": "robot0.pic"},
                        {"do": "type", "link": "robot0.uart", "from": "robot0.pic", "text": "x" * 1001},
                        {"do": "type", "link": "x" * 65, "from": "robot0.pic", "text": "x"},
                        {"do": "look", "items": 3},
                        {"do": "look", "items": [1]}, {"do": "look", "items": ["x"] * 41},
                        {"do": "look", "items": ["x" * 65]}):
            self.assertEqual(self.ask(address, {"page": "a", **request})[0], 409, request)
        self.ask(address, {"page": "a", "do": "play", "speed": 0})
        self.wait(address, lambda s: s["over"])
        self.assertEqual(self.run.wait(60), 0)
        self.assertEqual(self.report()["trace_sha256"], self.report(plain)["trace_sha256"])

    def test_run_view_begins_run_and_page_at_once(self):
        self.run = subprocess.Popen([PROGRAM, "run", SCENARIO, "--view", "--duration", "2", "--out", self.out],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, self.run)
        address = self.run.stdout.readline().strip()
        self.assertEqual(self.ask(address, {"page": "a", "do": "play", "speed": 0})[0], 200)
        self.wait(address, lambda s: s["over"])
        self.assertEqual(len(self.state(address)["acts"]), 0)  # the page stays
        self.run.send_signal(signal.SIGINT)
        said, _ = self.run.communicate(timeout=60)
        self.assertEqual(self.run.returncode, 0, said)
        self.assertTrue(self.report()["success"])
        # Ctrl-C in the middle ends the run; what cannot run has one message; a run's failure is the status.
        self.run = subprocess.Popen([PROGRAM, "run", SCENARIO, "--view", "--out", self.out], text=True,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(self.end, self.run)
        self.run.stdout.readline()
        self.run.send_signal(signal.SIGINT)
        self.run.communicate(timeout=60)
        self.assertEqual(self.run.returncode, 0)
        wrong = puckloop("run", "nowhere.toml", "--view")
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        wrong = puckloop("run", SCENARIO, "--view", "--realtime", "--out", self.out)
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        wrong = puckloop("run", SCENARIO, "--view-port", 5000, "--out", self.out)
        self.assertEqual(wrong.returncode, 2)

    def test_a_condition_that_does_not_come_is_given_up(self):
        address = self.start(3600)
        self.ask(address, {"page": "a", "do": "until", "condition": 'text "never said"'})
        state = self.wait(address, lambda s: s["until"] and s["time_s"] > 0.2)
        self.assertEqual(state["until"], 'text "never said"')
        self.assertEqual(self.ask(address, {"page": "a", "do": "pause"})[0], 200)
        state = self.wait(address, lambda s: s["acts"])
        self.assertIn("stopped", state["acts"][0]["answer"])
        self.assertLess(state["time_s"], 59)
        # Ctrl-C in the middle of another one ends viewer and run.
        self.ask(address, {"page": "a", "do": "until", "condition": "frame link=robot0.uart value=zz"})
        self.wait(address, lambda s: s["until"])
        self.viewer.send_signal(signal.SIGINT)
        self.assertEqual(self.viewer.wait(30), 0)
        self.assertEqual(self.run.wait(30), 0)

    def test_a_port_that_is_taken_and_a_run_that_was_killed(self):
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 1, "--out", self.out).returncode, 0)
        before = self.report()["trace_sha256"]
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            wrong = puckloop("run", SCENARIO, "--view", "--view-port", taken.getsockname()[1], "--out", self.out)
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        self.assertIn("--view-port", wrong.stderr)
        self.assertEqual(self.report()["trace_sha256"], before)  # nothing is lost
        address = self.start(30)
        self.ask(address, {"page": "a", "do": "step", "ms": 500})
        self.wait(address, lambda s: s["time_s"] > 0.4)
        self.run.kill()
        self.viewer.kill()
        self.run.wait(30)
        self.viewer.wait(30)
        page = self.folder / "killed.html"
        done = puckloop("view", self.out, "--export", page)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("was killed", done.stderr)
        for words in (("--export", "x.gif"), ("--export", "x")):
            self.assertEqual(puckloop("view", self.out, *words).returncode, 2)

    def test_one_board_alone(self):
        image = SOURCE / "firmware/epuck/epuck.elf"
        self.run = subprocess.Popen([PROGRAM, "exec", image, "--view", "--seconds", "1", "--selector", "3"],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.addCleanup(self.end, self.run)
        address = self.run.stdout.readline().strip()
        self.ask(address, {"page": "a", "do": "step", "ms": 100})
        # As the bench's other end would: wake-up and configuration, and the board answers.
        self.ask(address, {"page": "a", "do": "type", "link": "board.uart2", "from": "board.uart2", "text": "\x01\0\0\0\0"})
        self.ask(address, {"page": "a", "do": "play", "speed": 0})
        state = self.wait(address, lambda s: s["over"])
        self.assertEqual([act["refused"] for act in state["acts"]], [False], state)
        self.run.send_signal(signal.SIGINT)
        self.run.communicate(timeout=60)
        self.assertEqual(self.run.returncode, 0)
        report = self.report(self.folder / "out/exec_epuck")
        self.assertEqual(report["links"]["board.uart2"]["from_b"]["uart_frames"], 72)
        scenario = (self.folder / "out/exec_epuck.toml").read_text()
        self.assertIn("selector = 3", scenario)
        self.assertEqual(puckloop("run", "out/exec_epuck.toml", folder=self.folder).returncode, 0)  # to begin one's own from
        for words, part in ((("--json",), "--json"), (("--uart1", "pty"), "script:FILE"), (("--mcu", "dspic30f6014a"), "--mcu")):
            wrong = puckloop("exec", image, "--view", *words, folder=self.folder)
            self.assertEqual(wrong.returncode, 2)
            self.assertIn(part, wrong.stderr)
        wrong = puckloop("exec", "nowhere.elf", "--board", "pic", "--view", folder=self.folder)
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1))
        self.assertFalse((self.folder / "out/exec_nowhere.toml").exists())

    def test_the_page_goes_back_looks_and_injects(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        address = self.start(30)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        browser.wait("document.body && document.body.dataset.ready")
        browser.value("""(() => { const app = window.puckloopView; app.board.chooser.value = 'robot0.pic'; app.board.look();
            app.board.add('TMR1'); app.board.add('U2STA.TRMT'); app.board.add('no such'); app.drive({ do: 'step', ms: 6000 }); })()""")
        browser.wait("Number(document.body.dataset.simulated) === 6")
        browser.wait("document.querySelectorAll('#watches tr').length > 10")
        self.assertRegex(browser.value("document.querySelector('#watches tr').textContent"), "^TMR10x[0-9a-f]{4} ")
        self.assertEqual(browser.value("document.querySelectorAll('#watches tr.failed').length"), 1)
        self.assertEqual(browser.value("document.querySelectorAll('#code .here').length"), 1)
        browser.wait("Number(document.body.dataset.events) > 20")
        browser.value("document.getElementById('back-5').click()")
        browser.wait("document.body.dataset.epoch === '1' && Number(document.body.dataset.simulated) === 1")
        browser.wait("window.puckloopView.run.duration <= 1.001")
        for text, failed, said in (("nonsense <", True, "is no condition"), ("TMR1 < 0x8000", False, "it holds")):
            browser.value(f"""(() => {{ const field = document.getElementById('until'); field.value = {json.dumps(text)};
                window.puckloopView.key({{ target: field, key: 'Enter' }}); }})()""")
            browser.wait(f"document.getElementById('detail').textContent.includes('{said}')")
            self.assertEqual(browser.value("document.getElementById('until').classList.contains('failed')"), failed)
        browser.value("document.getElementById('fault-open').click()")
        browser.value("""(() => { const input = document.querySelector('#fault-fields [data-key=from]');
            input.value = 'robot0.pic'; input.dispatchEvent(new Event('input')); })()""")
        self.assertRegex(browser.value("document.getElementById('fault-text').value"),
                         '^drop link=robot0.uart from=robot0.pic begin="1.00[0-9] s"$')
        browser.value("document.getElementById('fault-do').click()")
        browser.wait("document.body.dataset.epoch === '2'")
        browser.value("window.puckloopView.drive({ do: 'step', ms: 1000 })")
        browser.wait("window.puckloopView.run.events.flags && "
                     "[...window.puckloopView.run.events.flags.slice(0, window.puckloopView.run.events.count)].some((f) => f & 1)")
        # A line typed into the robot's UART as its Linux board.
        browser.value("""(() => { const { terminal } = window.puckloopView; terminal.chooser.value = 'robot0.uart';
            terminal.choose(); terminal.end.value = 'robot0.linux'; terminal.ending.value = 'CR';
            terminal.input.value = 'typed'; })()""")
        browser.value("document.getElementById('terminal-input').focus()")
        browser.key("Enter")
        browser.wait("document.body.dataset.epoch === '3'")
        browser.value("window.puckloopView.drive({ do: 'step', ms: 10 })")
        browser.wait("[...document.querySelectorAll('#terminal .typed')].some((one) => one.textContent.includes('typed'))")
        browser.wait("document.querySelector('#terminal .end1') !== null")  # the robot's own bytes
        browser.value("document.getElementById('end-run').click()")
        browser.wait("document.body.dataset.over === 'true'")
        self.run.wait(60)
        self.assertEqual(browser.errors, [])
        self.assertGreater(self.report()["faults"][0]["fired"], 0)
        self.assertEqual(self.report()["faults"][1]["fired"], 6)
        self.assertIn('data = "74797065640d"', (self.out / "events.toml").read_text())

    def test_the_page_shows_the_network_manager_and_sets_it(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        scenario = self.folder / "managed.toml"
        sender = SOURCE / "tests/network/programs/sender.py"
        scenario.write_text(
            '[run]\nduration = "30 s"\n[arena]\nsize = ["1 m", "1 m"]\n[network]\n[[host]]\nname = "manager"\n'
            'program = ["puckloop-netmanager", "--status", "0.2"]\n' + "".join(
                f'[[host]]\nname = "m{i}"\naddress = "10.0.0.{i}"\n'
                f'program = ["python3", "-B", "{sender}", "{i}", "{23 - i}"]\n' for i in (11, 12)) +
            '[[robot]]\nposition = ["0 m", "0 m"]\n[robot.pic]\nfirmware = "own"\n')
        address = self.start(30, scenario)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        browser.wait("document.body && document.body.dataset.ready")
        browser.value("window.puckloopView.drive({ do: 'step', ms: 2000 })")
        browser.wait("Number(document.body.dataset.simulated) === 2")
        browser.wait("document.querySelectorAll('#network-part td').length === 4")
        self.assertEqual(browser.value("[...document.querySelectorAll('#network-part td')].map((one) => one.textContent)"),
                         ["", "1", "1", ""])
        self.assertEqual(browser.value("document.querySelectorAll('#network-part td.failed').length"), 0)
        browser.wait("parseFloat(document.querySelector('#network-part li').textContent) > 1.2")
        self.assertRegex(browser.value("document.querySelector('#network-part li').textContent"),
                         "^1\\.[0-9]+ 1[12] to 1[12]: sent at 1\\.")
        browser.value("""(() => { const field = document.querySelector('#network-part [name=loss]'); field.value = '1';
            field.dispatchEvent(new Event('change')); })()""")
        browser.value("window.puckloopView.drive({ do: 'step', ms: 1000 })")
        browser.wait("Number(document.body.dataset.simulated) === 3")
        browser.wait("document.querySelectorAll('#network-part td.failed').length === 2")
        browser.wait("document.querySelector('#network-part li.failed').textContent.includes('lost sent at 2.')")
        self.assertEqual(browser.value("document.querySelector('#network-part [name=loss]').value"), "1")
        # At an earlier time what was known then.
        browser.value("window.puckloopView.jump(1.0, -1)")
        browser.wait("document.querySelectorAll('#network-part td.failed').length === 0")
        browser.value("document.getElementById('end-run').click()")
        browser.wait("document.body.dataset.over === 'true'")
        self.run.wait(60)
        self.assertEqual(browser.errors, [])
        events = (self.out / "events.toml").read_text()
        self.assertIn('send = "manager"\ntext = "loss 1"', events)
        with urllib.request.urlopen(address + "network?at=1500", timeout=60) as answer:
            self.assertEqual(json.loads(answer.read())[0]["status"]["loss"], 0)
        for wrong in ("network", "network?at=", "network?at=x", "network?at=-1", "network?from=1"):
            with self.assertRaises(urllib.error.HTTPError):
                urllib.request.urlopen(address + wrong, timeout=60)

    def test_the_page_flashes_an_image(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        image = self.folder / "robot.elf"
        image.write_bytes((SOURCE / "firmware/epuck/epuck_ircom.elf").read_bytes())
        address = self.start(2)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        browser.wait("document.body && document.body.dataset.ready")
        flash = """(() => { const { board } = window.puckloopView; board.image.value = %s;
            document.getElementById('flash').click(); })()"""
        browser.value("""(() => { const { board } = window.puckloopView; board.chooser.value = 'robot0.pic';
            board.look(); board.add('frozen'); window.puckloopView.drive({ do: 'step', ms: 500 }); })()""")
        browser.wait("Number(document.body.dataset.simulated) === 0.5")
        # Interrupts are counted from here on: the A/D scans of the project's firmware come each 142.4 us.
        browser.value("document.getElementById('count-interrupts').click()")
        browser.value("window.puckloopView.drive({ do: 'step', ms: 100 })")
        browser.wait("document.querySelectorAll('#interrupts tr').length > 1")
        rates = browser.value("""Object.fromEntries([...document.querySelectorAll('#interrupts tr')].map((row) =>
            [row.cells[0].textContent, parseFloat(row.cells[2].textContent)]))""")
        self.assertAlmostEqual(rates["ADC"], 1 / 142.4e-6, delta=300)
        self.assertEqual(browser.value("document.querySelectorAll('#stack div').length"), 16)
        browser.value("document.getElementById('count-interrupts').click()")
        browser.wait("document.querySelectorAll('#interrupts tr').length === 0")
        for file, part in ((SOURCE / "README.md", "no known image format"), ("nowhere.hex", "nowhere.hex"),
                           (SOURCE / "firmware/rab/rab.hex", "rab.hex")):
            browser.value(flash % json.dumps(str(file)))
            browser.wait(f"document.getElementById('detail').textContent.includes({json.dumps(part)})")
            self.assertEqual(browser.value("document.getElementById('detail').className"), "failed")
        self.assertEqual(browser.value("document.body.dataset.epoch"), "0")
        browser.value(flash % json.dumps(str(image)))
        browser.wait("document.body.dataset.epoch === '1'")
        image.unlink()
        browser.value("window.puckloopView.drive({ do: 'step', ms: 100 })")
        browser.wait("document.querySelector('#watches tr') && document.querySelector('#watches tr').textContent.startsWith('frozen0x')")
        browser.wait("document.getElementById('where').textContent.includes('.c:')")  # the ELF's lines; the HEX has none
        browser.value("window.puckloopView.drive({ do: 'back', to_s: 0.4 })")
        browser.wait("document.body.dataset.epoch === '2'")
        browser.wait("document.querySelector('#watches tr').textContent.includes('no symbols')")
        self.assertNotIn(".c:", browser.value("document.getElementById('where').textContent"))
        browser.value("document.getElementById('end-run').click()")
        browser.wait("document.body.dataset.over === 'true'")
        self.run.wait(60)
        self.assertEqual(browser.errors, [])
        self.assertEqual(self.report()["faults"], [])  # it was taken back

    def test_one_instruction_at_a_time(self):
        plain = self.folder / "plain"
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--out", plain).returncode, 0)
        address = self.start(2)
        self.ask(address, {"page": "a", "do": "look", "board": "robot0.pic", "items": []})
        self.ask(address, {"page": "a", "do": "step", "ms": 100})
        before = self.wait(address, lambda s: s["look"] and s["look"]["time_s"] > 0.099)["look"]
        seen = []
        for _ in range(20):
            self.ask(address, {"page": "a", "do": "instruction", "board": "robot0.pic"})
            look = self.wait(address, lambda s, t=before["time_s"]: s["look"]["time_s"] > t)["look"]
            # A dsPIC at 7.37 MHz x 8 / 4: one to three cycles, and up to a board's ADC or bus in between.
            self.assertLess(look["time_s"] - before["time_s"], 2e-6)
            seen.append((before["where"]["pc"], look["where"]["pc"]))
            before = look
        self.assertGreater(len({pc for pair in seen for pc in pair}), 3)
        for request in ({}, {"board": 3}, {"board": "x" * 65}):
            self.assertEqual(self.ask(address, {"page": "a", "do": "instruction", **request})[0], 409)
        self.ask(address, {"page": "a", "do": "play", "speed": 0})
        self.wait(address, lambda s: s["over"])
        self.run.wait(60)
        self.assertEqual(self.report()["trace_sha256"], self.report(plain)["trace_sha256"])

    def test_the_page_turns_a_selector_and_changes_a_parameter(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        address = self.start(30)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        browser.wait("document.body && document.body.dataset.ready")
        form = """(() => { const { worldForm } = window.puckloopView;
            document.getElementById('world-open').click();
            worldForm.verb.value = %s; worldForm.verb.dispatchEvent(new Event('change'));
            worldForm.object.value = %s; worldForm.object.dispatchEvent(new Event('input'));
            for (const [key, value] of Object.entries(%s)) {
                const input = document.querySelector(`#world-fields [data-key=${key}]`);
                input.value = value; input.dispatchEvent(new Event('input'));
            }
            const text = worldForm.text.value; document.getElementById('world-do').click(); return text; })()"""
        done = [("select", "robot0", {"position": "5"}, "select robot0 position 5"),
                ("tune", "robot0", {"parameter": "proximity.gain3", "value": "0.5"},
                 "tune robot0 parameter proximity.gain3 value 0.5"),
                ("add", "lamp", {"name": "sun", "centre": "10 cm, 10 cm", "intensity": "2"},
                 "add lamp name sun centre 10 cm, 10 cm intensity 2")]
        for verb, thing, keys, command in done:
            self.assertEqual(browser.value(form % (json.dumps(verb), json.dumps(thing), json.dumps(keys))), command)
        browser.value("window.puckloopView.drive({ do: 'step', ms: 100 })")
        state = self.wait(address, lambda s: len(s["acts"]) == len(done) and all(act["answer"] for act in s["acts"]))
        self.assertEqual([act["refused"] for act in state["acts"]], [False] * len(done), state["acts"])
        self.assertEqual(browser.value(form % ('"tune"', '"robot0"', '{"parameter": "robot.radius", "value": "4 cm"}')),
                         "tune robot0 parameter robot.radius value 4 cm")
        self.wait(address, lambda s: s["acts"][-1]["refused"] and "does not change" in s["acts"][-1]["answer"])
        self.assertLessEqual({"robot0", "can", "floor"}, set(browser.value("window.puckloopView.objects()")))
        self.assertEqual(browser.errors, [])
        browser.value("document.getElementById('end-run').click()")
        browser.wait("document.body.dataset.over === 'true'")
        self.run.wait(60)
        events = (self.out / "events.toml").read_text()
        self.assertIn('tune = "robot0"\nparameter = "proximity.gain3"\nvalue = "0.5"', events)

    def test_the_page_plays_pauses_steps_and_acts(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        address = self.start(30)
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        browser.wait("document.body && document.body.dataset.ready")
        browser.value("document.getElementById('play').click()")
        browser.wait("Number(document.body.dataset.simulated) > 1 && Number(document.body.dataset.time) > 0.5")
        browser.value("document.getElementById('play').click()")
        browser.wait("document.body.dataset.playing === 'false'")
        time.sleep(0.5)
        stands = browser.value("document.body.dataset.simulated")
        time.sleep(0.5)
        self.assertEqual(browser.value("document.body.dataset.simulated"), stands)
        browser.value("document.getElementById('step-1').click()")
        browser.wait(f"Math.abs(Number(document.body.dataset.simulated) - {stands} - 0.001) < 1e-7")
        # The can is carried by the mouse.
        x, y = browser.value("""(() => { const { arena } = window.puckloopView, box = arena.canvas.getBoundingClientRect();
            const [x, y] = arena.at(-0.25, -0.2); return [box.left + x, box.top + y]; })()""")
        browser.drag(x, y, x + 60, y, modifiers=1)
        browser.value("document.getElementById('step-100').click()")
        browser.wait("document.getElementById('detail').textContent.startsWith('move can to ')")
        browser.wait("document.getElementById('detail').textContent.includes(' s: ')")
        browser.wait("Number(document.body.dataset.events) > 20")
        browser.value("document.getElementById('end-run').click()")
        browser.wait("document.body.dataset.over === 'true'")
        self.run.wait(60)
        self.assertEqual(browser.errors, [])
        self.assertIn("can", (self.out / "events.toml").read_text())


if __name__ == "__main__":
    unittest.main()
