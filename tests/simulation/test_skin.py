"""What range sensors and switches read, with closed forms; holding and ages; ideal points."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from proxgen.config.schema import Capacitive, TimeOfFlight
from proxgen.errors import SimulationError
from proxgen.model import RobotModel, SensorModule
from proxgen.simulation.arm import ArmGeometry, SensorFrame
from proxgen.simulation.geometry import norm
from proxgen.simulation.obstacles import Motion, Obstacle, ObstacleField
from proxgen.simulation.plant import JointHistory
from proxgen.simulation.self_measurement import SelfMeasurement
from proxgen.simulation.skin import IdealSensing, SkinSensing, open_sensing

Array = NDArray[np.float64]

TOF = TimeOfFlight(range=1.0, cone=0.35, rate=100.0)
SWITCH = Capacitive(trigger=0.1, cone=2.6, rate=1000.0)


def wall(distance: float) -> Obstacle:
    """A large box whose near face is the plane x = distance."""
    half = np.array([0.1, 3.0, 3.0])
    return Obstacle("wall", "box", half, 0.0, 0.0, np.array([distance + 0.1, 0.0, 0.0]), np.eye(3))


def ball(
    position: tuple[float, float, float], radius: float = 0.05, motion: Motion | None = None
) -> Obstacle:
    return Obstacle("ball", "sphere", np.zeros(3), radius, 0.0, np.array(position), np.eye(3), motion)


def with_modules(model: RobotModel, *modules: SensorModule) -> ArmGeometry:
    return ArmGeometry(replace(model, modules=modules))


def base_module(
    tof: TimeOfFlight | None = TOF,
    switch: Capacitive | None = SWITCH,
    normal: tuple[float, float, float] = (1, 0, 0),
) -> SensorModule:
    """A module that sits still in the world's origin."""
    return SensorModule("fixed.0.0", 0, np.zeros(3), np.array(normal, dtype=float), tof, switch)


@pytest.fixture(name="home")
def _home(planar2_model: RobotModel) -> JointHistory:
    return JointHistory(np.zeros(planar2_model.n))


def read_once(
    model: RobotModel, home: JointHistory, obstacle: Obstacle, *modules: SensorModule
) -> tuple[Array, NDArray[np.bool_]]:
    sensing = SkinSensing(ObstacleField([obstacle]), with_modules(model, *modules), seed=0)
    try:
        measurement = sensing.measure(0.0, home)
    finally:
        sensing.close()
    return measurement.tof_range, measurement.capacitive


def test_a_wall_is_seen_at_its_distance(planar2_model: RobotModel, home: JointHistory) -> None:
    for distance in (0.05, 0.4, 0.999):
        ranges, _ = read_once(planar2_model, home, wall(distance), base_module())
        np.testing.assert_allclose(ranges, [distance], atol=1e-6)
    ranges, _ = read_once(planar2_model, home, wall(1.001), base_module())
    assert ranges[0] == 1.0  # exactly the range: nothing seen


def test_the_least_of_the_cone_is_put_on_the_axis(planar2_model: RobotModel, home: JointHistory) -> None:
    tilted = base_module(normal=(np.cos(0.3), 0.0, np.sin(0.3)))
    ranges, _ = read_once(planar2_model, home, wall(0.4), tilted)
    assert ranges[0] == pytest.approx(0.4 / np.cos(0.3 - 0.175), abs=1e-6)


def test_what_lies_beside_the_cone_is_not_seen(planar2_model: RobotModel, home: JointHistory) -> None:
    for angle, seen in ((0.0, True), (0.175, True), (0.4, False), (2.0, False), (np.pi, False)):
        for azimuth in (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi):
            sideways = 0.5 * np.sin(angle)
            place = (0.5 * np.cos(angle), sideways * np.cos(azimuth), sideways * np.sin(azimuth))
            ranges, _ = read_once(planar2_model, home, ball(place, 0.04), base_module())
            assert (ranges[0] < 1.0) == seen, (angle, azimuth)
            if seen:
                assert ranges[0] == pytest.approx(0.46, abs=1e-3)


