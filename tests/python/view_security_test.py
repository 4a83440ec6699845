"""Who cannot do anything to a run that has a page: other users, clients that do not read or say nothing sensible."""

import json
import os
import pathlib
import signal
import socket
import subprocess
import time
import unittest

from kit import PROGRAM, SOURCE, InFolder, puckloop

NOBODY = 65534
SCENARIO = SOURCE / "scenarios/hello.toml"


class Secure(InFolder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "o"

    def begun(self, *words):
        # pylint: disable=consider-using-with
        process = subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def control(self):
        """The socket's path, once the run waits."""
        note = self.out / "control.json"
        end = time.monotonic() + 60
        while not (note.is_file() and '"control"' in note.read_text()):
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)
        return json.loads(note.read_text())["control"]

    def client(self, path):
        line = socket.socket(socket.AF_UNIX)
        self.addCleanup(line.close)
        line.settimeout(60)
        line.connect(path)
        return line, line.makefile("rb")

    def as_nobody(self, program):
        """What this Python program prints for a user without rights."""
        return subprocess.run(["/usr/bin/python3", "-c", program], user=NOBODY, group=NOBODY, extra_groups=[], cwd="/",
                              capture_output=True, text=True, timeout=60, check=False).stdout.strip()

    @unittest.skipUnless(os.geteuid() == 0, "only root can be another user")
    def test_another_user_of_the_machine_gets_nothing(self):
        run = self.begun("run", SCENARIO, "--view", "--duration", 1, "--out", self.out)
        address = run.stdout.readline().strip()
        path = self.control()
        said = self.as_nobody(f"""
import socket
try:
    socket.socket(socket.AF_UNIX).connect({path!r})
    print("connected")
except OSError as error:
    print(type(error).__name__)""")
        self.assertEqual(said, "PermissionError")
        root, token = address.rstrip("/").rsplit("/", 1)
        said = self.as_nobody(f"""
import urllib.request, urllib.error
for path in ("/", "/drive", "/head", "/{'0' * 32}/head", "/{token[:-1]}/head"):
    for data in (None, b'{{"page": "x", "do": "end"}}'):
        try:
            print(urllib.request.urlopen(urllib.request.Request({root!r} + path, data, {{"Origin": {root!r}}})).status)
        except urllib.error.HTTPError as error:
            print(error.code)""")
        self.assertEqual(set(said.split()), {"404"})
        # Nor does the token show where others look: in the command lines and the environment of processes.
        for folder in pathlib.Path("/proc").iterdir():
            if folder.name.isdigit():
                try:
                    line = (folder / "cmdline").read_bytes()
                except OSError:
                    continue
                if b"chrom" not in line:  # a browser that was opened is given the address
                    self.assertNotIn(token.encode(), line)

    def test_what_no_client_says_is_refused_and_the_run_goes_on(self):
        run = self.begun("run", SCENARIO, "--control", "--duration", 1, "--out", self.out)
        line, replies = self.client(self.control())
        replies.readline()
        for bad in (b"rubbish", b"[]", b"{", b'{"op": 3}', b'{"op": "fly"}', b"\xff\xfe", b'{"op": "step", "for": "x"}',
                    b'{"op": "flash"}', b'{"op": "flash", "node": "robot0.pic", "file": 3}',
                    b'{"op": "flash", "node": "robot0.pic", "file": "/dev/zero"}',
                    b'{"op": "flash", "node": "robot0.pic", "file": "/proc/self/environ"}',
                    b'{"op": "save", "file": "/nowhere/x"}', b"[" * 100000, b'{"op": "' + b"x" * 100000 + b'"}'):
            line.sendall(bad + b"\n")
            reply = json.loads(replies.readline())
            self.assertFalse(reply["ok"], bad[:40])
            self.assertNotIn("PATH=", reply["error"])
        line.sendall(b'{"op": "step", "to": 0.5}\n')
        self.assertTrue(json.loads(replies.readline())["ok"])
        # A line without an end is not kept for ever: the client is sent away, and the run has failed.
        try:
            for _ in range(64):
                line.sendall(b"x" * 65536)
        except OSError:
            pass
        self.assertEqual(run.wait(60), 1)
        self.assertIn("its client went away", json.loads((self.out / "report.json").read_text())["ended_why"])

    def test_a_client_that_never_reads_can_be_interrupted(self):
        run = self.begun("run", SCENARIO, "--control", "--duration", 1, "--out", self.out)
        line, _ = self.client(self.control())
        line.setblocking(False)
        asked = 0
        try:  # until neither side takes any more
            for asked in range(100000):
                line.sendall(b'{"op": "faults"}\n')
        except BlockingIOError:
            pass
        self.assertGreater(asked, 10)
        self.assertIsNone(run.poll())
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(30), 130)

    def test_onlookers_that_never_read_change_nothing(self):
        plain = self.folder / "plain"
        self.assertEqual(puckloop("run", SCENARIO, "--in-process", "--duration", 2, "--out", plain).returncode, 0)
        run = self.begun("run", SCENARIO, "--control", "--duration", 2, "--out", self.out)
        path = self.control()
        viewer = self.begun("view", self.out)
        address = viewer.stdout.readline().strip()
        host, token = address.split("/")[2:4]
        slow = []
        for _ in range(1000):  # 64 are let in; their questions are answered until their buffers are full
            line = socket.create_connection(tuple(host.split(":")))
            self.addCleanup(line.close)
            slow.append(line)
        for line in slow:
            try:
                line.sendall(f"GET /{token}/page.js HTTP/1.1\r\nHost: {host}\r\n\r\n".encode() * 20)
            except OSError:
                pass  # one of those that were closed
        for line in slow[:60]:
            line.close()
        body = json.dumps({"page": "a", "do": "play", "speed": 0})
        answer = b""
        end = time.monotonic() + 60
        while b"200 OK" not in answer and time.monotonic() < end:  # once there is room again
            with socket.create_connection(tuple(host.split(":")), timeout=30) as line:
                try:
                    line.sendall(f"POST /{token}/drive HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n"
                                 f"Content-Length: {len(body)}\r\n\r\n{body}".encode())
                    answer = line.recv(4096)
                except OSError:
                    pass
        self.assertEqual(run.wait(120), 0)
        trace = [json.loads((folder / "report.json").read_text())["trace_sha256"] for folder in (plain, self.out)]
        self.assertEqual(*trace)
        # The socket ended with the run, and the viewer counts whom it refused.
        self.assertFalse(pathlib.Path(path).exists())
        with socket.socket(socket.AF_UNIX) as line, self.assertRaises(OSError):
            line.connect(path)
        viewer.send_signal(signal.SIGINT)
        said, _ = viewer.communicate(timeout=60)
        self.assertRegex(said, r"\d+ \(too many connections\)")


if __name__ == "__main__":
    unittest.main()
