"""Scenes of the repository as an arm meets them, and perturbations."""

import numpy as np
import pinocchio as pin
import pytest
from simulation_tools import scene

from proxgen.config.scene import Motion, Obstacle, load_scene
from proxgen.model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.scenery import perturbed, rotation_of, surroundings


def test_rotation_is_that_of_a_urdf() -> None:
    for rpy in np.random.default_rng(18).uniform(-3.0, 3.0, (20, 3)):
        np.testing.assert_allclose(rotation_of(tuple(rpy)), pin.rpy.rpyToMatrix(*rpy), atol=1e-12)


@pytest.mark.parametrize("name", ["gap", "pillar", "facing", "moving"])
def test_the_arm_starts_clear_of_everything(iiwa7_model: RobotModel, name: str) -> None:
    around, arm = surroundings(load_scene(name), iiwa7_model), ArmGeometry(iiwa7_model)
    near = around.field.near_segments(0.0, *arm.axes(arm.poses(around.start)))
    assert (near.distance > 0.1).all()
    assert len(around.targets) == 2


def test_a_motion_of_any_length_of_direction_is_normalised(planar2_model: RobotModel) -> None:
    motion = Motion(direction=(0.0, 3.0, 4.0), distance=0.5, speed=0.1, period=20.0)
    ball = Obstacle(name="ball", shape="sphere", radius=0.1, position=(1.0, 0.0, 0.0), motion=motion)
    around = surroundings(scene(ball, targets=((0.5, 0.4, 0.1),)), planar2_model)
    np.testing.assert_allclose(around.field.positions(5.0)[0], [1.0, 0.3, 0.4])


def test_perturbations_are_bounded_reproducible_and_different(iiwa7_model: RobotModel) -> None:
    original = load_scene("gap")
    changes = [perturbed(original, iiwa7_model, seed) for seed in (1, 1, 2)]
    assert changes[0][0].targets == changes[1][0].targets
    np.testing.assert_array_equal(changes[0][1], changes[1][1])
    assert changes[0][0].targets != changes[2][0].targets
    moved, offset = changes[0]
    assert (np.abs(offset) <= 0.03).all()
    assert np.abs(offset).max() > 0.01
    for new, old in zip(moved.targets, original.targets, strict=True):
        shift = np.abs(np.subtract(new.position, old.position))
        assert 0.0 < shift.max() <= 0.02
    assert moved.obstacles == original.obstacles
