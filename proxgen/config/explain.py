"""The resolved configuration as YAML, every value with the place that it comes from."""

import json
import math
import re
from collections.abc import Iterator
from typing import Any

from proxgen.config.keys import Keys, keys_of
from proxgen.config.schema import Config

COMMENT_COLUMN = 44
"""Where the comments begin, if the value leaves room."""

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_./-]*")


def explain(config: Config) -> str:
    """All values in use, as a YAML file that gives the same configuration when it is loaded.

    The comment behind a value says where it was written: `file:line`, `preset NAME:line`, or `default`.
    """
    lines = _mapping(config.model_dump(), "", "", config, keys_of(Config))
    return "\n".join(lines) + "\n"


def _mapping(values: dict[str, Any], path: str, indent: str, config: Config, keys: Keys) -> Iterator[str]:
    """The keys of a section."""
    for name, value in values.items():
        inner = f"{path}.{name}" if path else name
        if isinstance(value, dict) and value:
            yield f"{indent}{name}:"
            yield from _mapping(value, inner, f"{indent}  ", config, keys)
        elif isinstance(value, tuple) and value and isinstance(value[0], dict):
            yield f"{indent}{name}:"
            for index, item in enumerate(value):
                first, *rest = _mapping(item, f"{inner}.{index}", f"{indent}    ", config, keys)
                yield f"{indent}  - {first.strip()}"
                yield from rest
        else:
            yield _leaf(f"{indent}{name}: {_scalar(value)}", value, inner, config, keys)


def _leaf(text: str, value: Any, path: str, config: Config, keys: Keys) -> str:
    """A value with its unit and its comment."""
    parts = [int(part) if part.isdigit() else part for part in path.split(".")]
    quantities = [form for form in keys.at(parts) if "x-quantity" in form]
    note = ""
    if quantities and isinstance(value, float):
        if not quantities[0]["x-quantity"].startswith("joint"):  # of those, the unit depends on the joint
            text = f"{text} {quantities[0].get('x-unit', '')}".rstrip()
        if quantities[0]["x-quantity"] == "angle" and value:
            note = f" ({math.degrees(value):.6g} deg)"
    return f"{text:<{COMMENT_COLUMN}}  # {_place(path, config)}{note}"


def _place(path: str, config: Config) -> str:
    """Where a value was written."""
    mark = config.origin.marks.get(path)
    return f"{mark.file}:{mark.line}" if mark else "default"


def _scalar(value: Any) -> str:
    """A value without keys, as YAML; JSON is YAML, but names need no quotes."""
    if isinstance(value, str) and _PLAIN.fullmatch(value) and value.lower() not in {"null", "true", "false"}:
        return value
    if isinstance(value, tuple):
        return f"[{', '.join(_scalar(item) for item in value)}]"
    return json.dumps(value)
