"""Generated code of self-collision and of the methods of the comparison: what is there, and what is not."""

import json
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from proxgen.config import load
from proxgen.emit import generate
from proxgen.errors import GenerateError
from proxgen.model import RobotModel, build_model
from proxgen.model.kinematics import body_poses
from proxgen.model.robot_model import Array
from proxgen.program import Program, SelfPointEntry
from proxgen.symbolic import build_program
from proxgen.symbolic.program_builder import carrying_bodies

ROOT = Path(__file__).resolve().parents[2]
STEP = 1e-6

POINTS = """
  self_collision:
    points:
      - {name: tool, frame: tcp, position: [0.01, 0.02, 0.03], radius: 60 mm}
      - {name: base, frame: link_0, position: [0.3, -0.2, 0.1]}
"""


def program_of(folder: Path, avoidance: str) -> Program:
    """The iiwa 7 with other rows."""
    path = folder / "variant.yaml"
    path.write_text(f"extends: {ROOT}/examples/iiwa7/iiwa7.yaml\navoidance:\n{avoidance}", encoding="utf-8")
    config = load(path)
    return build_program(config, build_model(config))


@pytest.mark.parametrize(
    ("avoidance", "macro", "rows"),
    [
        (POINTS, "PG_SELF_POINTS", 7),
        (POINTS + "  active: {enabled: false}\n", "PG_SELF_POINTS", 6),
        ("  method: repulsive\n", "PG_METHOD_REPULSIVE", 6),
        ("  method: tangential\n", "PG_METHOD_TANGENTIAL", 5),
    ],
)
def test_the_code_is_whole_and_laid_out(
    avoidance: str, macro: str, rows: int, tmp_path: Path, compile_c: Callable[..., Path]
) -> None:
    program = program_of(tmp_path, avoidance)
    folder = tmp_path / "generated"
    generate(program, folder)
    compile_c(folder / "model.c")
    compile_c(folder / "kernels.c", raw=True)
    style = [str(Path(sys.executable).parent / "clang-format"), f"--style=file:{ROOT / '.clang-format'}"]
    readable = [path for path in sorted(folder.glob("*.[ch]*")) if path.stem != "kernels"]
    subprocess.run([*style, "--dry-run", "-Werror", *readable], check=True)
    assert macro in (folder / "binding.h").read_text()
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["dimensions"]["rows"] == len(manifest["row_names"]) == rows
    readme = (folder / "README.md").read_text()
    names = [point.name for point in program.self_points] or manifest["row_names"]
    assert all(f"| {name} |" in readme for name in names)


@pytest.mark.parametrize("robot", ["iiwa7", "planar2"])
def test_what_is_off_leaves_no_trace(robot: str) -> None:
    """The committed code has no macro, table, parameter or function of additions."""
    for path in sorted((ROOT / "generated" / robot).iterdir()):
        text = path.read_text()
        assert not re.search(r'self_|SELF_|REPULSIVE|TANGENTIAL|tangential|"row_names|additions', text), path


def distance(model: RobotModel, q: Array, ends: list[tuple[int, Array]]) -> tuple[float, Array, Array]:
    """How far apart two points are that are fixed on bodies, and where they are in the world."""
    poses = body_poses(model, q)
    p, h = ((poses[body] @ np.append(local, 1.0))[:3] for body, local in ends)
    return float(np.linalg.norm(h - p)), p, h


def test_generated_relative_rows_are_rates_of_distances(tmp_path: Path) -> None:
    """row . qdot = -d/dt |h - p| for points that are fixed on their bodies, by finite differences."""
    program = program_of(tmp_path, POINTS)
    model, rng, checked = build_model(load(tmp_path / "variant.yaml")), np.random.default_rng(71), 0
    bodies, kinematics = carrying_bodies(model), program.kernel("kinematics").function
    for kernel in program.kernels:
        if not kernel.name.startswith("self_row_"):
            continue
        moved = [bodies[int(number)] for number in kernel.name.split("_")[2:]]
        for _ in range(5):
            q, qdot = rng.uniform(-2.0, 2.0, 7), rng.normal(size=7)
            ends = [(body, rng.normal(size=3)) for body in moved]
            here, p, h = distance(model, q, ends)
            row = np.array(kernel.function(*kinematics(q)[2:4], p, h, (h - p) / here)).ravel()
            ahead, behind = (distance(model, q + step * qdot, ends)[0] for step in (STEP, -STEP))
            assert row @ qdot == pytest.approx((behind - ahead) / (2.0 * STEP), abs=1e-8)
            checked += 1
    assert checked == 25  # the tool against two bodies, the base against three


def test_a_point_needs_a_word_about_every_capsule(tmp_path: Path) -> None:
    program = program_of(tmp_path, POINTS)
    short = SelfPointEntry("short", 0, (0.0, 0.0, 0.0), 0.0, (True,))
    with pytest.raises(GenerateError, match="short has pairs for 1 of 3 capsules"):
        generate(replace(program, self_points=(short,)), tmp_path / "generated")