def test_a_switch_closes_within_its_distance_and_cone(planar2_model: RobotModel, home: JointHistory) -> None:
    for distance, angle, closed in (
        (0.099, 0.0, True),
        (0.101, 0.0, False),
        (0.05, 1.29, True),
        (0.05, 1.31, False),
        (0.05, np.pi, False),
    ):
        reach = distance + 0.02
        place = (reach * np.cos(angle), reach * np.sin(angle), 0.0)
        _, switches = read_once(planar2_model, home, ball(place, 0.02), base_module())
        assert switches.tolist() == [closed], (distance, angle)


def test_modules_move_with_their_bodies(iiwa7_model: RobotModel) -> None:
    rng, arm = np.random.default_rng(11), ArmGeometry(iiwa7_model)
    q = rng.uniform(iiwa7_model.q_lower, iiwa7_model.q_upper)
    poses = arm.poses(q)
    for index, module in enumerate(iiwa7_model.tof_modules):
        pose = poses[module.body]
        place = pose[:3, :3] @ (module.position + 0.3 * module.normal) + pose[:3, 3]
        sensing = SkinSensing(ObstacleField([ball(tuple(place), 0.05)]), arm, seed=0)
        try:
            measurement = sensing.measure(0.0, JointHistory(q))
        finally:
            sensing.close()
        assert measurement.tof_range[index] == pytest.approx(0.25, abs=1e-3)


def test_readings_arrive_late_and_are_held(planar2_model: RobotModel, home: JointHistory) -> None:
    """A wall of one ball comes at 0.2 m/s; the readings lag by latency and by what the rate lets pass."""
    motion = Motion(np.array([-1.0, 0.0, 0.0]), 0.4, 0.2, 0.0, 20.0, 0.0)
    tof = TOF.model_copy(update={"rate": 20.0, "latency": 0.03})
    module = base_module(tof=tof)
    sensing = SkinSensing(
        ObstacleField([ball((0.8, 0.0, 0.0), 0.1, motion)]), with_modules(planar2_model, module), seed=0
    )
    try:
        for index in range(50):
            time = index * 0.02
            measurement = sensing.measure(time, home)
            sampled = np.floor((time - 0.03) * 20.0 + 1e-9) / 20.0
            expected = 0.7 - 0.2 * max(sampled, 0.0)
            assert measurement.tof_range[0] == pytest.approx(expected, abs=1e-4)
            assert measurement.tof_age is not None
            assert measurement.tof_age[0] == pytest.approx(time - sampled, abs=1e-9)
            assert measurement.capacitive_age is not None
            assert measurement.capacitive_age[0] == pytest.approx(0.0, abs=1e-9)
    finally:
        sensing.close()


def test_noise_stays_within_the_range_and_spares_silent_sensors(
    planar2_model: RobotModel, home: JointHistory
) -> None:
    noisy = TOF.model_copy(update={"noise": 0.05})
    for distance in (0.02, 0.99, 1.5):
        sensing = SkinSensing(
            ObstacleField([wall(distance)]), with_modules(planar2_model, base_module(tof=noisy)), seed=4
        )
        try:
            readings = np.array([sensing.measure(i * 0.02, home).tof_range[0] for i in range(200)])
        finally:
            sensing.close()
        assert ((readings >= 0.0) & (readings <= 1.0)).all()
        if distance > 1.0:
            assert (readings == 1.0).all()
        else:
            assert readings.std() > 0.01


