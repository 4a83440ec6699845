"""The examples of clients/python, as their README and the CI templates start them."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree

from kit import PROGRAM, SOURCE, InFolder

EXAMPLES = SOURCE / "clients" / "python" / "examples"


def python_with_pytest():
    return next((one for one in (sys.executable, "/usr/bin/python3") if subprocess.run(
        [one, "-c", "import pytest"], capture_output=True, check=False).returncode == 0), None)


class Examples(InFolder):
    def setUp(self):
        super().setUp()
        self.python = python_with_pytest()
        if self.python is None:
            self.skipTest("there is no pytest (Debian: python3-pytest)")

    def pytest(self, *words, folder):
        return subprocess.run([self.python, "-B", "-m", "pytest", "-p", "no:cacheprovider", *words],
                              capture_output=True, text=True, cwd=folder, env={**os.environ, "PUCKLOOP": PROGRAM},
                              timeout=500, check=False)

    def test_all_ten(self):
        files = sorted(EXAMPLES.glob("test_*.py"))
        self.assertEqual(len(files), 10)
        results = self.folder / "results.xml"
        ended = self.pytest("-q", "--basetemp", str(self.folder / "runs"), f"--junitxml={results}", str(EXAMPLES),
                            folder=self.folder)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        ran = {case.get("classname").rsplit(".", 1)[-1]
               for case in xml.etree.ElementTree.parse(results).iter("testcase")}
        self.assertEqual(ran, {file.stem for file in files})

    def test_the_templates(self):
        """Their command runs the tests of a repository; a test that fails leaves what it asks CI to keep."""
        for template in ("github.yml", "gitlab.yml"):
            text = (EXAMPLES / "ci" / template).read_text()
            self.assertNotIn("\t", text)
            command = re.search(r"python3 -m pytest (.*)$", text, re.M)[1]
            repository = self.folder / template
            (repository / "tests").mkdir(parents=True)
            shutil.copy(EXAMPLES / "test_01_moving_robot.py", repository / "tests")
            (repository / "tests" / "test_wrong.py").write_text(
                "def test_it_flies(puckloop_start):\n    run = puckloop_start('hello')\n    run.step(to='1 s')\n"
                "    assert run.time_s > 5\n")
            ended = self.pytest(*shlex.split(command), folder=repository)
            self.assertEqual(ended.returncode, 1, ended.stdout + ended.stderr)
            suite = xml.etree.ElementTree.parse(repository / "results.xml").find("testsuite")
            self.assertEqual((suite.get("tests"), suite.get("failures")), ("2", "1"))
            kept = list((repository / "results").glob("test_it_flies*/run0/report.json"))
            self.assertTrue(kept)
            for kept_file in ("results.xml", "results"):
                self.assertIn(kept_file, text)
                self.assertTrue(pathlib.Path(repository / kept_file).exists())


if __name__ == "__main__":
    unittest.main()
