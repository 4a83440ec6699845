"""Schemas of arguments: what JSON Schema says of them, and whether they fit."""

from __future__ import annotations

from typing import Any, Mapping, Sequence

from .folders import Refused
from .names import did_you_mean

Schema = dict[str, Any]

BOOLEAN: Schema = {"type": "boolean"}
FAULTS: Schema = {"type": "array", "items": {"type": "string"},
                  "description": "each as of --fault, such as 'drop link=robot0.uart begin=2s count=1'"}
FIRMWARE: Schema = {"type": "object", "additionalProperties": {"type": "string"},
                    "description": "image of each board, such as {\"robot0.pic\": \"my.hex\"}"}

_TYPES: dict[str, tuple[type, ...]] = {"string": (str,), "integer": (int,), "boolean": (bool,), "array": (list,),
                                       "object": (dict,)}


def text(description: str) -> Schema:
    return {"type": "string", "description": description}


def one_of_texts(texts: Sequence[str]) -> Schema:
    return {"type": "string", "enum": list(texts)}


def integer(description: str, least: int, most: int = 2 ** 64 - 1) -> Schema:
    return {"type": "integer", "minimum": least, "maximum": most, "description": description}


def object_of(properties: Mapping[str, Schema], *required: str) -> Schema:
    return {"type": "object", "properties": dict(properties), "required": list(required),
            "additionalProperties": False}


def refuse_what_does_not_fit(value: Any, schema: Schema, name: str = "arguments") -> None:
    """Refused: a key that is missing or unknown, a value of another type or outside of its range."""
    kind = schema["type"]
    if not isinstance(value, _TYPES[kind]) or (kind == "integer" and isinstance(value, bool)):
        raise Refused(f"{name}: expected {kind}, got {type(value).__name__}")
    if "enum" in schema and value not in schema["enum"]:
        raise Refused(f"{name}: '{value}' is none of {', '.join(schema['enum'])}")
    if kind == "integer" and not schema["minimum"] <= value <= schema["maximum"]:
        raise Refused(f"{name}: {value} is outside of {schema['minimum']} to {schema['maximum']}")
    if kind == "array":
        for index, one in enumerate(value):
            refuse_what_does_not_fit(one, schema["items"], f"{name}[{index}]")
    if kind != "object":
        return
    properties = schema.get("properties")
    for key in schema.get("required", ()):
        if key not in value:
            raise Refused(f"{name}: '{key}' is missing")
    for key, one in value.items():
        if properties is None:
            if "additionalProperties" in schema:
                refuse_what_does_not_fit(one, schema["additionalProperties"], f"{name}.{key}")
        elif key in properties:
            refuse_what_does_not_fit(one, properties[key], key)
        else:
            raise Refused(f"{name}: there is no '{key}'{did_you_mean(key, properties)}")
