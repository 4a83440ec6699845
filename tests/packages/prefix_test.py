"""`cmake --install` into a folder, and what is installed there run from another one."""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["PUCKLOOP_BUILD"])
SOURCE = pathlib.Path(os.environ["PUCKLOOP_SOURCE"])
VERSION = os.environ["PUCKLOOP_VERSION"]


class Prefix(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.prefix = pathlib.Path(folder.name) / "usr"
        cls.elsewhere = pathlib.Path(folder.name) / "elsewhere"
        cls.elsewhere.mkdir()
        for component in ("puckloop", "firmware", "python"):
            subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.prefix, "--component", component, "--strip"],
                           check=True, capture_output=True)

    def run_(self, *words, status=0, **more):
        # Neither the build nor its sources are named in the environment.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PUCKLOOP")}
        ended = subprocess.run([self.prefix / "bin" / "puckloop", *words], capture_output=True, text=True, cwd=self.elsewhere,
                               env={**environment, "PUCKLOOP_CACHE": str(self.elsewhere / "cache"), **more}, check=False)
        self.assertEqual(ended.returncode, status, ended.stdout + ended.stderr)
        return ended

    def test_runs_from_another_folder(self):
        for name in ("hello", "hello.toml"):
            self.run_("run", name, "--in-process", "--duration", "3", "--out", name)
        report = json.loads((self.elsewhere / "hello" / "report.json").read_text())
        self.assertTrue(report["success"])
        self.assertIn(str(self.prefix), json.dumps(report))
        self.assertNotIn(str(SOURCE), json.dumps(report))

    def test_one_process_per_node(self):
        self.run_("run", "tam", "--duration", "3", "--out", "tam")  # the coordinator, and the TAM's image
        self.assertNotIn(str(SOURCE), (self.elsewhere / "tam" / "report.json").read_text())

    def test_finds_what_is_shipped(self):
        listed = json.loads(self.run_("list", "--json").stdout)
        for kind, some in (("scenarios", "hello"), ("campaigns", "own"), ("images", "epuck")):
            rows = listed[kind]
            self.assertTrue(any(some in row["name"] for row in rows), kind)
            self.assertTrue(all(row["file"].startswith(str(self.prefix)) for row in rows), kind)

    def test_every_scenario_has_what_it_names(self):
        for row in json.loads(self.run_("list", "scenarios", "--json").stdout)["scenarios"]:
            text = pathlib.Path(row["file"]).read_text()
            if re.search(r"^\[\[(robot|group|tam)\]\]", text, re.MULTILINE):  # else an arena alone, which others use
                self.run_("check", row["name"])  # images and programs too

    def test_data_elsewhere(self):
        folder = self.elsewhere / "data" / "scenarios"
        folder.mkdir(parents=True)
        text = (self.prefix / "share" / "puckloop" / "scenarios" / "hello.toml").read_text()
        (folder / "mine.toml").write_text(text.replace("../firmware/epuck/", ""))
        self.run_("check", "mine", status=2)
        self.run_("check", "mine", PUCKLOOP_DATA=str(folder.parent))

    def test_no_path_into_the_sources(self):
        programs = [self.prefix / "bin" / "puckloop", *(self.prefix / "lib" / "puckloop").iterdir()]
        self.assertGreaterEqual(len(programs), 4)
        for program in programs:
            for needle in (b"/firmware/epuck", b"/scenarios/", str(BUILD).encode()):
                self.assertNotIn(os.fsencode(SOURCE) + needle if needle.startswith(b"/f") or needle.startswith(b"/s")
                                 else needle, program.read_bytes(), program)

    def test_a_missing_library_is_one_line(self):
        shim = self.prefix / "lib" / "puckloop" / "libpuckloop_shim.so"
        away = shim.with_name("away")
        shim.rename(away)
        try:
            ended = self.run_("run", "hello", "--in-process", "--out", "never", status=2)
        finally:
            away.rename(shim)
        self.assertIn("libpuckloop_shim.so: the library to preload is not there", ended.stderr)
        self.assertEqual(len(ended.stderr.strip().splitlines()), 1)

    def test_python_client(self):
        place = self.prefix / "lib" / "python3" / "dist-packages"
        program = str(self.prefix / "bin" / "puckloop")
        ended = subprocess.run(["python3", "-B", "-c", "import importlib.metadata as m, puckloop; print(m.version('puckloop'), "
                                "[p.value for p in m.entry_points(group='pytest11') if 'puckloop' in p.value])"],
                               env={**os.environ, "PYTHONPATH": str(place), "PUCKLOOP": program}, capture_output=True,
                               text=True, check=False, cwd=self.elsewhere)
        self.assertEqual((ended.stdout.strip(), ended.stderr), (f"{VERSION} ['puckloop.pytest_plugin']", ""))


class Release(unittest.TestCase):
    """What `./puckloop release` refuses, before it builds anything."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        shutil.copy(SOURCE / "puckloop", self.folder)
        (self.folder / "CMakeLists.txt").write_text("project(puckloop VERSION 1.2.3 LANGUAGES C CXX)\n")
        self.write_changelog("## 1.2.3 (in work)\n")

    def write_changelog(self, text):
        (self.folder / "CHANGELOG.md").write_text("# Changelog\n\n" + text)

    def git(self, *words):
        subprocess.run(["git", "-c", "user.name=test", "-c", "user.email=test@example.org", *words], cwd=self.folder, check=True,
                       capture_output=True)

    def refused(self, text):
        ended = subprocess.run([self.folder / "puckloop", "release", self.folder / "made"], capture_output=True, text=True,
                               check=False, env={**os.environ, "GIT_CEILING_DIRECTORIES": str(self.folder.parent)})
        self.assertEqual((ended.returncode, ended.stderr.count("\n")), (2, 1), ended.stderr)
        self.assertIn(text, ended.stderr)
        self.assertFalse((self.folder / "made").exists())

    def test_refusals(self):
        if shutil.which("git") is None:
            self.skipTest("there is no git")
        self.refused("is no repository")
        self.git("init", "-q")
        self.git("add", ".")
        self.git("commit", "-qm", "begin")
        self.refused("CHANGELOG.md has no line '## 1.2.3 (YYYY-MM-DD)'")
        self.write_changelog("## 1.2.3 (2026-11-29)\n")
        self.refused("changes that are not committed")
        self.git("tag", "-a", "v1.2.3", "-m", "too early")
        self.git("commit", "-qam", "date it")
        self.refused("v1.2.3 is tagged at another commit")


if __name__ == "__main__":
    unittest.main()
