"""The page of `puckloop view`, driven in a headless Chromium as its users do."""

import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import unittest

from browser import Browser, find_chromium
from kit import PROGRAM, SOURCE, puckloop

SECONDS = 4
# A robot whose UART loses a byte now and then, so that there are frames that failed.
FAULT = "drop link=robot0.uart from=robot0.pic probability=0.01"


def centre(browser, name, share_x=0.5, share_y=0.5):
    """A place in an element, in pixels of the page."""
    box = browser.value(f"(({{left, top, width, height}}) => [left, top, width, height])"
                        f"(document.getElementById('{name}').getBoundingClientRect())")
    return box[0] + share_x * box[2], box[1] + share_y * box[3]


class Page(unittest.TestCase):
    """One recorded run, one viewer and one browser for all tests; each loads the page again."""

    @classmethod
    def setUpClass(cls):
        if not find_chromium():
            raise unittest.SkipTest("no chromium is installed")
        place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(place.cleanup)
        cls.out = pathlib.Path(place.name) / "o"
        ended = puckloop("run", SOURCE / "scenarios/hello.toml", "--in-process", "--duration", SECONDS, "--fault",
                         FAULT, "--out", cls.out)
        assert (cls.out / "trace.csv").exists(), ended.stderr
        # pylint: disable=consider-using-with
        cls.viewer = subprocess.Popen([PROGRAM, "view", cls.out], stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(cls.end_viewer)
        cls.address = cls.viewer.stdout.readline().strip()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    @classmethod
    def end_viewer(cls):
        cls.viewer.send_signal(signal.SIGINT)
        cls.viewer.communicate(timeout=20)
        assert cls.viewer.returncode == 0

    def setUp(self):
        self.load(self.address)

    def load(self, address):
        self.browser.errors.clear()
        self.browser.open("about:blank")
        self.browser.wait("location.href === 'about:blank'")
        self.browser.open(address)
        self.browser.wait("document.body && document.body.dataset.ready === 'all'")

    def tearDown(self):
        self.assertEqual(self.browser.errors, [])
        self.assertIsNone(self.browser.value("document.body.dataset.trouble || null"))

    def time(self):
        return float(self.browser.value("document.body.dataset.time || '0'"))

    def detail(self):
        return self.browser.value("document.getElementById('detail').textContent")

    def pixels(self, name):
        """A number for what a canvas shows now."""
        return self.browser.value(f"""new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {{
            const canvas = document.getElementById('{name}');
            const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
            let sum = 0;
            for (let i = 0; i < data.length; ++i) sum = (sum * 31 + data[i]) % 4294967291;
            done(sum);
        }})))""")

    def colours(self, name):
        """How many different colours it has."""
        return self.browser.value(f"""(() => {{
            const canvas = document.getElementById('{name}');
            const data = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
            return new Set(data).size;
        }})()""")

    def check_whole_page(self):
        self.assertEqual(self.browser.value("document.getElementById('title').textContent"), "hello.toml")
        self.assertEqual(self.browser.value("document.body.dataset.robot"), "robot0")
        self.assertGreater(int(self.browser.value("document.body.dataset.events")), 100)
        self.pixels("arena")
        self.assertGreater(self.colours("arena"), 50)
        self.assertGreater(self.colours("timeline"), 20)
        self.browser.wait("document.querySelectorAll('#panel .plot').length >= 4")

    def test_it_loads_with_arena_timeline_and_sensors(self):
        self.check_whole_page()
        rows = self.browser.value("[...document.getElementById('find-track').options].map((one) => one.text)")
        for track in ("robot0.uart robot0.pic", "robot0.uart robot0.linux", "robot0.pic log", "robot0.pic resets"):
            self.assertIn(track, rows)
        self.assertFalse(self.browser.value("document.getElementById('progress').hidden === false"))

    def test_pictures_of_cameras_and_serial_lines_follow_the_time(self):
        folder = self.out / "robot0.omni"
        folder.mkdir()
        self.addCleanup(shutil.rmtree, folder)
        for frame, colour in ((30, b"\xff\0\0"), (60, b"\0\0\xff")):
            (folder / f"{frame:08}.ppm").write_bytes(b"P6\n2 1\n255\n" + 2 * colour)
        csv = self.out / "robot0.omni.csv"
        csv.write_text("t_s,frame,sequence,width,height,format,hash\n1.0,30,0,2,1,RGB3,0\n2.0,60,1,2,1,RGB3,0\n")
        self.addCleanup(csv.unlink)
        self.load(self.address)
        for time, frame, pixel in ((1.5, 30, [255, 0, 0, 255]), (2.5, 60, [0, 0, 255, 255])):
            self.browser.value(f"window.puckloopView.seek({time})")
            self.browser.wait(f"document.querySelector('#cameras canvas').dataset.frame === '{frame}'")
            self.assertEqual(self.browser.value("[...document.querySelector('#cameras canvas').getContext('2d')"
                                                ".getImageData(0, 0, 1, 1).data]"), pixel)
        # Of the line as a terminal as many bytes as there were until then.
        self.browser.value("""(() => { const { terminal } = window.puckloopView; terminal.chooser.value = 'robot0.uart';
            terminal.choose(); })()""")
        self.browser.wait("document.querySelectorAll('#terminal span').length > 2")
        late = self.browser.value("document.getElementById('terminal').textContent.length")
        self.browser.value("window.puckloopView.seek(1.2)")
        self.browser.wait(f"document.getElementById('terminal').textContent.length < {late}")
        self.assertIsNone(self.browser.value("document.getElementById('terminal-input')"))  # nothing to type into

    def test_it_plays_and_pauses(self):
        self.browser.value("window.puckloopView.seek(1.5)")  # the robot drives
        before = self.pixels("arena")
        self.browser.value("document.getElementById('play').click()")
        self.browser.wait("Number(document.body.dataset.time) > 1.8")
        self.browser.value("document.getElementById('play').click()")
        stopped = self.time()
        self.assertEqual(self.browser.value("document.body.dataset.playing"), "false")
        self.assertNotEqual(self.pixels("arena"), before)
        self.assertEqual(self.time(), stopped)

    def test_keys_move_through_time(self):
        self.browser.key("ArrowRight")
        self.assertAlmostEqual(self.time(), 0.1)
        self.browser.key("ArrowRight", shift=True)
        self.assertAlmostEqual(self.time(), 1.1)
        self.browser.key("ArrowLeft")
        self.assertAlmostEqual(self.time(), 1.0)
        self.browser.key("End")
        self.assertGreaterEqual(self.time(), SECONDS - 0.1)
        self.browser.key("Home")
        self.assertEqual(self.time(), 0)

    def test_the_next_frame_that_failed_is_found(self):
        self.browser.key("n")
        self.browser.wait("document.getElementById('detail').className === 'failed'")
        first, text = self.time(), self.detail()
        self.assertGreater(first, 0)
        self.assertIn("!!", text)
        # As `trace decode` has it.
        lines = [line for line in puckloop("trace", "decode", self.out, "--errors").stdout.splitlines()]
        begins = sorted(float(line.split()[0]) for line in lines)
        self.assertAlmostEqual(first, begins[0], places=5)
        self.browser.key("n")
        self.browser.wait(f"Number(document.body.dataset.time) > {first}")
        self.browser.key("N")
        self.browser.wait(f"Math.abs(Number(document.body.dataset.time) - {first}) < 1e-5")

    def test_text_is_searched_in_a_track(self):
        self.browser.value("""(() => {
            const track = document.getElementById('find-track');
            track.value = [...track.options].find((one) => one.text === 'robot0.uart robot0.linux').value;
            const text = document.getElementById('find');
            text.value = 'Actuators LEFT';
            text.dispatchEvent(new Event('input'));
        })()""")
        found = self.browser.wait("document.getElementById('found').textContent")
        count = puckloop("trace", "decode", self.out).stdout.count("epuck: actuators left")
        self.assertEqual(found, f"{count} found")
        self.browser.value("document.getElementById('find-next').click()")
        self.browser.wait("document.getElementById('detail').textContent.includes('actuators left')")
        first = self.time()
        self.browser.value("document.getElementById('find-next').click()")
        self.browser.wait(f"Number(document.body.dataset.time) > {first}")

    def test_a_click_on_the_timeline_jumps_and_reads_the_event(self):
        # The log's first line is at 0; the row of the log is found by its name.
        x, y = self.browser.value("""(() => {
            const { timeline, run } = window.puckloopView;
            const row = run.rows.findIndex((i) => run.tracks[i].name === 'robot0.uart robot0.linux');
            const box = timeline.canvas.getBoundingClientRect();
            const begin = run.events.track(run.rows[row]).begins[3];
            timeline.place(begin - 0.01, 0.05);
            return [box.left + timeline.x(begin), box.top + 22 + 17 * row - timeline.scroll + 8];
        })()""")
        self.browser.click(x + 1, y)
        self.browser.wait("document.getElementById('detail').textContent.includes('epuck: ')")
        self.assertGreater(self.time(), 1)
        self.assertIn("robot0.uart robot0.linux", self.detail())

    def test_the_timeline_zooms_moves_and_scrolls(self):
        span = "window.puckloopView.timeline.to - window.puckloopView.timeline.from"
        x, y = centre(self.browser, "timeline", 0.6, 0.5)
        before = self.browser.value(span)
        self.browser.wheel(x, y, -400)
        self.browser.wait(f"({span}) < {before} * 0.8")
        start = self.browser.value("window.puckloopView.timeline.from")
        self.browser.drag(x, y, x - 100, y)
        self.browser.wait(f"window.puckloopView.timeline.from > {start}")
        self.browser.key("0")
        self.browser.wait(f"Math.abs(({span}) - window.puckloopView.run.duration) < 1e-6")

    def test_the_arena_zooms_moves_measures_and_follows(self):
        x, y = centre(self.browser, "arena", 0.4, 0.5)
        scale = self.browser.value("window.puckloopView.arena.scale")
        self.browser.wheel(x, y, -300)
        self.browser.wait(f"window.puckloopView.arena.scale > {scale} * 1.2")
        before = self.browser.value("window.puckloopView.arena.centre.x")
        self.browser.drag(x, y, x + 80, y)
        self.browser.wait(f"window.puckloopView.arena.centre.x < {before}")
        self.browser.value("""(() => { const follow = document.getElementById('follow');
            follow.value = '0'; follow.dispatchEvent(new Event('change')); })()""")
        self.browser.key("End")
        self.pixels("arena")
        away = self.browser.value("""(() => { const { arena, run } = window.puckloopView, path = run.paths[0];
            return Math.hypot(arena.centre.x - path.x.at(-1), arena.centre.y - path.y.at(-1)); })()""")
        self.assertLess(away, 1e-3)

    def test_a_marker_is_set_and_found_again(self):
        self.browser.key("ArrowRight", shift=True)
        self.browser.key("m")
        self.browser.key("Home")
        self.browser.key("M")
        self.assertAlmostEqual(self.time(), 1.0)
        self.browser.key("m")
        self.assertEqual(self.browser.value("window.puckloopView.timeline.markers.length"), 0)

    def test_dark_and_light_differ(self):
        before = self.pixels("arena")
        self.browser.value("document.getElementById('theme').click()")
        self.assertNotEqual(self.pixels("arena"), before)

    def test_the_exported_file_is_the_same_page(self):
        file = self.out.parent / "page.html"
        self.assertEqual(puckloop("view", self.out, "--export", file).returncode, 0)
        events = self.browser.value("document.body.dataset.events")
        self.load(file.as_uri())
        self.check_whole_page()
        self.assertEqual(self.browser.value("document.body.dataset.events"), events)
        self.browser.key("n")
        self.browser.wait("document.getElementById('detail').textContent.includes('!!')")

    def test_a_viewer_that_has_ended_is_said_so(self):
        with subprocess.Popen([PROGRAM, "view", self.out], stdout=subprocess.PIPE, text=True) as viewer:
            self.load(viewer.stdout.readline().strip())
            viewer.send_signal(signal.SIGINT)
            viewer.communicate(timeout=20)
        self.browser.key("n")
        self.browser.wait("document.getElementById('detail').textContent.includes('still on')")
        self.browser.open("about:blank")  # the page asks on, and each refusal is an error of the browser
        self.browser.wait("location.href === 'about:blank'")
        self.browser.errors.clear()


SEEN = """[run]
duration = "3 s"
allow = ["program"]
[arena]
size = ["1 m", "1 m"]
[[speaker]]
name = "horn"
position = ["30 cm", "30 cm"]
level = 500
on = "1 s"
off = "2 s"
[[pheromone]]
name = "trail"
record_every = "500 ms"
[tracker]
position_noise = "0 m"
[[robot]]
name = "leader"
position = ["0 cm", "0 cm"]
[robot.pic]
firmware = "own"
[robot.linux]
program = ["/usr/bin/python3", "-B", "turret.py"]
start = "500 ms"
"""
TURRET = """import fcntl, os, time
bus = os.open("/dev/i2c-3", os.O_RDWR)
fcntl.ioctl(bus, 0x0703, 0x61)
os.write(bus, bytes([0, 0, 40, 0, 40, 0, 40, 0, 0]))  # LED 2 blue, 1 green, 0 red
time.sleep(1)
os.write(bus, bytes(9))
time.sleep(2)
"""


class Seen(unittest.TestCase):
    """What is on the arena beside robots and things."""

    def test_turret_sound_trail_and_tracker(self):
        if not find_chromium():
            self.skipTest("no chromium is installed")
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "seen.toml").write_text(SEEN)
            (folder / "turret.py").write_text(TURRET)
            ran = puckloop("run", "seen.toml", "--in-process", "--out", "o", folder=folder)
            self.assertTrue((folder / "o/trace.csv").exists(), ran.stderr)
            page = folder / "o.html"
            self.assertEqual(puckloop("view", folder / "o", "--export", page).returncode, 0)
            for exported in (False, True):
                # pylint: disable=consider-using-with
                viewer = subprocess.Popen([PROGRAM, "view", folder / "o"], stdout=subprocess.PIPE, text=True)
                browser = Browser()
                try:
                    browser.open(page.as_uri() if exported else viewer.stdout.readline().strip())
                    browser.wait("document.body && document.body.dataset.ready === 'all'")
                    self.look(browser)
                finally:
                    browser.close()
                    viewer.send_signal(signal.SIGINT)
                    viewer.communicate(timeout=20)

    def look(self, browser):
        level = "[...Array(9).keys()].map((i) => window.puckloopView.run.leds.level(0, 10 + i, %s))"
        self.assertEqual(browser.value(level % 0.4), [0] * 9)
        self.assertEqual(browser.value(level % 1.2), [40, 0, 0, 0, 40, 0, 0, 0, 40])
        self.assertEqual(browser.value(level % 2.5), [0] * 9)
        self.assertGreaterEqual(browser.value("window.puckloopView.run.trails[0].times.length"), 5)
        self.assertEqual(browser.value("window.puckloopView.run.tracked.at(1).map((one) => one.robot)"), ["leader"])
        self.assertAlmostEqual(browser.value("window.puckloopView.run.tracked.at(1)[0].x"), 0, delta=0.01)
        self.assertFalse(browser.value("document.getElementById('tracker-part').hidden"))

        def colour(x, y):
            """Of the arena's canvas at a place in metres, once it is drawn."""
            return browser.value(f"""new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {{
                const {{ arena }} = window.puckloopView, ratio = window.devicePixelRatio;
                const [px, py] = arena.at({x}, {y});
                done([...arena.canvas.getContext('2d').getImageData(px * ratio, py * ratio, 1, 1).data].slice(0, 3)); }})))""")

        def show(time):
            browser.value(f"window.puckloopView.seek({time})")

        show(1.2)
        red, green, blue = colour(0.013, -0.021), colour(0.013, 0.021), colour(-0.0325, -0.003)
        for lit, most in ((red, 0), (green, 1), (blue, 2)):
            self.assertEqual(lit.index(max(lit)), most, (red, green, blue))
            self.assertGreater(max(lit), 200)
        # The horn's rings: 5, 10 and 15 pixels outside its sign of 5.
        ring = browser.value("10 / window.puckloopView.arena.scale")
        sounds = colour(0.3 + ring, 0.3)
        show(0.4)
        self.assertNotEqual(colour(0.3 + ring, 0.3), sounds)
        before = colour(0.0, 0.06)
        browser.value("(() => { const box = document.getElementById('tracker'); box.click(); })()")
        radius = browser.value("1.25 * 0.035")
        self.assertTrue(any(colour(radius * x, radius * y) != before for x, y in ((0.8, 0.6), (0.6, 0.8), (-0.6, 0.8))))
        self.assertEqual(browser.errors, [])


if __name__ == "__main__":
    unittest.main()
