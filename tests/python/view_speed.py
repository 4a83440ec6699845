"""What the page costs (docs/view.md): not a test, for its figures depend on the machine.

    python3 tests/python/view_speed.py open OUT       # a recorded run in a headless Chromium: opening, scrolling
    python3 tests/python/view_speed.py cost [ROUNDS]  # 20 robots: processor time of the run, with and without a page

The program is PUCKLOOP_PROGRAM, as for the tests.
"""

import os
import pathlib
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).parent))
os.environ.setdefault("PUCKLOOP_SOURCE", str(pathlib.Path(__file__).parents[2]))

from browser import Browser  # noqa: E402
from kit import PROGRAM, SOURCE  # noqa: E402

FRAMES = 60  # of each way to move
SCROLL = """(async () => {
  const app = window.puckloopView, { timeline, run } = app;
  const span = SPAN || run.duration, times = [];
  timeline.place(0, span);
  const next = () => new Promise((done) => requestAnimationFrame(done));
  await next();
  let before = performance.now();
  for (let i = 0; i < FRAMES; ++i) {
    MOVE
    run.redraw();
    await next();
    const now = performance.now();
    times.push(now - before);
    before = now;
  }
  return times;
})()"""
MOVES = {
    "the whole run, slider": (0, "app.seek((i / FRAMES) * run.duration);"),
    "60 s, scrolled": (60, "timeline.place((i / FRAMES) * (run.duration - span), span); app.seek(timeline.from);"),
    "5 s, scrolled": (5, "timeline.place(run.duration / 2 + i * 0.3, span); app.seek(timeline.from);"),
    "zoomed in and out": (0, "timeline.zoom(i < FRAMES / 2 ? 0.8 : 1.25, run.duration / 2);"),
}


