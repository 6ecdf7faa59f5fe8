"""The page docs/configuration.md: every key with unit, range, default and meaning, from the schema."""

import json
import math
from collections.abc import Iterator

from pydantic import BaseModel

from proxgen.config import quantities
from proxgen.config.keys import Keys, Schema, keys_of
from proxgen.config.layers import preset_names
from proxgen.config.scene import Scene
from proxgen.config.schema import Config

HEAD = """\
# The configuration

<!-- Made by `proxgen schema --page`; a test keeps it up to date. Change the schema instead of this page. -->

One YAML file describes the robot, its skin, its task and how it avoids obstacles; another describes a scene.
`proxgen check FILE` finds everything that is wrong with a file at once; `proxgen check FILE --explain` prints
every value in use and where it was written. For editors that complete and check while you write, save the
output of `proxgen schema` as `robot.schema.json` and begin the file with
`# yaml-language-server: $schema=robot.schema.json`.

## How values are written

Plain numbers are SI units and radians. A unit may be written instead, and is checked:

| quantity | units |
|---|---|
{units}

Truth values are `true` and `false`. A value may be `null` only where the table says so. Unknown and repeated
keys are mistakes. Numbers in parentheses are equations of [the method](method.md).

## Variants: extends

A file that begins with `extends:` takes over all values of what it names, and says only what is different:

```yaml
extends: [iiwa7.yaml, improved]   # files, relative to this one, and presets; what comes later wins
robot: {{name: iiwa7_improved}}
skin:
  cuffs:
    - name: hand                  # the cuff of this name, with other rings
      rings: [{{offset: 0.15, radius: 7 cm, modules: 16}}]
```

Sections are merged key by key. Lists whose items have names (capsules, cuffs, obstacles) are merged item by
item; an empty list empties them. Every other value, lists of numbers among them, is replaced. The presets are
{presets}.

## The words of others

| here | elsewhere |
|---|---|
| `d_a` | detection distance, activation distance, `collision_detection_distance` |
| `d_0u` | safety distance, `minimum_distance` |
| `damper.influence_distance`, `damper.safety_distance`, `damper.gain` | d_i, d_s, xi of a velocity damper |
| `damping.floor` | `damping` (Tikhonov regularisation) |
| `damping.gain`, `damping.threshold` | `lm_damping`, singularity-robust damping |
| `task.gain` | `gain`, k_p of a resolved-rate controller |
"""


def configuration_page() -> str:
    """The whole page as Markdown."""
    presets = " and ".join(f"`{name}`" for name in preset_names())
    parts = [HEAD.format(units="\n".join(_unit_rows()), presets=presets)]
    parts += ["## The robot's file\n", *_sections(Config), "## The scene's file\n", *_sections(Scene)]
    return "\n".join(parts)


def _unit_rows() -> Iterator[str]:
    """A row for every kind of quantity that has units."""
    for kind in quantities.Quantity.__subclasses__():
        if kind.units:
            yield f"| {kind.kind} | {', '.join(f'`{unit}`' for unit in kind.units)} |"


def _sections(model: type[BaseModel]) -> Iterator[str]:
    """A heading and a table for every section; a section that occurs twice has its table once."""
    keys = keys_of(model)
    written: dict[str, str] = {}
    for path, section in keys.sections():
        rows = section["properties"]
        if path:
            yield f"### `{path}`\n"
            yield f"{section.get('description', '')}\n"
        first = written.setdefault(section["title"], path)
        if first != path:
            yield f"The keys are those of `{first}`.\n"
        elif rows:
            yield "| key | value | default | meaning |\n|---|---|---|---|"
            required = section.get("required", [])
            yield "\n".join(_row(keys, name, prop, name in required) for name, prop in rows.items()) + "\n"


def _is_section(keys: Keys, prop: Schema) -> bool:
    """Whether a key holds a section, or a list of sections, with a table of its own."""
    return any("properties" in form or _item_section(keys, form) for form in keys.forms(prop))


def _item_section(keys: Keys, form: Schema) -> bool:
    """Whether a form is a list of sections."""
    items = form.get("items")
    return isinstance(items, dict) and any("properties" in item for item in keys.forms(items))


def _row(keys: Keys, name: str, prop: Schema, required: bool) -> str:
    """One key."""
    forms = keys.forms(prop)
    values = " or ".join(dict.fromkeys(_value(keys, form) for form in forms))
    default = "required" if required else _default(prop, forms, _is_section(keys, prop))
    meaning = str(keys.resolved(prop).get("description", ""))
    return (
        "| " + " | ".join(text.replace("|", "\\|") for text in (f"`{name}`", values, default, meaning)) + " |"
    )


def _value(keys: Keys, form: Schema) -> str:
    """What may be written, in a few words."""
    if "x-quantity" in form:
        unit = f" [{form['x-unit']}]" if form.get("x-unit") else ""
        limits = f", {form['x-range']}" if form["x-range"] else ""
        return f"{form['x-quantity']}{unit}{limits}"
    if "enum" in form or "const" in form:
        return ", ".join(f"`{value}`" for value in form.get("enum", [form.get("const")]))
    if "properties" in form:
        return "section"
    if form.get("type") == "array":
        return _list(keys, form)
    if form.get("type") == "object":
        inner = " or ".join(_value(keys, item) for item in keys.forms(form["additionalProperties"]))
        return f"mapping by joint: {inner}"
    return {"boolean": "`true`, `false`", "null": "`null`", "string": "text"}[form["type"]]


def _list(keys: Keys, form: Schema) -> str:
    """A list, by its items."""
    parts = form.get("prefixItems") or [form["items"]]
    items = " or ".join(dict.fromkeys(_value(keys, item) for part in parts for item in keys.forms(part)))
    if items == "section":
        return "list of sections"
    return f"list of {len(parts)}: {items}" if "prefixItems" in form else f"list of: {items}"


def _default(prop: Schema, forms: list[Schema], is_section: bool) -> str:
    """The default as it would be written; angles in degrees, as people think of them."""
    value = prop.get("default", {})
    if is_section and value:
        return "see below"
    if value and not isinstance(value, list) and forms[0].get("x-quantity") == "angle":
        return f"`{math.degrees(value):.6g} deg`"
    return f"`{json.dumps(value)}`"
