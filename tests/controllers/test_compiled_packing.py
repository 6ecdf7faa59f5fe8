"""How arguments pass to C and results come back: nothing of the caller's or of C's is shared."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from compiled_tools import XDOT, Q, free_space

from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.compiled.packing import Packer
from proxgen.controllers.protocol import Command, Measurement
from proxgen.errors import ControllerError
from proxgen.model import RobotModel
from proxgen.model.kinematics import body_poses

SIZES = {"joints": 2, "task_rows": 2, "tof": 3, "capacitive": 2, "max_points": 2}


def seen(**changed: Any) -> Measurement:
    """A measurement of these sizes."""
    plain: dict[str, Any] = {
        "time": 1.0,
        "tof_range": np.array([0.1, 0.2, 0.3]),
        "capacitive": np.array([True, False]),
        "tof_age": np.array([0.01, 0.02, 0.03]),
        "capacitive_age": np.array([0.04, 0.05]),
        "points": np.array([[1.0, 2.0, 3.0]]),
    }
    return Measurement(**plain | changed)


BLOCK = (
    np.array([0.4, 0.9, 0.05, -0.02, 0.1, 0.2, 0.3, 0.01, 0.02, 0.03, 0.04, 0.05, 1.0, 2.0, 3.0]).tobytes()
    + b"\x01\x00"
)


def test_the_block_holds_everything_in_the_order_of_the_header() -> None:
    assert Packer(SIZES).pack(Q, XDOT, seen()) == (BLOCK, 1)


def test_without_ages_and_points_readings_are_fresh_and_nothing_follows() -> None:
    fresh = seen(tof_age=None, capacitive_age=None, points=np.empty((0, 3)))
    block, count = Packer(SIZES).pack(Q, XDOT, fresh)
    assert count == 0 and len(block) == 8 * 12 + 2
    assert np.frombuffer(block[: 8 * 12])[7:].tolist() == [0.0] * 5


@pytest.mark.parametrize(
    "changed",
    [
        {"tof_range": [0.1, 0.2, 0.3]},
        {"capacitive": [1, 0]},
        {"capacitive": np.array([2.5, 0.0])},
        {"tof_age": np.array([0.01, 9.0, 0.02, 9.0, 0.03, 9.0])[::2]},
        {"tof_range": np.array([0.1, 0.2, 0.3]).astype(">f8")},
        {"points": np.array([[1, 2, 3]])},
        {"points": np.asfortranarray(np.array([[1.0, 2.0, 3.0]]))},
    ],
    ids=["list", "integers", "numbers", "strided", "big-endian", "integer points", "by column"],
)
def test_other_kinds_of_arrays_make_the_same_block(changed: dict[str, Any]) -> None:
    assert Packer(SIZES).pack(Q, XDOT, seen(**changed)) == (BLOCK, 1)


def test_points_that_lie_column_by_column_are_read_row_by_row() -> None:
    points = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    block, _ = Packer(SIZES).pack(Q, XDOT, seen(points=np.asfortranarray(points)))
    assert np.frombuffer(block[8 * 12 : 8 * 18]).tolist() == points.ravel().tolist()


@pytest.mark.parametrize("make", [lambda value: value, lambda value: pickle.loads(pickle.dumps(value))])
def test_plain_arrays_are_not_converted(monkeypatch: pytest.MonkeyPatch, make: Any) -> None:
    """Neither are those that came through a pipe, whose type is equal to float64 but not the same object."""

    def convert(*_: Any) -> bytes:
        raise AssertionError("converted")

    monkeypatch.setattr(Packer, "_convert", convert)
    assert Packer(SIZES).pack(make(Q), make(XDOT), make(seen())) == (BLOCK, 1)


@pytest.mark.parametrize(
    ("q", "xdot"),
    [(np.empty((2, 0)), np.zeros(4)), (np.zeros(1), np.zeros(3)), (np.zeros((2, 1)), np.zeros(2))],
)
def test_sizes_that_only_add_up_are_refused(q: np.ndarray, xdot: np.ndarray) -> None:
    with pytest.raises(ControllerError, match="q must be 2 numbers, not shape"):
        Packer(SIZES).pack(q, xdot, seen())


def test_commands_are_independent_of_later_cycles_and_of_the_inputs(
    controller: CompiledController, library: Path, planar2_model: RobotModel
) -> None:
    """Inputs that are written over in place, as a driver does, and commands that are all kept."""
    q, xdot = Q.copy(), XDOT.copy()
    kept: list[Command] = []
    for cycle in range(5):
        q += 0.01
        xdot *= -1.0
        kept.append(controller.step(q, xdot, free_space(planar2_model, 1.0 + cycle)))
    q[:], xdot[:] = np.nan, np.nan
    other, again = CompiledController.load(library), Q.copy()
    for cycle, command in enumerate(kept):
        again += 0.01
        expected = other.step(again, XDOT * (-1.0) ** (cycle + 1), free_space(planar2_model, 1.0 + cycle))
        np.testing.assert_array_equal(command.qdot, expected.qdot)
        np.testing.assert_array_equal(command.diagnostics.g, expected.diagnostics.g)
        np.testing.assert_array_equal(command.diagnostics.H, expected.diagnostics.H)


def test_points_and_ages_reach_the_controller(library: Path, planar2_model: RobotModel) -> None:
    """The same from arrays, which pass as they are, as from lists, which are converted."""
    nothing = free_space(planar2_model)
    tof, switches = len(nothing.tof_range), len(nothing.capacitive)
    poses = body_poses(planar2_model, Q)
    ends = [poses[capsule.body] @ np.append(capsule.end, 1.0) for capsule in planar2_model.capsules]
    points = np.array(ends)[:, :3] + [0.0, 0.0, 0.1]
    one = Measurement(1.0, nothing.tof_range, nothing.capacitive, np.zeros(tof), np.zeros(switches), points)
    lists: dict[str, Any] = {
        "tof_range": nothing.tof_range.tolist(),
        "capacitive": nothing.capacitive.tolist(),
        "points": points.tolist(),
    }
    two = Measurement(1.0, **lists)
    first, second = (CompiledController.load(library).step(Q, XDOT, given) for given in (one, two))
    assert np.isfinite(first.diagnostics.distance).all()
    np.testing.assert_array_equal(first.diagnostics.nearest_point, second.diagnostics.nearest_point)
    np.testing.assert_array_equal(first.qdot, second.qdot)
