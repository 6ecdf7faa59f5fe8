"""The committed folders under generated/: up to date, and right when compiled."""

import ctypes
import json
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from proxgen import __version__
from proxgen.config import load
from proxgen.config.hashing import config_hash
from proxgen.emit import render
from proxgen.model import RobotModel, build_model, kinematics
from proxgen.symbolic import build_program

ROOT = Path(__file__).resolve().parents[2]
ROBOTS = ("iiwa7", "planar2")

Compile = Callable[..., Path]
Load = Callable[..., ctypes.CDLL]


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_committed_code_is_what_is_generated(robot: str) -> None:
    config = load(ROOT / "examples" / robot / f"{robot}.yaml")
    fresh = render(build_program(config, build_model(config)))
    committed = {path.name: path.read_text() for path in (ROOT / "generated" / robot).iterdir()}
    assert sorted(committed) == sorted(fresh)
    for name, text in fresh.items():
        assert committed[name] == text, f"generated/{robot}/{name} is out of date: `make golden` renews it"


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_file_says_what_decides_its_text(robot: str) -> None:
    """The URDF parser's version is not among it: pin 4.0 and 4.1 gave the same text."""
    config = load(ROOT / "examples" / robot / f"{robot}.yaml")
    wanted = (f"proxgen {__version__} (casadi {version('casadi')})", config_hash(config), "proxgen generate")
    for path in (ROOT / "generated" / robot).iterdir():
        if path.suffix == ".json":
            manifest = json.loads(path.read_text())
            assert manifest["sources"] == {"proxgen": __version__, "casadi": version("casadi")}
        else:
            head = path.read_text()[:1000]
            assert all(text in head for text in wanted), path.name


@pytest.mark.parametrize(
    ("file", "named"),
    [
        ("my_arm-2.yaml", "my_arm-2.yaml"),
        ("mein arm.yaml", "planar2.yaml"),
        ("ärm.yaml", "planar2.yaml"),
        ("-o.yaml", "planar2.yaml"),
        ("a\n*.yaml", "planar2.yaml"),
    ],
)
def test_the_commands_name_the_file_and_no_folder(file: str, named: str, tmp_path: Path) -> None:
    for source in (ROOT / "examples" / "planar2").iterdir():
        (tmp_path / (file if source.suffix == ".yaml" else source.name)).write_bytes(source.read_bytes())
    config = load(tmp_path / file)
    files = render(build_program(config, build_model(config)))
    for name in ("model.h", "model.c", "kernels.c", "controller.hpp", "README.md"):
        assert f"proxgen generate {named} -o generated/planar2" in files[name][:1000], name
        assert str(tmp_path) not in files[name]
    assert f"`proxgen build {named}`" in files["README.md"]


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_code_is_plain_ascii(robot: str) -> None:
    """Compilers for small machines know no other letters, in comments neither."""
    for path in (ROOT / "generated" / robot).iterdir():
        if path.suffix in {".c", ".h", ".hpp"}:
            assert path.read_bytes().isascii(), path.name


def test_every_committed_folder_is_known_here() -> None:
    assert {path.name for path in (ROOT / "generated").iterdir()} == set(ROBOTS)


def struct(model: RobotModel, bodies: int) -> type[ctypes.Structure]:
    """The kinematics struct of a robot."""
    sizes = {
        "tool_to_world": 12,
        "body_to_world": 12 * bodies,
        "joint_axis": 3 * model.n,
        "joint_origin": 3 * model.n,
        "J": model.m * model.n,
    }

    class Kinematics(ctypes.Structure):
        _fields_ = [(name, ctypes.c_double * size) for name, size in sizes.items()]

    return Kinematics


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_committed_code_moves_the_arm_as_pinocchio_does(
    robot: str, request: pytest.FixtureRequest, compile_c: Compile, load_c: Load, tmp_path: Path
) -> None:
    model: RobotModel = request.getfixturevalue(f"{robot}_model")
    for name in ("model.c", "model.h", "kernels.c", "kernels.h"):
        (tmp_path / name).write_bytes((ROOT / "generated" / robot / name).read_bytes())
    library = load_c(compile_c(tmp_path / "model.c"), compile_c(tmp_path / "kernels.c", raw=True))
    carrying = sorted({c.body for c in model.capsules} | {m.body for m in model.modules})
    found = struct(model, len(carrying))()
    compute = getattr(library, f"{robot}_kinematics")
    random = np.random.default_rng(7)
    step = 1e-6
    for _ in range(1000):
        q = random.uniform(-3.0, 3.0, model.n)
        assert compute(ctypes.c_void_p(q.ctypes.data), ctypes.byref(found)) == 0
        poses = kinematics.body_poses(model, q)
        tool = kinematics.tool_pose(model, q)
        expected = np.array([poses[body][:3].ravel() for body in carrying])
        np.testing.assert_allclose(np.array(found.tool_to_world), tool[:3].ravel(), atol=1e-12)
        np.testing.assert_allclose(np.array(found.body_to_world), expected.ravel(), atol=1e-12)
        jacobian = np.array(found.J).reshape(model.m, model.n)
        joint = random.integers(model.n)
        forward, backward = q.copy(), q.copy()
        forward[joint] += step
        backward[joint] -= step
        difference = kinematics.tool_pose(model, forward) - kinematics.tool_pose(model, backward)
        speed = difference[: model.m, 3] / (2 * step)
        np.testing.assert_allclose(jacobian[:, joint], speed, atol=1e-8)
