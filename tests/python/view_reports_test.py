"""`puckloop view` of a campaign and of an experiment: their reports, and the page of each run behind them."""

import json
import subprocess
import unittest
import urllib.request

from browser import Browser, find_chromium
from kit import PROGRAM, SOURCE, InFolder, puckloop

CAMPAIGN = f"""[campaign]
scenario = "{SOURCE}/scenarios/hello.toml"
duration = "2 s"
seeds = [1]
[[sweep]]
name = "lost bytes"
fault = {{ kind = "drop", link = "robot0.uart", from = "robot0.linux", count = 1 }}
times = {{ from = "700 ms", to = "1.2 s", step = "500 ms" }}
"""
EXPERIMENT = f"""[experiment]
scenario = "{SOURCE}/scenarios/aggregation.toml"
duration = "2 s"
seeds = [1, 2]
[[program]]
name = "wander"
set = {{ robots = 2 }}
"""


class Reports(InFolder):
    def viewed(self, folder):
        """Its address."""
        # pylint: disable=consider-using-with
        viewer = subprocess.Popen([PROGRAM, "view", folder], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end, viewer)
        return viewer.stdout.readline().strip()

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.terminate()
        process.communicate(timeout=60)

    def opened(self, address, link):
        """The page behind a link of a report, once its run has been carried out again."""
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open(address)
        self.assertEqual(browser.wait(f"[...document.links].filter((one) => one.textContent === '{link}').length"), 1)
        browser.value(f"[...document.links].find((one) => one.textContent === '{link}').click()")
        browser.wait("document.body && document.body.dataset.ready === 'all'", limit=240)
        self.assertEqual(browser.errors, [])
        return browser

    def test_a_case_of_a_campaign(self):
        file, out = self.folder / "lost.toml", self.folder / "lost"
        file.write_text(CAMPAIGN)
        ran = puckloop("faults", "campaign", file, "--out", out)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertIn(f"puckloop view {out}", (out / "report.html").read_text())
        self.assertNotIn("run/2/", (out / "report.html").read_text())
        address = self.viewed(out)
        with urllib.request.urlopen(address, timeout=60) as answer:
            self.assertIn("'unsafe-inline'", answer.headers["Content-Security-Policy"])
            self.assertIn('<a href="run/2/?t=1.200000">2</a>', answer.read().decode())
        for rest in ("run/3/", "run/x/", "run/2", "run//", "run/-1/", "run/2/../../report.html", "report.html"):
            with self.assertRaises(urllib.error.HTTPError, msg=rest) as refused:
                urllib.request.urlopen(address + rest, timeout=60).close()
            refused.exception.close()
            self.assertEqual(refused.exception.code, 404)
        if not find_chromium():
            self.skipTest("no chromium is installed")
        browser = self.opened(address, "2")
        self.assertEqual(browser.value("document.body.dataset.time"), "1.200000")
        self.assertEqual(browser.value("document.getElementById('title').textContent"), "hello.toml")
        self.assertTrue(json.loads((out / "replay/2/report.json").read_text())["faults"][0]["fired"])

    def test_a_run_of_an_experiment(self):
        file, out = self.folder / "two.toml", self.folder / "two"
        file.write_text(EXPERIMENT)
        ran = puckloop("experiment", file, "--out", out)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        again = puckloop("experiment", out, "--again", 2)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertRegex(again.stdout, "^run 2: score ")
        wrong = puckloop("experiment", out, "--again", 3)
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        wrong = puckloop("experiment", self.folder, "--again", 1)
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        (self.folder / "mine").mkdir()
        (self.folder / "mine/diary.txt").write_text("mine")
        wrong = puckloop("experiment", out, "--again", 1, "--out", self.folder / "mine")
        self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        self.assertTrue((self.folder / "mine/diary.txt").exists())
        (self.folder / "file").write_text("mine")
        (self.folder / "link").symlink_to("file")
        for name in ("file", "link"):
            wrong = puckloop("experiment", out, "--again", 1, "--out", self.folder / name)
            self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
            self.assertEqual((self.folder / name).read_text(), "mine")
        self.assertEqual(puckloop("experiment", out, "--again", 1, "--fresh").returncode, 2)
        for words in (("--png", 1), ("--export", "x.html"), ("--at", 1)):
            wrong = puckloop("view", out, *words)
            self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (2, 1), wrong.stderr)
        if not find_chromium():
            self.skipTest("no chromium is installed")
        browser = self.opened(self.viewed(out), "1")
        self.assertEqual(browser.value("document.getElementById('outcome').textContent").split(",")[0], "seed 1")

    def test_a_run_that_cannot_be_carried_out_again_says_why(self):
        scenario = self.folder / "mine.toml"
        scenario.write_text((SOURCE / "scenarios/hello.toml").read_text().replace("../firmware", f"{SOURCE}/firmware"))
        file, out = self.folder / "lost.toml", self.folder / "lost"
        file.write_text(CAMPAIGN.replace(f"{SOURCE}/scenarios/hello.toml", str(scenario)))
        self.assertEqual(puckloop("faults", "campaign", file, "--out", out).returncode, 0)
        address = self.viewed(out)
        scenario.unlink()
        text = ""
        for _ in range(600):
            with urllib.request.urlopen(address + "run/1/", timeout=60) as answer:
                text = answer.read().decode()
            if "refresh" not in text:
                break
        self.assertIn("cannot be shown", text)
        self.assertIn("mine.toml", text)
        scenario.write_text((SOURCE / "scenarios/hello.toml").read_text().replace("../firmware", f"{SOURCE}/firmware"))
        with urllib.request.urlopen(address + "run/1/", timeout=60) as answer:
            self.assertIn("carried out again", answer.read().decode())  # it is tried again


if __name__ == "__main__":
    unittest.main()
