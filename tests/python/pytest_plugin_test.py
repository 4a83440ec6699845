"""The pytest plugin of clients/python, in a session of pytest's own."""

import os
import re
import subprocess
import sys
import unittest

from kit import PROGRAM, SOURCE, InFolder

SESSION = '''
import pathlib
import pytest

HELLO = "%s/scenarios/hello.toml"


def test_a_run_is_driven(puckloop_start):
    run = puckloop_start(HELLO, duration="5 s")
    before = run.dut("robot0.uart", "robot0.linux").expect("\\x00m", timeout="2 s")
    assert before
    pathlib.Path("kept").write_text(str(run.results))


@pytest.mark.parametrize("fault", [(), ("drop link=robot0.uart from=robot0.linux begin=2.5s for=1s may_not_fire=true",)])
def test_a_run_goes_on_from_a_snapshot(puckloop_from, fault):
    run = puckloop_from(HELLO, at="2 s", faults=fault, duration="4 s")
    assert run.time_s == pytest.approx(2.0)
    run.step(to="3 s")


def test_of_a_failure_one_sees_what_there_is(puckloop_start):
    run = puckloop_start(HELLO, duration="5 s", in_process=False)
    run.step(to="1500 ms")
    run.dut("robot0.uart", "robot0.pic").expect("never sent", timeout="100 ms")
'''


MARKED = '''
import pathlib
import pytest

HELLO = "%s/scenarios/hello.toml"
LOST = "drop link=robot0.uart from=robot0.linux begin=2.5s count=1"


@pytest.mark.puckloop(HELLO, at="2 s", duration="4 s", seeds=[1, 2], faults=["", LOST],
                      images=[{"robot0.pic": "%s/firmware/epuck/epuck.hex"}])
def test_each(swarm, robot, board, fault):
    assert swarm.time_s == 2.0
    assert fault in ((), (LOST,))
    assert board.name == robot.pic.name == "robot0.pic"
    robot.sent_by("pic").expect("\\x00", timeout="1 s")
    with open("seen", "a") as file:
        file.write(f"{swarm.command.count('--fault')}\\n")


def test_without_a_marker(swarm):
    pass
'''


class Plugin(InFolder):
    def setUp(self):
        super().setUp()
        self.python = next((one for one in (sys.executable, "/usr/bin/python3") if subprocess.run(
            [one, "-c", "import pytest"], capture_output=True, check=False).returncode == 0), None)
        if self.python is None:
            self.skipTest("there is no pytest")

    def test_runs_are_begun_closed_and_shown_when_a_test_fails(self):
        self.file("session_test.py", SESSION % SOURCE)
        ended = subprocess.run(
            [self.python, "-B", "-m", "pytest", "-q", "-p", "puckloop.pytest_plugin", "-p", "no:cacheprovider",
             "--basetemp", str(self.folder / "temporary"), "session_test.py"],
            capture_output=True, text=True, cwd=self.folder, env={**os.environ, "PUCKLOOP": PROGRAM}, timeout=300,
            check=False)
        said = ended.stdout + ended.stderr
        self.assertEqual(ended.returncode, 1, said)
        self.assertRegex(said, r"1 failed, 3 passed")
        self.assertIn("did not send 'never sent' on robot0.uart within 100 ms", said)
        self.assertRegex(said, r"results: \S*temporary/\S*/run0")
        self.assertRegex(said, r"begun by: \S*puckloop run \S*hello.toml --control --out ")
        self.assertRegex(said, r"simulated: 1\.600000 s")
        self.assertEqual(len(re.findall(r"^  1\.\d+,robot0\.", said, re.M)), 10, said)
        # Two tests went on from one snapshot.
        boots = [one for one in (self.folder / "temporary").glob("puckloop-boot*") if not one.is_symlink()]
        self.assertEqual(len(boots), 1)
        # The run of the first test is over, and its results are kept.
        results = self.folder / "kept"
        self.assertTrue(os.path.isfile(os.path.join(results.read_text(), "report.json")))

    def session(self, *words):
        return subprocess.run(
            [self.python, "-B", "-m", "pytest", "-q", "-p", "puckloop.pytest_plugin", "-p", "no:cacheprovider",
             "--strict-markers", "--basetemp", str(self.folder / "temporary"), *words], capture_output=True, text=True,
            cwd=self.folder, env={**os.environ, "PUCKLOOP": PROGRAM}, timeout=300, check=False)

    def test_a_marker_makes_a_test_of_each_image_fault_and_seed(self):
        self.file("marked_test.py", MARKED.replace("def test_without_a_marker(swarm)", "def test_other()")
                  % (SOURCE, SOURCE))
        ended = self.session("-vv", "marked_test.py")
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        self.assertIn("5 passed", ended.stdout)
        names = re.findall(r"test_each\[(.*?)\]", ended.stdout)
        self.assertEqual(names, ["epuck.hex-seed1", "epuck.hex-seed2",
                                 "epuck.hex-drop link=robot0.uart from=robot0.lin...-seed1",
                                 "epuck.hex-drop link=robot0.uart from=robot0.lin...-seed2"])
        self.assertEqual((self.folder / "seen").read_text().split(), ["0", "0", "1", "1"])
        # One boot for each seed.
        boots = [one for one in (self.folder / "temporary").glob("puckloop-boot*") if not one.is_symlink()]
        self.assertEqual(len(boots), 2)
        ended = self.session("marked_test.py", "--puckloop-seeds", "7", "-vv")
        self.assertEqual(len(re.findall(r"seed7\]", ended.stdout)), 2, ended.stdout)
        self.assertEqual(ended.returncode, 0)

    def test_what_a_session_refuses(self):
        self.file("marked_test.py", MARKED % (SOURCE, SOURCE))
        self.assertIn('test_without_a_marker: swarm, robot, board and fault need @pytest.mark.puckloop("SCENARIO")',
                      self.session("marked_test.py").stdout)
        ended = self.session("marked_test.py", "--puckloop-seeds", "one")
        self.assertIn("--puckloop-seeds one: numbers and commas are expected", ended.stdout + ended.stderr)


if __name__ == "__main__":
    unittest.main()