def opened(folder):
    """Seconds until the arena is there, until the whole timeline is, and frames a second of each way to move."""
    begun = time.monotonic()
    with subprocess.Popen([PROGRAM, "view", folder], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as viewer:
        address = viewer.stdout.readline().strip()
        served = time.monotonic() - begun
        browser = Browser()
        try:
            started = time.monotonic()
            browser.open(address)
            browser.wait("document.body && document.body.dataset.ready", limit=120)
            arena = time.monotonic() - started
            browser.wait("document.body.dataset.ready === 'all'", limit=600)
            whole = time.monotonic() - started
            print(f"address after {served:.2f} s; page: arena after {arena:.2f} s, all {browser.value('document.body.dataset.events')}"
                  f" events after {whole:.2f} s")
            for name, (span, move) in MOVES.items():
                times = browser.value(SCROLL.replace("SPAN", str(span)).replace("MOVE", move).replace("FRAMES", str(FRAMES)))
                print(f"{name}: {1000 / statistics.median(times):.0f} frames/s, slowest of {FRAMES} {max(times):.0f} ms")
        finally:
            browser.close()
            viewer.terminate()


def twenty(folder):
    """A scenario with 20 robots that wander."""
    text = ['[run]\nseed = 1\nallow = ["program"]\n[arena]\nsize = ["2.5 m", "2 m"]\n']
    for i in range(20):
        text.append(f'[[robot]]\nposition = ["{-90 + 45 * (i % 5)} cm", "{-60 + 40 * (i // 5)} cm"]\nheading = "{17 * i} deg"\n'
                    f'[robot.pic]\nfirmware = "{SOURCE}/firmware/epuck/epuck.hex"\n'
                    '[robot.linux]\nprogram = ["puckloop-control", "--behaviour", "wander"]\nstart = "200 ms"\n')
    file = pathlib.Path(folder) / "twenty.toml"
    file.write_text("".join(text))
    return file


class Onlooker(threading.Thread):
    """Listens as a page does, which is sent what is new up to 30 times a second, until it is ended."""

    def __init__(self, address):
        super().__init__()
        self.address, self.events, self.frames, self.over = address, 0, 0, threading.Event()

    def get(self, what):
        with urllib.request.urlopen(self.address + what, timeout=60) as answer:
            return answer.read()

    def listen(self):
        """A WebSocket at `live`."""
        host = self.address.split("/")[2]
        line = socket.create_connection(host.split(":"), timeout=60)
        line.sendall((f"GET /{self.address.split('/')[3]}/live HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n"
                      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n").encode())
        stream = line.makefile("rb")
        while stream.readline() not in (b"\r\n", b""):
            pass
        return line, stream

    def run(self):
        line, stream = self.listen()
        asked = time.monotonic()
        while not self.over.is_set():
            head = stream.read(2)
            if len(head) < 2 or head[0] & 15 == 8:
                break
            size = head[1] & 127
            if size > 125:
                size = int.from_bytes(stream.read(2 if size == 126 else 8), "big")
            stream.read(size)
            self.frames += 1
            if time.monotonic() - asked > 1:
                asked = time.monotonic()
                try:
                    self.get("status")
                    self.get(f"events?from={self.events}")
                except OSError:
                    break
        line.close()


def seconds_of(pid):
    """Processor time of a process that has ended."""
    _, _, usage = os.wait4(pid, 0)
    return usage.ru_utime + usage.ru_stime


def one_run(scenario, folder, look, span):
    """Processor time of the run, and of the viewer, in seconds; `look`: "driven", "nobody" or "page"."""
    out = pathlib.Path(tempfile.mkdtemp(dir=folder)) / "out"  # no control.json of the run before
    # pylint: disable=consider-using-with
    run = subprocess.Popen([PROGRAM, "run", scenario, "--in-process", "--control", "--duration", str(span), "--out", out],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    note = out / "control.json"
    while not (note.is_file() and "control\"" in note.read_text()):
        time.sleep(0.02)
    if look == "driven":  # the same steps, by a shell
        shell = subprocess.Popen([PROGRAM, "shell", out], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        shell.communicate("step 100ms\n" * int(span * 10 + 1))
        return seconds_of(run.pid), 0.0, 0
    viewer = subprocess.Popen([PROGRAM, "view", out], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    address = viewer.stdout.readline().strip()
    onlooker = Onlooker(address)
    if look == "page":
        onlooker.start()
    begun = time.monotonic()
    request = urllib.request.Request(address + "drive", b'{"page": "a", "do": "play", "speed": 0}',
                                     {"Origin": address.rsplit("/", 2)[0]}, method="POST")
    urllib.request.urlopen(request, timeout=60).close()
    of_run = seconds_of(run.pid)
    took = time.monotonic() - begun
    onlooker.over.set()
    if look == "page":
        onlooker.join()
    viewer.terminate()
    return of_run, seconds_of(viewer.pid), onlooker.frames / took


def cost(rounds, span=10):
    with tempfile.TemporaryDirectory() as folder:
        scenario = twenty(folder)
        figures = {"driven": [], "nobody": [], "page": []}
        for _ in range(rounds):
            for look, list_ in figures.items():
                list_.append(one_run(scenario, folder, look, span))
        base = statistics.median(run for run, _, _ in figures["driven"])
        for look, list_ in figures.items():
            run = statistics.median(one[0] for one in list_)
            print(f"{look}: run {run:.2f} s ({100 * (run / base - 1):+.1f} %, {min(o[0] for o in list_):.2f} to "
                  f"{max(o[0] for o in list_):.2f}), viewer {statistics.median(one[1] for one in list_):.2f} s, "
                  f"{statistics.median(one[2] for one in list_):.0f} frames/s")


if __name__ == "__main__":
    if sys.argv[1:2] == ["open"] and len(sys.argv) == 3:
        opened(sys.argv[2])
    elif sys.argv[1:2] == ["cost"]:
        cost(int(sys.argv[2]) if len(sys.argv) > 2 else 5)
    else:
        sys.exit(__doc__)
