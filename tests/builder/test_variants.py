"""Whatever can be configured compiles, and agrees with the reference for some cycles (docs/method.md)."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from proxgen.builder import build
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Measurement
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model

Change = Callable[[Config], Config]


def section(name: str, **changes: object) -> Change:
    """A change of one section of a configuration."""

    def change(config: Config) -> Config:
        return config.model_copy(update={name: getattr(config, name).model_copy(update=changes)})

    return change


def without_sensors(config: Config) -> Config:
    return section("skin", cuffs=())(config)


def without_switches(config: Config) -> Config:
    return section("skin", capacitive=None)(config)


def without_points(config: Config) -> Config:
    return section("skin", max_points=0)(config)


def passive(config: Config) -> Config:
    active = config.avoidance.active.model_copy(update={"enabled": False})
    return section("avoidance", active=active)(config)


VARIANTS: dict[str, Change] = {
    "slack": section("relaxation", mode="slack"),
    "damper": section("avoidance", schedule="damper"),
    "surface": section("avoidance", distance_reference="surface"),
    "passive": passive,
    "free": section("limits", acceleration=None, joint_damper=None),
    "no_sensors": without_sensors,
    "no_switches": without_switches,
    "no_points": without_points,
}


def measurements(config: Config, model: RobotModel, count: int) -> list[Measurement]:
    """Random readings and points, near and far, one period apart."""
    random = np.random.default_rng(5)
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    points = min(4, config.skin.max_points)
    return [
        Measurement(
            time=1.0 + k / config.control.rate,
            tof_range=np.where(random.random(len(ranges)) < 0.3, random.uniform(0.1, 1.0) * ranges, ranges),
            capacitive=random.random(len(model.capacitive_modules)) < 0.1,
            points=random.uniform(-1.0, 1.0, (points, 3)),
        )
        for k in range(count)
    ]


def assert_agree(config: Config, model: RobotModel, folder: Path, backend: str) -> None:
    """Both controllers decide the same in every cycle."""
    compiled = CompiledController.load(build(config, folder, backend=backend).library_dir)
    reference = ReferenceController(config, model)
    random = np.random.default_rng(6)
    lower, upper = np.maximum(model.q_lower, -2.0), np.minimum(model.q_upper, 2.0)
    q = lower + (upper - lower) * random.uniform(0.3, 0.7, model.n)
    for measurement in measurements(config, model, 40):
        xdot = random.normal(0.0, 0.1, model.m)
        found = compiled.step(q, xdot, measurement)
        expected = reference.step(q, xdot, measurement)
        assert found.status == expected.status
        np.testing.assert_allclose(found.qdot, expected.qdot, atol=1e-7)
        reference.follow(found.qdot)
        q = q + found.qdot / config.control.rate


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_variant_of_an_arm(variant: str, planar2_config: Config, tmp_path: Path) -> None:
    config = VARIANTS[variant](planar2_config)
    assert_agree(config, build_model(config), tmp_path, "daqp")


@pytest.mark.parametrize("relaxation", ["staged", "slack"])
def test_the_iiwa_over_qpoases(relaxation: str, iiwa7_config: Config, tmp_path: Path) -> None:
    config = section("relaxation", mode=relaxation)(iiwa7_config)
    assert_agree(config, build_model(config), tmp_path, "qpoases")


def test_any_arm(any_config: Config, any_model: RobotModel, tmp_path: Path) -> None:
    assert_agree(any_config, any_model, tmp_path, "daqp")
