"""The closed loop, with a trivial controller: order, determinism, observers, every kind of arm."""

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from simulation_tools import StraightController, scene

from proxgen.config.scene import Obstacle, Scene
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Status
from proxgen.errors import ConfigError, SimulationError
from proxgen.model import RobotModel, build_model
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import Obstacle as Solid
from proxgen.simulation.rollout import Cycle, run

BOX = Obstacle(name="box", shape="box", size=(0.1, 0.1, 0.4), position=(0.5, 0.0, 0.2))
START = (0.0, 0.6, 0.0, 1.2, 0.0, 0.5, 0.0)


def two_targets(**changes: Any) -> Scene:
    values = {"targets": ((0.5, -0.35, 0.5), (0.5, 0.35, 0.5)), "start": START} | changes
    return scene(BOX, **values)


def equal(one: RolloutLog, other: RolloutLog) -> bool:
    """Whether two logs say the same, wall time apart."""
    names = [field.name for field in fields(one) if field.name not in ("meta", "cycle_us")]
    same = all(np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in names)
    return same and one.meta == other.meta


@pytest.mark.parametrize("sensing", ["skin", "ideal"])
def test_the_arm_goes_from_target_to_target(
    iiwa7_config: Config, iiwa7_model: RobotModel, sensing: str
) -> None:
    controller = StraightController(iiwa7_model)
    log = run(iiwa7_config, iiwa7_model, controller, two_targets(), sensing=sensing, duration=15.0)
    assert controller.resets == 1
    assert log.cycles == 750
    assert log.summary()["targets_reached"] >= 2
    assert set(log.target_index) == {0, 1}
    np.testing.assert_allclose(log.time, 0.02 * np.arange(750), atol=1e-12)
    np.testing.assert_allclose(log.q[0], START)
    np.testing.assert_allclose(log.q[1:], log.q[:-1] + 0.02 * log.qdot[:-1], atol=1e-15)
    for index in (0, 100, 700):
        pose = tool_pose(iiwa7_model, log.q[index])
        np.testing.assert_allclose(log.tool_position[index], pose[:3, 3])
        np.testing.assert_allclose(log.tool_rotation[index], pose[:3, :3])
        aim = log.meta["targets"][log.target_index[index]]
        np.testing.assert_array_equal(log.target_position[index], aim)
        assert log.target_distance[index] == pytest.approx(np.linalg.norm(pose[:3, 3] - aim))
    swaps = np.flatnonzero(np.diff(log.target_index))
    assert (log.target_distance[swaps] < 0.05).all()


def test_what_the_controller_was_told_is_what_is_logged(
    iiwa7_config: Config, iiwa7_model: RobotModel
) -> None:
    controller = StraightController(iiwa7_model)
    log = run(iiwa7_config, iiwa7_model, controller, two_targets(), duration=4.1)
    assert log.cycles == 205, "4.1 * 50 is a little less than 205"
    np.testing.assert_array_equal([m.tof_range for m in controller.measurements], log.tof_range)
    np.testing.assert_array_equal([m.capacitive for m in controller.measurements], log.capacitive)
    np.testing.assert_array_equal([m.time for m in controller.measurements], log.time)
    assert (log.tof_range < 1.0).any()


