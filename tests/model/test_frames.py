"""Frame geometry: angles of a rotation, and back."""

import numpy as np
import pinocchio as pin
import pytest

from proxgen.model.frames import roll_pitch_yaw


def test_angles_make_the_rotation_they_came_from() -> None:
    rng = np.random.default_rng(3)
    for angles in rng.uniform(-np.pi, np.pi, (200, 3)):
        rotation = pin.rpy.rpyToMatrix(*angles)
        np.testing.assert_allclose(pin.rpy.rpyToMatrix(*roll_pitch_yaw(rotation)), rotation, atol=1e-14)


@pytest.mark.parametrize("pitch", [0.5 * np.pi, -0.5 * np.pi])
def test_where_x_points_up_or_down_the_roll_is_zero(pitch: float) -> None:
    rotation = pin.rpy.rpyToMatrix(0.4, pitch, 1.1)
    angles = roll_pitch_yaw(rotation)
    assert angles[0] == 0.0
    np.testing.assert_allclose(pin.rpy.rpyToMatrix(*angles), rotation, atol=1e-14)
