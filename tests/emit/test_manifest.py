"""manifest.json: programs read it, and people may open it."""

import json
from pathlib import Path

import pytest

from proxgen.config import load
from proxgen.emit.manifest import WIDTH, render_manifest
from proxgen.emit.signatures import functions
from proxgen.model import build_model
from proxgen.symbolic import build_program

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", ["iiwa7", "iiwa7_improved"])
def test_no_line_is_longer_than_an_editor_shows(name: str) -> None:
    """With the tables of all additions too, which have five rays for each sensor."""
    config = load(ROOT / "examples" / "iiwa7" / f"{name}.yaml")
    program = build_program(config, build_model(config))
    text = render_manifest(program, functions(program), "mark", 1)
    lines = text.splitlines()
    assert max(map(len, lines)) <= WIDTH
    content = json.loads(text)
    for table in ("tof", "capacitive", "capsules"):  # a line for each row
        assert all(f"    {json.dumps(entry)}" in text for entry in content[table])
    if name == "iiwa7_improved":
        assert len(content["self_measurement"]["rays"]) == len(content["tof"])
        assert content["self_measurement"]["rays"][0][0] == list(program.tof[0].normal)
