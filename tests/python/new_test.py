"""`puckloop new`: what it writes is checked, runs, and passes its own test; scenarios work where they are copied to."""

import json
import os
import subprocess
import sys
import unittest

from kit import PROGRAM, SOURCE, InFolder, puckloop


class New(InFolder):
    def its_tests(self, project):
        """The ended process of the project's own tests."""
        return subprocess.run([sys.executable, "-B", "-m", "unittest"], cwd=project, capture_output=True, text=True,
                              env={**os.environ, "PUCKLOOP": PROGRAM}, check=False)

    def test_a_project_that_works(self):
        made = puckloop("new", "my_robot", folder=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        project = self.folder / "my_robot"
        scenario = project / "my_robot.toml"
        self.assertTrue(scenario.read_text().startswith("#:schema ./scenario.schema.json\n"))
        json.loads((project / "scenario.schema.json").read_text())
        json.loads((project / ".vscode/settings.json").read_text())
        launch = json.loads((project / ".vscode/launch.json").read_text())["configurations"][0]
        self.assertEqual((launch["type"], launch["request"], launch["board"]), ("puckloop", "launch", "pic"))
        checked = puckloop("check", scenario)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        own = self.its_tests(project)
        self.assertEqual(own.returncode, 0, own.stderr)
        self.refused(puckloop("new", "my_robot", folder=self.folder), "my_robot", "is there already")

    def test_the_controller_in_c_does_the_same(self):
        puckloop("new", "robot", folder=self.folder)
        project = self.folder / "robot"
        if subprocess.run(["make"], cwd=project, capture_output=True, check=False).returncode != 0:
            self.skipTest("no C compiler")
        ends = []
        for program in ("controller.py", "controller"):
            ended = puckloop("run", project / "robot.toml", "--in-process", "--out",
                             self.folder / program, "--linux", project / program)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            report = json.loads((self.folder / program / "report.json").read_text())
            ends.append(report["nodes"]["robot0.pic"]["wheel_steps"])
        for wheel, steps in ends[0].items():
            self.assertAlmostEqual(steps, ends[1][wheel], delta=5)  # of some 7000: their calls take other times

    def test_ci_installs_what_it_then_runs(self):
        puckloop("new", "robot", folder=self.folder)
        project = self.folder / "robot"
        install = project / "ci/install_puckloop.sh"
        self.assertTrue(os.access(install, os.X_OK))
        subprocess.run(["sh", "-n", install], check=True)
        version = json.loads(puckloop("version", "--json").stdout)["version"]
        self.assertIn(f"VERSION={version}-1\n", install.read_text())
        for file in (".github/workflows/puckloop.yml", ".gitlab-ci.yml"):
            text = (project / file).read_text()
            self.assertIn("ci/install_puckloop.sh", text)
            self.assertIn("puckloop run robot.toml --in-process --junit results.xml", text)
        # Without packages it is one line, before anything is done to the system.
        environment = {name: value for name, value in os.environ.items() if name != "PUCKLOOP_PACKAGES"}
        refused = subprocess.run([install], env=environment, capture_output=True, text=True, check=False)
        self.assertEqual((refused.returncode, refused.stderr.count("\n"), refused.stdout), (2, 1, ""))
        self.assertIn("PUCKLOOP_PACKAGES", refused.stderr)

    def test_a_firmware_project(self):
        made = puckloop("new", "blinker", "--firmware", folder=self.folder)
        self.assertEqual(made.returncode, 0, made.stderr)
        project = self.folder / "blinker"
        ended = puckloop("run", project / "blinker.toml", "--in-process", "--out", self.folder / "out")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        report = json.loads((self.folder / "out/report.json").read_text())
        self.assertTrue(all(one["met"] for one in report["expectations"]))
        self.assertEqual(report["warnings"], [])
        own = self.its_tests(project)
        self.assertEqual(own.returncode, 0, own.stderr)
        # A HEX has no variables: that is said, in the place that asks for one.
        scenario = project / "blinker.toml"
        text = scenario.read_text()
        scenario.write_text(text.replace("firmware.elf\"", "firmware.hex\""))
        self.refused(puckloop("run", scenario, "--in-process", "--out", self.folder / "out"), "line ", "no symbols")
        # Another firmware fails, in the run and in the tests.
        scenario.write_text(text)
        (project / "firmware/firmware.elf").write_bytes((SOURCE / "firmware/epuck/epuck.elf").read_bytes())
        failed = puckloop("run", scenario, "--in-process", "--out", self.folder / "out")
        self.assertEqual((failed.returncode, failed.stderr.count("\n")), (1, 1), failed.stderr)
        own = self.its_tests(project)
        self.assertEqual(own.returncode, 1, own.stderr)

    def test_names_that_cannot_be(self):
        for name in ("", "../x", "a b", "x" * 65):
            self.refused(puckloop("new", name, folder=self.folder), "cannot be a project's name")
        self.assertEqual(list(self.folder.iterdir()), [])


class Copied(InFolder):
    def test_a_shipped_scenario_in_a_folder_of_the_users_own(self):
        text = (SOURCE / "scenarios/hello.toml").read_text()
        for firmware in ("own", "epuck.hex"):
            copy = self.file("mine.toml", text.replace("../firmware/epuck/epuck.hex", firmware))
            ended = puckloop("run", copy, "--in-process", "--duration", "2 s", "--out", self.folder / "out")
            self.assertEqual(ended.returncode, 0, ended.stderr)
            files = json.loads((self.folder / "out/report.json").read_text())["files"]
            self.assertEqual(os.path.realpath(files[0]["file"]), str(SOURCE / "firmware/epuck/epuck.hex"))

    def test_a_shipped_scenario_by_its_name(self):
        ended = puckloop("run", "hello", "--in-process", "--duration", "1.1 s", "--out", self.folder / "out")
        self.assertEqual(ended.returncode, 0, ended.stderr)


if __name__ == "__main__":
    unittest.main()
