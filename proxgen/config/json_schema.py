"""The JSON schema that editors complete and check YAML files with."""

from typing import Any

from pydantic import BaseModel

from proxgen.config.keys import Schema, keys_of
from proxgen.config.layers import EXTENDS, preset_names
from proxgen.config.scene import Scene
from proxgen.config.schema import Config

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def robot_schema() -> Schema:
    """JSON schema of a robot's file."""
    return _file_schema(Config, "proxgen robot")


def scene_schema() -> Schema:
    """JSON schema of a scene's file."""
    schema = _file_schema(Scene, "proxgen scene")
    for case in ("File", "FileOverride"):
        properties = schema["$defs"][case]["properties"]
        listed = properties["targets"]
        trajectory = {"type": "string", "pattern": r"\.csv$"}
        properties["targets"] = {"anyOf": [listed, trajectory], "description": listed["description"]}
    return schema


def _file_schema(model: type[BaseModel], title: str) -> Schema:
    """Two cases: a file that stands alone needs its required keys, one that extends others needs none."""
    root = _tidied(keys_of(model).root)
    whole = {key: value for key, value in root.items() if key != "$defs"}
    whole["properties"][EXTENDS]["examples"] = preset_names()
    definitions = {"File": whole} | root.get("$defs", {})
    partial = {f"{name}Override": _without_required(schema) for name, schema in definitions.items()}
    return {
        "$schema": DIALECT,
        "title": title,
        "if": {"required": [EXTENDS]},
        "then": {"$ref": "#/$defs/FileOverride"},
        "else": {"$ref": "#/$defs/File"},
        "$defs": definitions | partial,
    }


def _tidied(schema: Any) -> Any:
    """Without pydantic's titles, and with unit and range in the descriptions, where editors show them."""
    if isinstance(schema, list):
        return [_tidied(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    tidy = {key: _tidied(value) for key, value in schema.items() if not _is_title(key, value)}
    notes = ", ".join(note for note in (schema.get("x-unit"), schema.get("x-range")) if note)
    if notes and isinstance(schema.get("description"), str):
        tidy["description"] += f" [{notes}]"
    return tidy


def _is_title(key: str, value: Any) -> bool:
    """Whether an entry is the title of a schema (and not a property that is called so)."""
    return key == "title" and isinstance(value, str)


def _without_required(schema: Any) -> Any:
    """The schema in which no key is needed, as the files below may give it."""
    if isinstance(schema, list):
        return [_without_required(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    partial = {}
    for key, value in schema.items():
        if key == "$ref":
            partial[key] = f"{value}Override"
        elif not (key == "required" and isinstance(value, list)):
            partial[key] = _without_required(value)
    return partial
