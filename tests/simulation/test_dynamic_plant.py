"""The cabinet's profiles, the masses of the dynamic arm, and commands that arrive late."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from simulation_tools import StraightController, scene

from proxgen.config.schema import Config
from proxgen.errors import SimulationError
from proxgen.model import RobotModel
from proxgen.model.kinematics import to_pin
from proxgen.simulation.cabinet import Cabinet, Interpolator
from proxgen.simulation.dynamic_plant import DynamicPlant
from proxgen.simulation.rollout import run
from proxgen.simulation.world import DynamicArm

HALF_SPEED = np.array([0.5, -0.5, 0.3, 0.4, 0.8, -0.8, 1.0])


def test_the_profile_keeps_to_its_limits_and_reaches_the_command() -> None:
    cabinet = Cabinet(latency=0.0, acceleration=10.0, jerk=200.0)
    profile = Interpolator(cabinet, np.zeros(2))
    rng, dt, velocities = np.random.default_rng(16), 1e-3, []
    for cycle in range(40):
        profile.command(cycle * 0.02, rng.uniform(-1.0, 1.0, 2))
        velocities += [profile.at(cycle * 0.02 + step * dt)[1] for step in range(20)]
    profile.command(0.8, np.array([0.3, -0.6]))
    velocities += [profile.at(0.8 + step * dt)[1] for step in range(400)]
    acceleration = np.diff(velocities, axis=0) / dt
    assert np.abs(acceleration).max() <= 10.0 + 1e-6
    assert np.abs(np.diff(acceleration, axis=0) / dt).max() <= 200.0 + 1e-3
    np.testing.assert_allclose(velocities[-1], [0.3, -0.6], atol=1e-9)


def test_positions_are_the_integral_of_velocities() -> None:
    profile = Interpolator(Cabinet(latency=0.015), np.array([0.2, -0.1]))
    profile.command(0.0, np.array([0.5, -1.0]))
    profile.command(0.02, np.array([-0.5, 0.2]))
    times = np.arange(0.0, 0.4, 1e-4)
    states = [profile.at(float(time)) for time in times]
    positions, velocities = np.array([s[0] for s in states]), np.array([s[1] for s in states])
    integral = 0.5 * (velocities[1:] + velocities[:-1]) * 1e-4
    np.testing.assert_allclose(np.diff(positions, axis=0), integral, atol=1e-9)
    np.testing.assert_allclose(positions[0], [0.2, -0.1])


def test_a_command_takes_effect_after_the_latency() -> None:
    for latency in (0.0, 0.013, 0.05):
        profile = Interpolator(Cabinet(latency=latency), np.zeros(1))
        profile.command(0.02, np.array([1.0]))
        assert profile.at(0.02 + latency)[1][0] == 0.0
        assert profile.at(0.02 + latency + 0.002)[1][0] > 0.0


def test_an_impossible_cabinet_is_refused() -> None:
    for wrong in ({"latency": -0.1}, {"acceleration": 0.0}, {"jerk": -1.0}, {"position_gain": np.nan}):
        with pytest.raises(SimulationError, match="a cabinet needs"):
            Cabinet(**wrong)


def test_the_arm_falls_as_pinocchio_says(any_model: RobotModel) -> None:
    """With dead motors: pins masses, centres, inertias and placements, whatever the joints are."""
    rng = np.random.default_rng(17)
    heavy = replace(any_model, pin_model=any_model.pin_model.copy())
    for inertia in heavy.pin_model.inertias:
        inertia.mass, inertia.lever = rng.uniform(0.5, 3.0), rng.uniform(-0.1, 0.1, 3)
        root = rng.uniform(-0.1, 0.1, (3, 3))
        inertia.inertia = root @ root.T + 0.02 * np.eye(3)
    step, q = 1e-5, np.clip(rng.uniform(-0.8, 0.8, any_model.n), any_model.q_lower, any_model.q_upper)
    if any_model.pin_model.nv != any_model.n:
        return  # a mimic joint would fall by itself: the coupling is in its motor
    with DynamicArm(heavy, step) as arm:
        arm.reset(q)
        arm._efforts = [0.0] * any_model.n
        fallen = (arm.step(np.zeros(any_model.n)) - q) / step**2
    data, rest = heavy.pin_model.createData(), np.zeros(heavy.n)
    expected = pin.aba(heavy.pin_model, data, to_pin(heavy, q), rest, rest)
    np.testing.assert_allclose(fallen, expected, rtol=1e-4, atol=1e-3)


def test_the_motors_follow_the_profile_against_gravity(iiwa7_model: RobotModel) -> None:
    plant, q = DynamicPlant(iiwa7_model), np.array([0.3, 0.8, -0.2, 1.2, 0.1, -0.6, 0.2])
    try:
        plant.reset(q)
        states = plant.advance(np.zeros(7), 0.5)
        assert np.abs(plant.q - q).max() < 1e-4  # it does not sag
        assert len(states) == 500
        assert states[-1][0] == pytest.approx(0.5)
        for _ in range(50):
            plant.advance(HALF_SPEED, 0.02)
        for _ in range(25):
            plant.advance(np.zeros(7), 0.02)
        # What the ramp up misses, the ramp down adds: the way is that of the commands.
        np.testing.assert_allclose(plant.q, q + HALF_SPEED, atol=2e-4)
    finally:
        plant.close()


def test_the_dynamic_plant_lags_behind_the_kinematic_one(iiwa7_model: RobotModel) -> None:
    quick, slow = (
        Cabinet(latency=0.0, acceleration=50.0, jerk=5000.0),
        Cabinet(latency=0.04, acceleration=4.0),
    )
    travelled = []
    for cabinet in (quick, slow):
        plant = DynamicPlant(iiwa7_model, cabinet)
        try:
            for _ in range(5):
                plant.advance(HALF_SPEED, 0.02)
            travelled.append(np.abs(plant.q))
        finally:
            plant.close()
    assert (travelled[1] < 0.5 * travelled[0]).all()
    assert (travelled[0] < 0.1 * np.abs(HALF_SPEED)).all()


def test_mimic_joints_follow_their_leader(any_model: RobotModel) -> None:
    """A mimic joint is where the model says; arms that have none are not concerned."""
    if all(drive.ratio == 1.0 and drive.offset == 0.0 for drive in any_model.drives):
        return
    plant = DynamicPlant(any_model)
    try:
        plant.reset(np.full(any_model.n, 0.1))
        for _ in range(30):
            plant.advance(np.full(any_model.n, 0.2), 0.02)
        for _ in range(20):
            plant.advance(np.zeros(any_model.n), 0.02)
        arm = plant._arm
        states = arm._bullet.getJointStates(arm._body, arm._joints, **arm._id)
        expected = [drive.ratio * plant.q[drive.index] + drive.offset for drive in any_model.drives]
        np.testing.assert_allclose([state[0] for state in states], expected, atol=1e-3)
    finally:
        plant.close()


def test_a_closed_loop_with_the_dynamic_plant(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    stage = scene(targets=((0.5, -0.3, 0.5), (0.5, 0.3, 0.5)), start=(0.0, 0.6, 0.0, 1.2, 0.0, 0.5, 0.0))
    plant = DynamicPlant(iiwa7_model)
    try:
        logs = [
            run(
                iiwa7_config,
                iiwa7_model,
                StraightController(iiwa7_model),
                stage,
                sensing=sensing,
                duration=6.0,
                plant=plant,
            )
            for sensing in ("ideal", "ideal", "skin")
        ]
    finally:
        plant.close()
    assert logs[0].meta["plant"] == "dynamic"
    assert logs[0].summary()["targets_reached"] >= 1
    np.testing.assert_array_equal(logs[0].q, logs[1].q)  # reset forgets the run before
    np.testing.assert_array_equal(logs[0].q, logs[2].q)
    np.testing.assert_allclose(logs[0].q[0], [0.0, 0.6, 0.0, 1.2, 0.0, 0.5, 0.0], atol=1e-12)


def test_the_plant_of_a_closed_world_is_gone(planar2_model: RobotModel) -> None:
    first, second = DynamicPlant(planar2_model), DynamicPlant(planar2_model)
    first.close()
    third = DynamicPlant(planar2_model)  # pybullet may give it the number of the first
    with pytest.raises(SimulationError, match="closed"):
        first.advance(np.zeros(2), 0.02)
    second.advance(np.ones(2), 0.02)
    third.close()
    second.close()
