"""What may stand at a place of the file, looked up in the JSON schema by dotted path or by its parts."""

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from pydantic import BaseModel

from proxgen.config.layers import EXTENDS

Schema = dict[str, Any]

EXTENDS_SCHEMA: Schema = {
    "anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}],
    "default": [],
    "description": "presets, or YAML files relative to this one, whose values this file takes over",
}


class Keys:
    """All keys of a kind of file.

    Attributes:
        root: the JSON schema of the whole file.
    """

    def __init__(self, model: type[BaseModel]) -> None:
        """Take the schema from the model; `extends` is dealt with before the model sees the file."""
        self.root: Schema = model.model_json_schema()
        self.root["properties"] = {EXTENDS: EXTENDS_SCHEMA} | self.root["properties"]
        self._homes: dict[str, list[str]] | None = None  # sections by key, made when first asked for

    def resolved(self, schema: Schema) -> Schema:
        """The schema with a reference followed; what stands beside the reference wins."""
        if "$ref" in schema:
            name = schema["$ref"].removeprefix("#/$defs/")
            return self.resolved(self.root["$defs"][name]) | {k: v for k, v in schema.items() if k != "$ref"}
        return schema

    def forms(self, schema: Schema) -> list[Schema]:
        """The alternatives of a schema, references followed; a quantity is one form, not number and text."""
        schema = self.resolved(schema)
        if "x-quantity" in schema:
            return [schema]
        for union in ("anyOf", "oneOf"):
            if union in schema:
                return [form for option in schema[union] for form in self.forms(option)]
        return [schema]

    def at(self, parts: Sequence[str | int]) -> list[Schema]:
        """The forms that a value may have at a path; none if there is no such key."""
        current = self.forms(self.root)
        for part in parts:
            current = [form for schema in current for form in self._inside(schema, part)]
        return current

    def _inside(self, schema: Schema, part: str | int) -> list[Schema]:
        """The forms of an item or a key of one form."""
        if isinstance(part, int):
            items = schema.get("prefixItems", [])
            item = items[part] if part < len(items) else schema.get("items")
        else:
            item = schema.get("properties", {}).get(part)
            if item is None and isinstance(schema.get("additionalProperties"), dict):
                item = schema["additionalProperties"]
        return self.forms(item) if isinstance(item, dict) else []

    def names_at(self, parts: Sequence[str | int]) -> list[str]:
        """The keys that a section has."""
        return [name for schema in self.at(parts) for name in schema.get("properties", {})]

    def description_at(self, parts: Sequence[str | int]) -> str:
        """What a key is for."""
        for schema in self.at(parts[:-1]):
            prop = schema.get("properties", {}).get(parts[-1])
            if prop is not None:
                return str(self.resolved(prop).get("description", ""))
        return ""

    def homes_of(self, name: str) -> list[str]:
        """Sections, as dotted paths with `[]` for list items, that have a key of this name."""
        if self._homes is None:
            self._homes = {}
            for path, schema in self.sections():
                for key in schema["properties"]:
                    self._homes.setdefault(key, []).append(path)
        return list(self._homes.get(name, ()))

    def sections(self) -> Iterator[tuple[str, Schema]]:
        """Every section with its dotted path, in the order of the schema; the root is ``''``."""
        yield from self._sections("", self.root)

    def _sections(self, path: str, schema: Schema) -> Iterator[tuple[str, Schema]]:
        """A section and those below it."""
        for form in self.forms(schema):
            if "properties" in form:
                yield path, form
                for name, inner in form["properties"].items():
                    yield from self._sections(f"{path}.{name}" if path else name, inner)
            elif isinstance(form.get("items"), dict):
                yield from self._sections(f"{path}[]", form["items"])


@cache
def keys_of(model: type[BaseModel]) -> Keys:
    """The keys of a kind of file; the schema is made once."""
    return Keys(model)
