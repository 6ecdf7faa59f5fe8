"""Variants of the examples' arms, and single cycles of the reference, for the tests of its additions."""

from pathlib import Path

import numpy as np

from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Array, Command, Measurement
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def variant(folder: Path, text: str, robot: str = "iiwa7") -> tuple[Config, RobotModel]:
    """An example's arm with other values, and its model.

    Args:
        folder: where the file is written.
        text: YAML beyond `extends`.
        robot: which example.
    """
    path = folder / "variant.yaml"
    path.write_text(f"extends: {EXAMPLES / robot / robot}.yaml\n{text}", encoding="utf-8")
    config = load(path)
    return config, build_model(config)


def silence(model: RobotModel, time: float = 0.0, points: Array | None = None) -> Measurement:
    """A skin that sees nothing, and obstacle points (P, 3) from elsewhere."""
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    switches = np.zeros(len(model.capacitive_modules), dtype=bool)
    given = np.empty((0, 3)) if points is None else np.reshape(np.asarray(points, dtype=float), (-1, 3))
    return Measurement(time, ranges, switches, points=given)


def step_at(
    controller: ReferenceController, q: Array, points: Array | None = None, xdot: Array | None = None
) -> Command:
    """A first cycle at rest at q (n,) with these points."""
    model = controller.model
    controller.reset()
    wanted = np.zeros(model.m) if xdot is None else xdot
    return controller.step(q, wanted, silence(model, 0.0, points))
