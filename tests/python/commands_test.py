"""Commands that people look for: help, version, list, images, check, and what a mistake is answered with."""

import json
import os
import subprocess
import unittest

from kit import SOURCE, InFolder, puckloop

COMMANDS = ["run", "replay", "act", "mcp", "exec", "new", "list", "check", "images", "schema", "trace", "view", "frames",
            "faults", "experiment", "gap", "bench", "test", "debug", "dap", "step", "asm", "disasm", "upload", "help", "version"]


class Help(unittest.TestCase):
    def test_every_command_is_listed(self):
        lines = puckloop("help").stdout.splitlines()
        for command in COMMANDS:
            self.assertTrue(any(line.split()[:1] == [command] for line in lines), command)
        self.assertEqual(puckloop("help").stdout, puckloop("--help").stdout)

    def test_help_of_a_command_is_its_own(self):
        for words in (["run"], ["trace", "decode"], ["exec"]):
            self.assertEqual(puckloop("help", *words).stdout, puckloop(*words, "--help").stdout)
            self.assertEqual(puckloop("help", *words).returncode, 0)
        ended = puckloop("help", "rnu")
        self.assertEqual(ended.returncode, 2)
        self.assertIn("perhaps run", ended.stderr)

    def test_no_line_is_longer_than_100_columns(self):
        for words in ([], *([one] for one in COMMANDS if one != "gap"), ["trace", "decode"], ["trace", "export"],
                      ["trace", "rab"], ["faults", "campaign"], ["frames", "epuck", "decode"]):
            for line in puckloop(*words, "--help").stdout.splitlines():
                self.assertLessEqual(len(line), 100, f"{words}: {line}")

    def test_options_are_in_groups_with_examples(self):
        text = puckloop("run", "--help").stdout
        for part in ("What runs:", "Time:", "Results:", "Debugging:", "Examples:"):
            self.assertIn(part, text)
        self.assertNotIn(" TEXT", text)
        self.assertNotIn("UINT", text)


class Version(unittest.TestCase):
    def test_one_version_with_its_commit(self):
        text = puckloop("version").stdout
        self.assertEqual(text, puckloop("--version").stdout)
        version = json.loads(puckloop("version", "--json").stdout)
        self.assertEqual(version["version"], os.environ["PUCKLOOP_VERSION"])
        self.assertIn(version["version"], text)
        git = subprocess.run(["git", "-C", str(SOURCE), "rev-parse", "--is-inside-work-tree"], capture_output=True,
                             text=True, check=False)
        if git.returncode == 0:
            self.assertRegex(version["commit"], "^[0-9a-f]{12}$")
            self.assertIn(version["commit"], text)


class List(InFolder):
    def test_scenarios_and_campaigns_have_their_first_line(self):
        text = puckloop("list", folder=self.folder).stdout
        first = (SOURCE / "scenarios/hello.toml").read_text().splitlines()[0].lstrip("# ")
        self.assertIn(first, text)
        every = json.loads(puckloop("list", "--json").stdout)
        self.assertEqual({one["name"] for one in every["scenarios"]},
                         {file.stem for file in (SOURCE / "scenarios").glob("*.toml")})
        self.assertEqual({one["name"] for one in every["campaigns"]},
                         {file.stem for file in (SOURCE / "campaigns").glob("*.toml")})
        self.assertEqual({one["name"] for one in every["experiments"]},
                         {file.stem for file in (SOURCE / "scenarios/experiments").glob("*.toml")})
        self.assertEqual({one["name"] for one in every["argos"]},
                         {file.name for file in (SOURCE / "scenarios").glob("*.argos")})
        self.assertTrue(all(one["about"] for kind in ("scenarios", "argos", "experiments", "campaigns")
                            for one in every[kind]))
        self.assertIn("epuck.hex", {one["name"] for one in every["images"]})

    def test_a_wrong_part_is_refused(self):
        self.refused(puckloop("list", "scenrios"), "scenrios", "scenarios")


class Images(InFolder):
    def test_what_is_in_the_folder_is_found_by_its_checksum(self):
        first = json.loads(puckloop("images", "--json").stdout)["images"][0]
        self.file(first["name"], "another file of this name")
        here = json.loads(puckloop("images", first["name"], "--json",
                                   env={"PUCKLOOP_IMAGES": str(self.folder)}).stdout)["images"]
        self.assertEqual(here[0]["found"], "another file of this name")
        text = puckloop("images", env={"PUCKLOOP_IMAGES": str(self.folder)}).stdout
        self.assertIn("missing", text)
        self.assertIn("github.com/gctronic/e-puck-library", text)

    def test_the_users_images_are_the_ones_that_are_listed(self):
        folder = os.environ.get("PUCKLOOP_IMAGES")
        if not folder:
            self.skipTest("PUCKLOOP_IMAGES is not set")
        rows = json.loads(puckloop("images", "--json").stdout)["images"]
        self.assertTrue(any(row["found"] == "there" for row in rows))
        for row in rows:
            if row["found"] == "there":
                ended = puckloop("exec", row["file"], "--seconds", "10 ms")
                self.assertEqual(ended.returncode, 0, row["name"] + ended.stderr)
                self.assertIn(f"--board {row['board']}", ended.stderr)

    def test_an_unknown_one_is_refused_with_what_was_meant(self):
        self.refused(puckloop("images", "BTcom_defalt.hex"), "BTcom_default.hex")


