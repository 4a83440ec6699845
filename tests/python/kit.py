"""Runs the built program, and holds JSON against a JSON Schema."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["PUCKLOOP_PROGRAM"]
SOURCE = pathlib.Path(os.environ["PUCKLOOP_SOURCE"])
os.environ["PUCKLOOP"] = PROGRAM  # what clients start


def puckloop(*words, folder=None, env=None, timeout=300):
    """The ended process: returncode, stdout, stderr."""
    return subprocess.run(
        [PROGRAM, *map(str, words)], capture_output=True, text=True, cwd=folder, timeout=timeout,
        env={**os.environ, **(env or {})}, stdin=subprocess.DEVNULL, check=False)


def typed_in(page, commands):
    """Indented lines of a page that are one of the commands (a pattern), whole where backslashes divide them, without
    remarks."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL).replace("\\\n", " ")
    for line in text.splitlines():
        if found := re.match(rf"    (?:\./)?({commands})$", line):
            yield re.sub(r"\s{2,}(#|\().*$", "", found[1]).strip()


class InFolder(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def refused(self, ended, *parts):
        """Status 2 and one line that holds all parts."""
        self.assertEqual(ended.returncode, 2, ended.stdout + ended.stderr)
        self.assertEqual(ended.stderr.count("\n"), 1, ended.stderr)
        for part in parts:
            self.assertIn(part, ended.stderr)


TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def is_type(value, name):
    if name == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if name == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, TYPES[name])


def problems(value, schema, place="/"):
    """What of `value` a schema forbids, by the keywords that puckloop's schemas use."""
    known = {"$schema", "$id", "title", "description", "type", "properties", "additionalProperties", "required",
             "items", "minItems", "maxItems", "enum", "const", "pattern", "anyOf", "default"}
    if not set(schema) <= known:
        raise ValueError(f"{place}: keywords that this test does not know: {set(schema) - known}")
    found = []
    types = schema.get("type")
    if types is not None:
        types = [types] if isinstance(types, str) else types
        if not any(is_type(value, one) for one in types):
            return [f"{place}: {value!r} is none of {types}"]
    if "const" in schema and value != schema["const"]:
        found.append(f"{place}: {value!r} is not {schema['const']!r}")
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{place}: {value!r} is not one of {schema['enum']}")
    if "pattern" in schema and not re.search(schema["pattern"], value):
        found.append(f"{place}: {value!r} is not like {schema['pattern']}")
    if "anyOf" in schema and all(problems(value, one, place) for one in schema["anyOf"]):
        found.append(f"{place}: {value!r} is none of the forms")
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        more = schema.get("additionalProperties", True)
        for key in schema.get("required", []):
            if key not in value:
                found.append(f"{place}: '{key}' is missing")
        for key, item in value.items():
            if key in properties:
                found += problems(item, properties[key], f"{place}{key}/")
            elif more is False:
                found.append(f"{place}: unknown key '{key}'")
            elif isinstance(more, dict):
                found += problems(item, more, f"{place}{key}/")
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            found.append(f"{place}: {len(value)} items")
        for index, item in enumerate(value):
            found += problems(item, schema.get("items", {}), f"{place}{index}/")
    return found


def schema_of(name):
    return json.loads(puckloop("schema", name).stdout)