def test_true_distances_are_those_of_the_capsules(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    log = run(
        iiwa7_config,
        iiwa7_model,
        StraightController(iiwa7_model),
        two_targets(),
        sensing="ideal",
        duration=2.0,
    )
    radii = [capsule.radius for capsule in iiwa7_model.capsules]
    np.testing.assert_allclose(log.true_axis_distance - log.true_surface_distance, np.tile(radii, (100, 1)))
    assert np.isinf(log.controller_distance).all()
    # At the start the hand's axis runs from wrist to tool; its nearest point of the box by dense sampling.
    wrist = tool_pose(iiwa7_model, log.q[0]) @ np.array([0.0, 0.0, -0.206, 1.0])
    line = np.linspace(wrist[:3], log.tool_position[0], 2000)
    outside = np.maximum(np.abs(line - [0.5, 0.0, 0.2]) - [0.05, 0.05, 0.2], 0.0)
    assert log.true_axis_distance[0, 2] == pytest.approx(np.linalg.norm(outside, axis=1).min(), abs=1e-5)


def test_the_seed_decides_and_nothing_else(iiwa7_config: Config, iiwa7_model: RobotModel) -> None:
    skin = iiwa7_config.skin
    assert skin.tof is not None
    tof = skin.tof.model_copy(update={"noise": 0.005, "dropout": 0.05, "latency": 0.01})
    noisy = iiwa7_config.model_copy(update={"skin": skin.model_copy(update={"tof": tof})})
    model = build_model(noisy)

    def once(seed: int) -> RolloutLog:
        return run(noisy, model, StraightController(model), two_targets(), duration=3.0, seed=seed)

    first = once(1)
    assert equal(first, once(1))
    assert not np.array_equal(first.tof_range, once(2).tof_range)


def test_observers_see_every_cycle_before_the_plant_moves(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    seen: list[Cycle] = []
    done: list[tuple[int, int]] = []
    log = run(
        planar2_config,
        planar2_model,
        StraightController(planar2_model),
        scene(targets=((0.5, 0.4, 0.1),), start=(0.3, 0.8)),
        sensing="ideal",
        duration=1.0,
        observers=[seen.append],
        progress=lambda cycles, total: done.append((cycles, total)),
    )
    assert [cycle.index for cycle in seen] == list(range(50))
    np.testing.assert_array_equal([cycle.q for cycle in seen], log.q)
    np.testing.assert_array_equal([cycle.xdot for cycle in seen], log.xdot)
    np.testing.assert_array_equal([cycle.command.qdot for cycle in seen], log.qdot)
    assert done == [(index + 1, 50) for index in range(50)]


@pytest.mark.parametrize("sensing", ["skin", "ideal"])
def test_every_kind_of_arm_runs(any_config: Config, any_model: RobotModel, sensing: str) -> None:
    """Prismatic, continuous and mimic joints, skew axes, branches; targets where the arm can get."""
    rng = np.random.default_rng(15)
    start = np.clip(rng.uniform(-0.5, 0.5, any_model.n), any_model.q_lower, any_model.q_upper)
    aim = tool_pose(any_model, np.clip(start + 0.2, any_model.q_lower, any_model.q_upper))[:3, 3]
    ball = Obstacle(name="ball", shape="sphere", radius=0.1, position=tuple(aim + 0.15))
    stage = scene(ball, targets=(tuple(aim),), start=tuple(start))
    log = run(any_config, any_model, StraightController(any_model), stage, sensing=sensing, duration=2.0)
    assert log.q.shape == (100, any_model.n)
    assert log.xdot.shape == (100, any_model.m)
    assert np.isfinite(log.true_surface_distance).all()
    assert log.target_distance[-1] <= log.target_distance[0]
    again = [Solid.from_plain(plain) for plain in log.meta["obstacles"]]
    assert [solid.name for solid in again] == ["ball"]


def test_statuses_are_logged(planar2_config: Config, planar2_model: RobotModel) -> None:
    controller = StraightController(planar2_model, status=Status.STOPPED_SOLVER)
    log = run(planar2_config, planar2_model, controller, scene(targets=((0.5, 0.4, 0.1),)), duration=0.2)
    summary = log.summary()
    assert summary["status_counts"] == {"STOPPED_SOLVER": 10}
    assert summary["solver_failures"] == 10
    assert summary["controller"] == "straight"
    assert summary["min_distance_axis_m"] is None


def test_a_start_may_be_given_by_joint_name_and_moved(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    stage = scene(targets=((0.5, 0.4, 0.1),), start={"joint_2": 0.7})
    for offset, start in ((None, [0.0, 0.7]), (np.array([0.1, -0.2]), [0.1, 0.5])):
        log = run(
            planar2_config,
            planar2_model,
            StraightController(planar2_model),
            stage,
            sensing="ideal",
            duration=0.1,
            start_offset=offset,
        )
        np.testing.assert_allclose(log.q[0], start)


def test_scenes_that_do_not_fit_are_refused(planar2_config: Config, planar2_model: RobotModel) -> None:
    controller = StraightController(planar2_model)

    def start(value: Any, **options: Any) -> None:
        stage = scene(targets=((0.5, 0.4, 0.1),), start=value)
        run(planar2_config, planar2_model, controller, stage, duration=0.1, **options)

    with pytest.raises(ConfigError, match=r"7 .*2"):
        start(START)
    with pytest.raises(ConfigError, match="outside its limits"):
        start((99.0, 0.0))
    with pytest.raises(ConfigError, match="did you mean 'joint_1'"):
        start({"joint1": 0.0})
    with pytest.raises(SimulationError, match=r"shape \(3,\) for an arm with 2 joints"):
        start(None, start_offset=np.zeros(3))
    with pytest.raises(SimulationError, match="not finite"):
        start(None, start_offset=np.array([np.nan, 0.0]))
    with pytest.raises(SimulationError, match="no cycle"):
        run(planar2_config, planar2_model, controller, scene(targets=((0.5, 0.4, 0.1),)), duration=0.001)
    with pytest.raises(SimulationError, match="unknown sensing"):
        start(None, sensing="eyes")


def test_a_perturbed_start_stays_within_the_limits(planar2_config: Config, planar2_model: RobotModel) -> None:
    upper = planar2_model.q_upper
    stage = scene(targets=((0.5, 0.4, 0.1),), start=tuple(upper))
    log = run(
        planar2_config,
        planar2_model,
        StraightController(planar2_model),
        stage,
        sensing="ideal",
        duration=0.02,
        start_offset=np.full(2, 0.03),
    )
    np.testing.assert_array_equal(log.q[0], upper)
