"""What a configuration does not switch on leaves nothing behind: no symbol, no parameter, no field."""

import json
import re
from pathlib import Path

import pytest

from proxgen.builder.program import compile_program
from proxgen.builder.toolchain import run
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.emit import generate
from proxgen.model import build_model
from proxgen.symbolic import build_program

ROOT = Path(__file__).resolve().parents[2]
SYMBOLS = {
    "self_measurement": {"range_shows_arm", "switch_shows_arm"},
    "memory": {"memory_forget", "memory_store"},
    "circulation": {"circulate", "circulation_reset", "nearest_capsule", "tangents", "basis", "linear_part"},
}
"""Functions of the runtime by addition; with the robot's prefix and `internal_`."""

FIELDS = {"self_measurement": "self_readings", "memory": "memory_points", "circulation": "tangent"}
YAML = {
    "self_measurement": "skin: {self_measurement: {enabled: true}}",
    "memory": "skin: {memory: {enabled: true}}",
    "circulation": "avoidance: {circulation: {enabled: true}}",
}


def generated(config: Config, folder: Path) -> Path:
    """The code of a configuration."""
    generate(build_program(config, build_model(config)), folder / "generated")
    return folder / "generated"


def functions_of(code: Path, folder: Path) -> set[str]:
    """Names of the runtime's internal functions in a program of its own."""
    main = folder / "main.c"
    main.write_text("int main(void);\nint main(void) { return 0; }\n")
    program = compile_program(main, code, "daqp", folder / "program")
    listing = run(["nm", "--portability", str(program)], "nm")
    return set(re.findall(r"^planar2_internal_(\w+) [tT]", listing, re.MULTILINE))


@pytest.mark.parametrize("addition", [None, *SYMBOLS])
def test_only_what_is_on_is_there(addition: str | None, planar2_config: Config, tmp_path: Path) -> None:
    config = planar2_config
    if addition:
        path = tmp_path / "on.yaml"
        path.write_text(f"extends: {ROOT}/examples/planar2/planar2.yaml\n{YAML[addition]}\n")
        config = load(path)
    code = generated(config, tmp_path)
    found, header = functions_of(code, tmp_path), (code / "controller.h").read_text()
    manifest = json.loads((code / "manifest.json").read_text())
    assert "find_nearest" in found
    for name, symbols in SYMBOLS.items():
        assert (symbols <= found) if name == addition else not (symbols & found), name
        assert (FIELDS[name] in header) == (name == addition)
        in_manifest = any(name in entry["name"] for entry in manifest["parameters"])
        assert in_manifest == (name == addition)
    assert manifest.get("additions", []) == ([addition] if addition else [])