class Names(InFolder):
    def test_a_shipped_experiment_is_found_by_its_name(self):
        (self.folder / "e").mkdir()
        (self.folder / "e/diary.txt").write_text("mine")
        (self.folder / "e/experiment.db").write_text("mine")
        for name in ("aggregation_machine", "aggregation_machine.toml", "scenarios/experiments/aggregation_machine.toml"):
            # Found and read: what it is refused for is the folder for its results.
            self.refused(puckloop("experiment", name, "--out", "e", folder=self.folder), "experiment.db")
        self.refused(puckloop("experiment", "nowhere_at_all", folder=self.folder), "nowhere_at_all")

class Check(InFolder):
    def test_a_scenario_and_a_campaign_without_running(self):
        for name in ("scenarios/hello.toml", "scenarios/swarm.toml", "campaigns/own.toml"):
            ended = puckloop("check", SOURCE / name, folder=self.folder)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertIn("no mistake found", ended.stdout)
            self.assertIn("times real time", ended.stdout)
        self.assertEqual(list(self.folder.iterdir()), [])  # nothing is written
        swarm = json.loads(puckloop("check", "swarm", "--json").stdout)
        self.assertEqual(swarm["robots"], 8)
        self.assertLess(swarm["estimate"]["in_process_wall_per_simulated_second_s"],
                        swarm["estimate"]["processes_wall_per_simulated_second_s"])

    def test_a_program_or_image_that_is_not_there(self):
        good = (SOURCE / "scenarios/hello.toml").read_text()
        own = good.replace("../firmware/epuck/epuck.hex", "nowhere.hex")
        self.refused(puckloop("check", self.file("a.toml", own)), "nowhere.hex")
        own = good.replace("puckloop-control", "./nobody").replace("../firmware/epuck/epuck.hex", "own")
        self.refused(puckloop("check", self.file("b.toml", own)), "nobody")


class Mistakes(InFolder):
    SCENARIO = ('[run]\nduration = "1 s"\n[arena]\nsize = ["1 m", "1 m"]\n[[robot]]\nposition = ["0 m", "0 m"]\n'
                '[robot.pic]\nfirmware = "own"\n')

    def test_files_of_the_wrong_kind(self):
        image = SOURCE / "firmware/epuck/epuck.hex"
        for command in ("run", "check"):
            self.refused(puckloop(command, image), "is a firmware image", "exec", "--firmware")
        self.refused(puckloop("exec", SOURCE / "scenarios/hello.toml"), "is a scenario", "puckloop run")

    def test_a_table_of_the_wrong_name(self):
        file = self.file("a.toml", self.SCENARIO.replace("[[robot]]", "[[robots]]").replace("[robot.", "[robots."))
        self.refused(puckloop("check", file), "'robots'", "perhaps 'robot'")

    def test_a_syntax_error_has_line_and_column(self):
        file = self.file("a.toml", '[run]\nseed = 1\nduration = "1 s\n')
        self.refused(puckloop("check", file), "line 3, column ")

    def test_an_unknown_fault_kind(self):
        self.refused(puckloop("run", SOURCE / "scenarios/hello.toml", "--fault", "dorp link=robot0.uart"), "dorp",
                     'did you mean "drop"?')

    def test_an_unknown_symbol(self):
        image = SOURCE / "firmware/epuck/epuck.hex"
        ended = puckloop("exec", image, "--stop-at", "mian")
        self.assertEqual(ended.returncode, 2)
        self.assertIn("no symbols", ended.stderr)

    def test_an_unknown_failure(self):
        file = self.file("a.toml", self.SCENARIO.replace("[run]\n", '[run]\nallow = ["hang"]\n'))
        self.refused(puckloop("check", file), "line 2", "hang", '"hung"')


class Times(InFolder):
    def test_one_form_everywhere(self):
        image = SOURCE / "firmware/epuck/epuck.hex"
        results = []
        for text in ("0.02", "20ms", "20 ms", "0.02 s", "0.02s"):
            ended = puckloop("exec", image, "--seconds", text, "--json")
            self.assertEqual(ended.returncode, 0, text + ended.stderr)
            results.append(json.loads(ended.stdout)["cycles"])
        self.assertEqual(len(set(results)), 1)
        for text in ("20 cm", "x", "-1", "nan"):
            self.refused(puckloop("exec", image, "--seconds", text), "--seconds", "is not a time from")
        self.refused(puckloop("run", SOURCE / "scenarios/hello.toml", "--duration", "0 s"), "--duration")


class Guess(InFolder):
    def test_the_board_of_an_image(self):
        for image, board in (("firmware/epuck/epuck.hex", "pic"), ("firmware/rab/rab.hex", "rab")):
            ended = puckloop("exec", SOURCE / image, "--seconds", "10 ms")
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertIn(f"--board {board}", ended.stderr)
        tam = [one["file"] for one in json.loads(puckloop("list", "--json").stdout)["images"]
               if one["name"] == "tam.elf"]
        for image in tam:
            self.assertIn("--board tam", puckloop("exec", image, "--seconds", "10 ms").stderr)

    def test_nothing_to_guess_from(self):
        self.refused(puckloop("exec"), "an image")
        self.refused(puckloop("exec", self.file("a.hex", "no image\n")), "a.hex", "no known image format")


if __name__ == "__main__":
    unittest.main()
