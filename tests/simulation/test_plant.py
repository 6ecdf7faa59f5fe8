"""The kinematic plant, and where the joints were."""

import numpy as np

from proxgen.simulation.plant import JointHistory, KinematicPlant


def test_the_kinematic_plant_integrates_exactly() -> None:
    plant = KinematicPlant(np.array([0.1, -0.2]))
    steps = plant.advance(np.array([0.5, 1.0]), 0.02)
    assert [moment for moment, _ in steps] == [0.02]
    np.testing.assert_allclose(plant.q, [0.11, -0.18])
    np.testing.assert_array_equal(steps[-1][1], plant.q)
    plant.reset(np.zeros(2))
    np.testing.assert_array_equal(plant.q, [0.0, 0.0])


def test_history_interpolates_between_and_rests_outside() -> None:
    history = JointHistory(np.array([1.0]))
    history.append(0.02, np.array([2.0]))
    history.append(0.04, np.array([0.0]))
    for time, q in ((-1.0, 1.0), (0.0, 1.0), (0.01, 1.5), (0.02, 2.0), (0.035, 0.5), (0.04, 0.0), (9.0, 0.0)):
        np.testing.assert_allclose(history.at(time), [q], atol=1e-12)


def test_history_keeps_copies() -> None:
    q = np.zeros(2)
    history = JointHistory(q)
    q[0] = 5.0
    np.testing.assert_array_equal(history.at(0.0), [0.0, 0.0])