def test_sensors_of_one_arm_may_sample_differently(planar2_model: RobotModel, home: JointHistory) -> None:
    slow = base_module(tof=TOF.model_copy(update={"rate": 10.0}))
    late = base_module(tof=TOF.model_copy(update={"latency": 0.05}), switch=None)
    deaf = base_module(tof=None)
    arm = with_modules(planar2_model, slow, late, base_module(), deaf)
    sensing = SkinSensing(ObstacleField([wall(0.5)]), arm, seed=0)
    try:
        measurement = sensing.measure(0.08, home)
        measurement = sensing.measure(0.16, home)
    finally:
        sensing.close()
    assert measurement.tof_age is not None
    np.testing.assert_allclose(measurement.tof_age, [0.06, 0.05, 0.0], atol=1e-9)
    np.testing.assert_allclose(measurement.tof_range, 0.5, atol=1e-6)
    assert measurement.capacitive.shape == (3,)


def test_the_arm_itself_is_seen_and_discarded(iiwa7_model: RobotModel) -> None:
    """Bent so far that the forearm's cuff looks at the upper arm: nothing must be reported."""
    arm, q = ArmGeometry(iiwa7_model), np.array([0.0, 0.0, 0.0, 2.0, 0.0, 1.5, 0.0])
    history = JointHistory(q)
    own = SkinSensing(ObstacleField([]), arm, seed=0, arm_in_rays=True)
    try:
        poses = arm.poses(q)
        origins, directions = own._ranging.rays(poses, np.arange(32))
        own._world.place(0.0, poses)
        carriers = np.repeat(own._ranging.frame.body, 5)
        ends = (origins + directions).reshape(-1, 3)
        fractions = own._world.rays(origins.reshape(-1, 3), ends, carriers)
        assert (fractions < 1.0).sum() >= 5  # the rays do meet the arm
        measurement = own.measure(0.0, history)
    finally:
        own.close()
    assert (measurement.tof_range == 1.0).all()
    assert not measurement.capacitive.any()


def test_an_obstacle_in_front_of_the_arm_is_still_seen(iiwa7_model: RobotModel) -> None:
    arm, q = ArmGeometry(iiwa7_model), np.array([0.0, 0.0, 0.0, 2.0, 0.0, 1.5, 0.0])
    poses = arm.poses(q)
    bare = SkinSensing(ObstacleField([]), arm, seed=0, arm_in_rays=True)
    origins, directions = bare._ranging.rays(poses, np.arange(32))
    bare._world.place(0.0, poses)
    carriers = np.repeat(bare._ranging.frame.body, 5)
    fractions = bare._world.rays(origins.reshape(-1, 3), (origins + directions).reshape(-1, 3), carriers)
    bare.close()
    furthest = fractions.reshape(32, 5).min(axis=1)
    index = int(np.argmax(np.where(furthest < 1.0, furthest, 0.0)))  # the one with most room before the arm
    assert furthest[index] > 0.15
    place = origins[index, 0] + 0.08 * directions[index, 0]
    sensing = SkinSensing(ObstacleField([ball(tuple(place), 0.03)]), arm, seed=0, arm_in_rays=True)
    try:
        measurement = sensing.measure(0.0, JointHistory(q))
    finally:
        sensing.close()
    assert measurement.tof_range[index] == pytest.approx(0.05, abs=1e-3)


def test_a_sensor_does_not_see_the_link_that_carries_it(iiwa7_model: RobotModel) -> None:
    """Modules buried in their own capsule: the capsule must not blind them."""
    buried = tuple(replace(m, position=0.2 * m.position + [0, 0, 0.1]) for m in iiwa7_model.modules[12:18])
    arm = ArmGeometry(replace(iiwa7_model, modules=buried))
    q = np.zeros(7)
    poses = arm.poses(q)
    place = poses[buried[0].body][:3, :3] @ (buried[0].position + 0.5 * buried[0].normal)
    place = place + poses[buried[0].body][:3, 3]
    sensing = SkinSensing(ObstacleField([ball(tuple(place), 0.05)]), arm, seed=0, arm_in_rays=True)
    try:
        measurement = sensing.measure(0.0, JointHistory(q))
    finally:
        sensing.close()
    assert measurement.tof_range[0] == pytest.approx(0.45, abs=1e-3)


