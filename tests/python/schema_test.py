"""The published schemas: the reader's own keys, every shipped file, and no others."""

import json
import re
import tomllib
import unittest

from kit import SOURCE, InFolder, problems, puckloop, schema_of

HEAD = '[run]\nduration = "1 s"\n{run}\n[arena]\nsize = ["1 m", "1 m"]\n{arena}\n'
ROBOT = '[[robot]]\nposition = ["0 m", "0 m"]\n{robot}\n[robot.pic]\nfirmware = "own"\n{pic}\n'

# Where an unknown key is put, and the schema's table of it.
PLACES = {
    "run": ("run",), "arena": ("arena",), "robot": ("robot",), "pic": ("robot", "pic"),
    "\n[robot.rab]\nfirmware = \"own\"\n": ("robot", "rab"),
    "\n[robot.linux]\nprogram = [\"./x\"]\n": ("robot", "linux"),
    "\n[robot.pic.bluetooth]\n": ("robot", "pic", "bluetooth"),
    "\n[[wall]]\nfrom = [\"0 m\", \"0 m\"]\nto = [\"1 m\", \"0 m\"]\n": ("wall",),
    "\n[[box]]\ncentre = [\"0 m\", \"0 m\"]\nsize = [\"1 cm\", \"1 cm\", \"1 cm\"]\n": ("box",),
    "\n[[cylinder]]\ncentre = [\"0 m\", \"0 m\"]\nradius = \"1 cm\"\n": ("cylinder",),
    "\n[[lamp]]\ncentre = [\"0 m\", \"0 m\"]\n": ("lamp",),
    "\n[[speaker]]\nposition = [\"0 m\", \"0 m\"]\nlevel = 100\n": ("speaker",),
    "\n[[floor_patch]]\ncentre = [\"0 m\", \"0 m\"]\ngrey = 0\nsize = [\"1 cm\", \"1 cm\"]\n": ("floor_patch",),
    "\n[light]\n": ("light",),
    "\n[[group]]\ncount = 1\n[group.pic]\nfirmware = \"own\"\n[group.place]\n": ("group", "place"),
    "\n[[tam]]\nposition = [\"0 m\", \"0 m\"]\n": ("tam",),
    "\n[radio]\n": ("radio",), "\n[bluetooth]\n": ("bluetooth",), "\n[ircom]\n": ("ircom",),
    "\n[[can_bus]]\ncontrollers = [\"robot0.pic.can1\", \"robot0.pic.can2\"]\n": ("can_bus",),
    "\n[coordinator]\n": ("coordinator",),
    "\n[mission]\nkind = \"coverage\"\narea = {{ size = [\"1 m\", \"1 m\"] }}\n": ("mission",),
    "\n[mission]\nkind = \"coverage\"\n[mission.area]\nsize = [\"1 m\", \"1 m\"]\n": ("mission", "area"),
    "\n[[fault]]\nlink = \"robot0.uart\"\n": ("fault",),
    "\n[[event]]\nat = \"1 s\"\nlift = \"robot0\"\n": ("event",),
    "": (),
}


def table_at(schema, path):
    for name in path:
        schema = schema["properties"][name]
        schema = schema.get("items", schema)
    return schema


class Scenario(InFolder):
    def asked(self, place):
        """The keys that the reader knows where `place` is, by its own message."""
        key = "zqxjk_unknown = 1\n"
        fill = {"run": "", "arena": "", "robot": "", "pic": ""}
        text = HEAD + ROBOT
        linux = '[robot.linux]\nprogram = ["/bin/true"]\n'
        if place in fill:
            fill[place] = key
        elif "robot." in place or not place:
            text = (key if not place else "") + text + place + (key if place else "")
            linux = "" if "linux" in place else linux
        else:
            text += linux + place + key
            linux = ""
        ended = puckloop("check", self.file("s.toml", text.format(**fill) + (linux if "uart" in place else "")))
        found = re.search(r"unknown key 'zqxjk_unknown' \(expected one of (.*)\)", ended.stderr)
        self.assertIsNotNone(found, place + ended.stderr)
        return set(found.group(1).split(", "))

    def test_every_key_of_the_reader_is_in_the_schema(self):
        schema = schema_of("scenario")
        compared = 0
        for place, path in PLACES.items():
            table = table_at(schema, path)
            keys = self.asked(place)
            compared += len(keys)
            self.assertLessEqual(keys, set(table["properties"]), f"{path}")
            self.assertIs(table["additionalProperties"], False, path)
            # Keys that only other keys lead to are the schema's alone.
            if path not in ((), ("floor_patch",), ("fault",), ("event",), ("coordinator",), ("arena",), ("bluetooth",),
                            ("robot", "linux"), ("group", "place"), ("mission",)):
                self.assertEqual(keys, set(table["properties"]), f"{path}")
        self.assertGreater(compared, 100)

    def test_shipped_files_are_valid(self):
        for kind in ("scenario", "campaign"):
            schema = schema_of(kind)
            for file in sorted((SOURCE / f"{kind}s").glob("*.toml")):
                with open(file, "rb") as stream:
                    self.assertEqual(problems(tomllib.load(stream), schema), [], file.name)

    def test_mistakes_are_not(self):
        schema = schema_of("scenario")
        good = tomllib.loads((SOURCE / "scenarios/hello.toml").read_text())
        for change in ({"robots": []}, {"run": {"duration": 60}}, {"run": {"duration": "60 cm"}}, {"arena": {"sise": 1}},
                       {"robot": [{}]}, {"fault": [{"kind": "dorp"}]}):
            self.assertNotEqual(problems({**good, **change}, schema), [], change)

    def test_the_published_files_are_the_programs(self):
        for name in ("scenario", "campaign", "report"):
            self.assertEqual(json.loads((SOURCE / f"docs/schema/{name}.json").read_text()), schema_of(name),
                             f"puckloop schema {name} > docs/schema/{name}.json")


if __name__ == "__main__":
    unittest.main()