def test_the_arm_closes_switches_of_other_links_only(iiwa7_model: RobotModel) -> None:
    """Modules 0.05 m beside the forearm that look at it: carried by it they see nothing."""
    forearm, q = iiwa7_model.capsules[1], np.zeros(7)
    pose = ArmGeometry(iiwa7_model).poses(q)[forearm.body]
    beside = np.array([forearm.radius + 0.05, 0.0, 0.2])
    inwards = np.array([-1.0, 0.0, 0.0])
    own = SensorModule("own.0.0", forearm.body, beside, inwards, TOF, SWITCH)
    place, normal = pose[:3, :3] @ beside + pose[:3, 3], pose[:3, :3] @ inwards
    base = SensorModule("base.0.0", 0, place, normal, TOF, SWITCH)
    arm = ArmGeometry(replace(iiwa7_model, modules=(own, base)))
    poses, both = arm.poses(q), np.array([0, 1])
    frame = SensorFrame(arm.model.modules)
    places = (poses, *frame.place(poses, both), frame.body)
    limits = np.full((2, 1), SWITCH.trigger), np.full((2, 1), np.cos(0.5 * SWITCH.cone))
    assert SelfMeasurement(arm, 0.0).of_switches(*places, *limits).tolist() == [False, True]
    away = (poses, places[1], -places[2], frame.body)
    assert SelfMeasurement(arm, 0.0).of_switches(*away, *limits).tolist() == [False, False]
    near = limits[0] - 0.06, limits[1]
    assert SelfMeasurement(arm, 0.0).of_switches(*places, *near).tolist() == [False, False]
    assert SelfMeasurement(arm, 0.02).of_switches(*places, *near).tolist() == [False, True]


def test_ideal_points_are_the_nearest_ones(iiwa7_model: RobotModel) -> None:
    rng, arm = np.random.default_rng(12), ArmGeometry(iiwa7_model)
    field = ObstacleField([wall(0.9), ball((0.4, 0.5, 0.3))])
    q = rng.uniform(-0.5, 0.5, 7)
    measurement = IdealSensing(field, arm, max_points=64).measure(0.0, JointHistory(q))
    assert measurement.points.shape == (6, 3)
    assert (measurement.tof_range == 1.0).all()
    assert not measurement.capacitive.any()
    assert measurement.tof_age is None
    starts, ends = arm.axes(arm.poses(q))
    distance = field.near_segments(0.0, starts, ends).distance
    for capsule in range(3):
        for obstacle in range(2):
            along = ends[capsule] - starts[capsule]
            point = measurement.points[2 * capsule + obstacle]
            t = np.clip((point - starts[capsule]) @ along / (along @ along), 0.0, 1.0)
            gap = np.linalg.norm(point - starts[capsule] - t * along)
            assert gap == pytest.approx(distance[capsule, obstacle], abs=1e-9)


def test_of_too_many_ideal_points_the_nearest_are_kept(iiwa7_model: RobotModel) -> None:
    field = ObstacleField([ball((0.5, y, 0.5)) for y in np.linspace(-0.8, 0.8, 9)])
    arm, home = ArmGeometry(iiwa7_model), JointHistory(np.zeros(7))
    everything = IdealSensing(field, arm, max_points=64).measure(0.0, home).points
    some = IdealSensing(field, arm, max_points=10).measure(0.0, home).points
    assert everything.shape == (27, 3)
    assert some.shape == (10, 3)
    starts, ends = arm.axes(arm.poses(np.zeros(7)))
    along = ends - starts
    reach = [norm(points[:, None] - 0.5 * (starts + ends)).min(axis=1).max() for points in (some, everything)]
    assert reach[0] < reach[1]
    assert along.shape == (3, 3)


def test_an_unknown_sensing_names_the_known_ones(planar2_model: RobotModel) -> None:
    with pytest.raises(SimulationError, match="did you mean 'skin'"):
        open_sensing("skinn", ObstacleField([]), ArmGeometry(planar2_model), max_points=4, seed=0)
