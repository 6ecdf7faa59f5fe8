"""The reference against arms that can be calculated on paper: two links in a plane, and three sliders."""

import numpy as np
import pinocchio as pin
import pytest

from proxgen.config.schema import Config
from proxgen.config.variants import override
from proxgen.controllers.protocol import OFF, Array, Command, Measurement, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.objective import bounds
from proxgen.controllers.reference.parameters import changed, default_parameters
from proxgen.model import RobotModel, build_model
from proxgen.model.robot_model import CapsuleModel, Drive

L1, L2, HEIGHT = 0.5, 0.4, 0.1
RATE = 50.0


def without_active_row(config: Config) -> Config:
    """The configuration with (7) switched off."""
    active = config.avoidance.active.model_copy(update={"enabled": False})
    return config.model_copy(update={"avoidance": config.avoidance.model_copy(update={"active": active})})


def nothing_seen(model: RobotModel, points: object = ()) -> Measurement:
    """A measurement of these points alone."""
    ranges = np.array([module.tof.range for module in model.tof_modules if module.tof])
    switches = np.zeros(len(model.capacitive_modules), dtype=bool)
    return Measurement(0.02, ranges, switches, points=np.asarray(points, dtype=float).reshape(-1, 3))


def decide(controller: ReferenceController, q: Array, xdot: Array, points: object = ()) -> Command:
    """The first command after a reset."""
    controller.reset()
    return controller.step(q, xdot, nothing_seen(controller.model, points))


def elbow(q: Array) -> Array:
    """Where the second joint is."""
    return np.array([L1 * np.cos(q[0]), L1 * np.sin(q[0]), HEIGHT])


def jacobian(q: Array) -> Array:
    """J of the two-link arm, rows x and y."""
    s1, c1, s12, c12 = np.sin(q[0]), np.cos(q[0]), np.sin(q.sum()), np.cos(q.sum())
    return np.array([[-L1 * s1 - L2 * s12, -L2 * s12], [L1 * c1 + L2 * c12, L2 * c12]])


def test_an_arm_of_one_joint(planar2_config: Config) -> None:
    """With its elbow locked the planar arm is a lever."""
    config = override(planar2_config, {"robot.locked_joints": {"joint_2": 0.0}})
    controller, q = ReferenceController(config, build_model(config)), np.array([0.7])
    lever = (L1 + L2) * np.array([-np.sin(0.7), np.cos(0.7)])
    xdot = np.array([-0.1, 0.05])
    command = decide(controller, q, xdot)
    np.testing.assert_allclose(command.diagnostics.g, [-lever @ xdot], rtol=0, atol=1e-14)
    damping = command.diagnostics.damping  # two task rows for one joint: w = 0
    assert damping == pytest.approx(0.1)
    np.testing.assert_allclose(command.qdot, [lever @ xdot / (lever @ lever + damping)], rtol=0, atol=1e-12)


def test_objective_of_the_two_link_arm(planar2_config: Config, planar2_model: RobotModel) -> None:
    controller, rng = ReferenceController(planar2_config, planar2_model), np.random.default_rng(1)
    for _ in range(200):
        q, xdot = rng.uniform(-2.7, 2.7, 2), rng.normal(size=2)
        found = decide(controller, q, xdot).diagnostics
        w = abs(L1 * L2 * np.sin(q[1]))
        damping = max(1e-3, 0.1 * (1.0 - w / 1e-3) ** 2 if w < 1e-3 else 0.0)
        J = jacobian(q)
        assert found.manipulability == pytest.approx(w, abs=1e-15)
        assert found.damping == pytest.approx(damping, abs=1e-13)
        np.testing.assert_allclose(found.H, J.T @ J + damping * np.eye(2), rtol=0, atol=1e-14)
        np.testing.assert_allclose(found.g, -J.T @ xdot, rtol=0, atol=1e-14)


@pytest.mark.parametrize("stretch", [0.0, 1e-12, 1e-6, 1e-3, 4e-3])
def test_damping_keeps_its_digits_where_the_arm_is_stretched(
    planar2_config: Config, planar2_model: RobotModel, stretch: float
) -> None:
    """√det(JJᵀ) of a stretched arm would be 1e-9 wrong, and λ 1e-7."""
    found = decide(ReferenceController(planar2_config, planar2_model), np.array([0.7, stretch]), np.zeros(2))
    w = L1 * L2 * np.sin(stretch)
    assert found.diagnostics.manipulability == pytest.approx(w, abs=1e-16)
    assert found.diagnostics.damping == pytest.approx(0.1 * (1.0 - w / 1e-3) ** 2, abs=1e-13)


def test_free_motion_is_damped_least_squares(planar2_config: Config, planar2_model: RobotModel) -> None:
    controller, rng = ReferenceController(planar2_config, planar2_model), np.random.default_rng(2)
    for _ in range(200):
        q, xdot = np.array([rng.uniform(-2.5, 2.5), rng.uniform(0.3, 2.5)]), 0.02 * rng.normal(size=2)
        command = decide(controller, q, xdot)
        J = jacobian(q)
        expected = np.linalg.solve(J.T @ J + 1e-3 * np.eye(2), J.T @ xdot)
        assert np.abs(expected).max() < 0.4, "the acceleration bound would act"
        np.testing.assert_allclose(command.qdot, expected, rtol=0, atol=1e-13)
        assert command.status is Status.SOLVED
        assert command.diagnostics.kkt_residual < 1e-14


def beside_link_2(q: Array, along: float, gap: float) -> tuple[Array, Array, Array]:
    """An obstacle point to the left of link 2; its closest point on the axis, and the direction to it."""
    axis = np.array([np.cos(q.sum()), np.sin(q.sum()), 0.0])
    direction = np.array([-axis[1], axis[0], 0.0])
    closest = elbow(q) + along * axis
    return closest + gap * direction, closest, direction


def row_of_link_2(q: Array, closest: Array, direction: Array) -> Array:
    """d̂ᵀJ_p by hand: z × (p - o_j) for both joints."""
    z = np.array([0.0, 0.0, 1.0])
    origins = np.array([0.0, 0.0, HEIGHT]), elbow(q)
    return np.array([direction @ np.cross(z, closest - origin) for origin in origins])


@pytest.mark.parametrize(
    ("gap", "speed"), [(0.14, 0.2 * 2 / 3), (0.11, 0.0), (0.09, -0.1), (0.08, -0.2), (0.03, -0.2)]
)
def test_row_of_one_obstacle_point(
    planar2_config: Config, planar2_model: RobotModel, gap: float, speed: float
) -> None:
    """Every branch of (13); the thresholds of this arm are 0.15, 0.12, 0.10 and 0.08 m."""
    q = np.array([0.4, 0.9])
    point, closest, direction = beside_link_2(q, 0.25, gap)
    found = decide(ReferenceController(planar2_config, planar2_model), q, np.zeros(2), point).diagnostics
    row = row_of_link_2(q, closest, direction)
    assert found.row_on.tolist() == [False, True, True]
    np.testing.assert_allclose(found.A[1], row, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.A[2], row, rtol=0, atol=1e-15)
    assert found.ubA[1] == pytest.approx(speed, abs=1e-14)
    assert found.ubA.tolist()[0::2] == [OFF, 0.0]
    assert found.distance[1] == pytest.approx(gap, abs=1e-15)
    assert found.approach_speed[1] == pytest.approx(speed, abs=1e-14)
    assert np.isinf(found.distance[0]) and np.isinf(found.approach_speed[0])
    np.testing.assert_array_equal(found.nearest_point[1], point)
    assert np.isnan(found.nearest_point[0]).all()


@pytest.mark.parametrize(("nearer_by", "kept"), [(0.0, 0), (-5e-10, 0), (5e-10, 0), (2e-9, 1), (-2e-9, 0)])
def test_the_first_of_equally_near_points_is_kept(
    planar2_config: Config, planar2_model: RobotModel, nearer_by: float, kept: int
) -> None:
    """Two points on both sides of link 2; rounding must not decide between them."""
    q = np.array([0.4, 0.9])
    left, closest, direction = beside_link_2(q, 0.25, 0.1)
    points = [left, closest - (0.1 - nearer_by) * direction]
    found = decide(ReferenceController(planar2_config, planar2_model), q, np.zeros(2), points).diagnostics
    np.testing.assert_array_equal(found.nearest_point[1], points[kept])


def test_equal_distances_do_not_add_up(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Ten points, each nearer by less than 1e-9 m: the third one is nearer than the first by more."""
    q = np.array([0.4, 0.9])
    points = [beside_link_2(q, 0.25, 0.1 - 0.6e-9 * index)[0] for index in range(10)]
    found = decide(ReferenceController(planar2_config, planar2_model), q, np.zeros(2), points).diagnostics
    np.testing.assert_array_equal(found.nearest_point[1], points[8])


@pytest.mark.parametrize(("beyond", "on"), [(-1e-12, True), (5e-10, True), (2e-9, False)])
def test_a_distance_equal_to_the_threshold_counts(
    planar2_config: Config, planar2_model: RobotModel, beyond: float, on: bool
) -> None:
    """d_a = d_active = 0.15 m."""
    q = np.array([0.4, 0.9])
    point = beside_link_2(q, 0.25, 0.15 + beyond)[0]
    found = decide(ReferenceController(planar2_config, planar2_model), q, np.zeros(2), point).diagnostics
    assert found.row_on.tolist() == [False, on, on]
    assert np.isfinite(found.distance[1]) == on


def test_a_point_beyond_d_a_counts_for_the_active_row_alone(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    """d_a = 0.15 m, and here d_active = 0.2 m: at 0.18 m there is no row of the capsule."""
    controller, q = ReferenceController(planar2_config, planar2_model), np.array([0.4, 0.9])
    controller.set_parameters(d_active=0.2)
    point, closest, direction = beside_link_2(q, 0.25, 0.18)
    found = decide(controller, q, np.zeros(2), point).diagnostics
    assert found.row_on.tolist() == [False, False, True]
    assert found.ubA.tolist() == [OFF, OFF, 0.0]
    np.testing.assert_allclose(found.A[2], row_of_link_2(q, closest, direction), rtol=0, atol=1e-15)
    assert found.distance[1] == pytest.approx(0.18, abs=1e-15)
    assert found.approach_speed[1] == pytest.approx(0.4, abs=1e-13)


def test_a_row_never_demands_more_than_row_speed(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Beside link 1, 0.05 m from the shoulder: the row is short, and -0.2 m/s would need 4 rad/s."""
    controller, q = ReferenceController(planar2_config, planar2_model), np.array([0.0, 0.5])
    found = decide(controller, q, np.zeros(2), [0.05, 0.07, HEIGHT]).diagnostics
    np.testing.assert_allclose(found.A[0], [0.05, 0.0], rtol=0, atol=1e-15)
    assert found.approach_speed[0] == -0.2
    assert found.ubA[0] == pytest.approx(-0.05, abs=1e-15)


def test_a_row_that_no_joint_can_serve_is_off(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Straight above the shoulder: no joint moves that point."""
    controller = ReferenceController(planar2_config, planar2_model)
    command = decide(controller, np.array([0.0, 0.5]), np.zeros(2), [0.0, 0.0, HEIGHT + 0.05])
    assert not command.diagnostics.row_on.any()
    assert command.diagnostics.distance[0] == pytest.approx(0.05)
    assert command.status is Status.SOLVED


def test_one_active_row_projects_the_free_motion(planar2_config: Config, planar2_model: RobotModel) -> None:
    """q̇ = q̇_free - H⁻¹a (aᵀq̇_free - b)/(aᵀH⁻¹a)."""
    controller = ReferenceController(without_active_row(planar2_config), planar2_model)
    rng, cut = np.random.default_rng(3), 0
    for _ in range(300):
        q = np.array([rng.uniform(-2.5, 2.5), rng.uniform(0.5, 2.0)])
        point, closest, direction = beside_link_2(q, rng.uniform(0.2, 0.4), rng.uniform(0.095, 0.14))
        command = decide(controller, q, 0.1 * direction[:2], point)
        found, row = command.diagnostics, row_of_link_2(q, closest, direction)
        if found.row_on.tolist() != [False, True]:
            continue
        free = np.linalg.solve(found.H, -found.g)
        away = np.linalg.solve(found.H, row)
        expected = free - away * max(row @ free - found.ubA[1], 0.0) / (row @ away)
        if np.abs(expected).max() < 0.39:
            cut += row @ free > found.ubA[1]
            np.testing.assert_allclose(command.qdot, expected, rtol=0, atol=1e-12)
    assert cut > 50


def test_the_active_row_alone_projects_onto_its_plane(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    """At 0.14 m (5) would allow 0.13 m/s of approach, (7) allows none."""
    q = np.array([0.4, 0.9])
    point, closest, direction = beside_link_2(q, 0.3, 0.14)
    command = decide(
        ReferenceController(planar2_config, planar2_model), q, 0.05 * direction[:2] + 0.02, point
    )
    H, g, row = command.diagnostics.H, command.diagnostics.g, row_of_link_2(q, closest, direction)
    free, away = np.linalg.solve(H, -g), np.linalg.solve(H, row)
    assert 0.0 < row @ free < command.diagnostics.ubA[1]
    np.testing.assert_allclose(command.qdot, free - away * (row @ free) / (row @ away), rtol=0, atol=1e-13)


def test_weights_of_the_active_row(planar2_config: Config, planar2_model: RobotModel) -> None:
    """Two links, two points: w_k is inverse to the distance (6)."""
    q = np.array([0.2, 1.2])
    point, closest, direction = beside_link_2(q, 0.3, 0.1)
    radial = np.array([-np.sin(q[0]), np.cos(q[0]), 0.0])
    beside_1 = np.array([0.2 * np.cos(q[0]), 0.2 * np.sin(q[0]), HEIGHT]) - 0.05 * radial
    found = decide(
        ReferenceController(planar2_config, planar2_model), q, np.zeros(2), [point, beside_1]
    ).diagnostics
    rows = np.array([[-0.2, 0.0], row_of_link_2(q, closest, direction)])
    np.testing.assert_allclose(found.A[:2], rows, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.A[2], (20.0 * rows[0] + 10.0 * rows[1]) / 30.0, rtol=0, atol=1e-15)


def test_bounds_near_a_position_limit(planar2_config: Config, planar2_model: RobotModel) -> None:
    """k_d (q_ub - q) with k_d = 5; 0 at and beyond the limit; what the acceleration of 20 rad/s² allows."""
    controller = ReferenceController(planar2_config, planar2_model)
    for q1, lower, upper in ((2.97, -0.4, 0.15), (3.0, -0.4, 0.0), (3.05, -0.4, 0.0), (-2.99, -0.05, 0.4)):
        found = decide(controller, np.array([q1, 0.5]), np.zeros(2)).diagnostics
        assert (found.lb[0], found.ub[0]) == pytest.approx((lower, upper), abs=1e-13)
        assert (found.lb[1], found.ub[1]) == (-0.4, 0.4)


def test_bounds_with_viability(planar2_config: Config, planar2_model: RobotModel) -> None:
    """With a = 20 rad/s² at 50 Hz: room/T up to the speed aT, then room for braking and one more cycle."""
    controller = ReferenceController(planar2_config, planar2_model)
    for k_d, room, speed in (
        (
            OFF,
            0.001,
            0.001 / 0.02,
        ),  # T is the period: in the last 0.008 rad all of the room, within one cycle
        (OFF, 0.032, np.sqrt(0.8**2 + 40.0 * 0.024) - 0.4),
        (50.0, 0.032, np.sqrt(0.8**2 + 40.0 * 0.024) - 0.4),
        (10.0, 0.1, 1.0),  # the joint damper as it is, up to 2 rad/s
        (20.0, 0.04, 0.8),
        (20.0, 0.10, np.sqrt(1.4**2 + 40.0 * 0.05) - 0.4),  # beyond 1 rad/s it would ask for too much
    ):
        controller.set_parameters(viability=1.0, joint_damper=k_d)
        controller.reset()
        controller.follow(np.array([speed, 0.0]))
        q = np.array([3.0 - room, 0.5])
        found = controller.step(q, np.zeros(2), nothing_seen(planar2_model)).diagnostics
        assert found.ub[0] == pytest.approx(speed, abs=1e-13)
        controller.reset()
        controller.follow(np.array([-speed, 0.0]))
        found = controller.step(-q, np.zeros(2), nothing_seen(planar2_model)).diagnostics
        assert found.lb[0] == pytest.approx(-speed, abs=1e-13)


@pytest.mark.parametrize(("k_d", "a"), [(OFF, 20.0), (5.0, 2.0), (100.0, 7.0)])
def test_viability_holds_for_any_speed_within_the_bounds(
    planar2_config: Config, planar2_model: RobotModel, k_d: float, a: float
) -> None:
    """Whatever q̇ is taken within the bounds: no limit is passed, and the next bound is at least q̇ - aΔt."""
    values = {"viability": 1.0, "joint_damper": k_d, "qddot_limit": np.full(2, a)}
    p = changed(default_parameters(planar2_config, planar2_model), values)
    rng = np.random.default_rng(61)
    for _ in range(20):
        q, qdot = rng.uniform(p.q_lower, p.q_upper), np.zeros(2)
        outwards = rng.choice([-1.0, 1.0], 2)
        for _ in range(100):
            lb, ub = bounds(q, qdot, p)
            assert np.all(ub >= qdot - a * p.period - 1e-12)
            assert np.all(lb <= qdot + a * p.period + 1e-12)
            part = rng.uniform(0.7, 1.0, 2) ** 4
            qdot = np.where(outwards > 0.0, lb + part * (ub - lb), ub - part * (ub - lb))
            q = q + p.period * qdot
            assert np.all((q <= p.q_upper + 1e-12) & (q >= p.q_lower - 1e-12))


def test_the_limit_wins_over_the_acceleration(planar2_config: Config, planar2_model: RobotModel) -> None:
    controller = ReferenceController(planar2_config, planar2_model)
    controller.reset()
    controller.follow(np.array([2.0, 0.0]))
    found = controller.step(np.array([3.0, 0.5]), np.zeros(2), nothing_seen(planar2_model)).diagnostics
    assert (found.lb[0], found.ub[0]) == (0.0, 0.0)
    controller.reset()
    controller.follow(np.array([1.0, 0.0]))
    found = controller.step(np.array([0.0, 0.5]), np.zeros(2), nothing_seen(planar2_model)).diagnostics
    assert (found.lb[0], found.ub[0]) == pytest.approx((0.6, 1.4))


def test_the_acceleration_acts_for_one_period(planar2_config: Config, planar2_model: RobotModel) -> None:
    """20 rad/s² for 10 ms; for a second, the velocity limits come first."""
    controller, q = ReferenceController(planar2_config, planar2_model), np.array([0.4, 0.9])
    controller.set_parameters(period=0.01, joint_damper=OFF)
    np.testing.assert_allclose(decide(controller, q, np.zeros(2)).diagnostics.ub, 0.2, rtol=0, atol=1e-15)
    controller.set_parameters(period=1.0)
    found = decide(controller, q, np.zeros(2)).diagnostics
    np.testing.assert_array_equal(found.ub, planar2_model.qdot_limit)
    np.testing.assert_array_equal(found.lb, -planar2_model.qdot_limit)


def test_posture_pulls_where_the_task_leaves_freedom(
    planar2_config: Config, planar2_model: RobotModel
) -> None:
    controller, q = ReferenceController(planar2_config, planar2_model), np.array([0.4, 0.9])
    weight, wanted = np.array([0.02, 0.0]), np.array([0.1, 7.0])
    controller.set_parameters(posture_weight=weight, posture_gain=2.0, posture=wanted)
    found = decide(controller, q, np.zeros(2)).diagnostics
    J = jacobian(q)
    np.testing.assert_allclose(found.H, J.T @ J + np.diag(1e-3 + weight), rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.g, -weight * 2.0 * (wanted - q), rtol=0, atol=1e-15)


def gantry() -> RobotModel:
    """Three sliders along x, y, z, made without a URDF; a sphere of radius 0.05 m at the tool."""
    model = pin.Model()
    for joint in (pin.JointModelPX(), pin.JointModelPY(), pin.JointModelPZ()):
        model.addJoint(model.njoints - 1, joint, pin.SE3.Identity(), f"slide_{model.njoints}")
    drives = tuple(Drive(i, 1.0, 0.0, True, np.eye(3)[i]) for i in range(3))
    tip = np.array([0.0, 0.0, -0.2])
    tool = np.eye(4)
    tool[:3, 3] = tip
    return RobotModel(
        name="gantry",
        pin_model=model,
        drives=drives,
        joint_names=("slide_1", "slide_2", "slide_3"),
        tool_body=3,
        tool_in_body=tool,
        task_rows=("x", "y", "z"),
        task_frame=None,
        q_lower=np.full(3, -1e20),
        q_upper=np.full(3, 1e20),
        qdot_limit=np.full(3, 1.5),
        qddot_limit=np.full(3, 1e20),
        capsules=(CapsuleModel("tip", 3, tip, tip, 0.05, 0.05),),
        modules=(),
    )


def test_three_sliders_without_limits(planar2_config: Config) -> None:
    """J = 1 and A = d̂: the obstacle takes away the motion towards it, and nothing else."""
    model = gantry()
    controller, rng = ReferenceController(without_active_row(planar2_config), model), np.random.default_rng(4)
    for _ in range(100):
        q, xdot, direction = rng.normal(size=3), 0.3 * rng.normal(size=3), rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        gap = rng.uniform(0.105, 0.145)
        obstacle = q + np.array([0.0, 0.0, -0.2]) + (0.05 + gap) * direction
        command = decide(controller, q, xdot, obstacle)
        allowed = 0.2 * (gap - 0.12) / 0.03 if gap > 0.12 else 0.0
        free = xdot / 1.001
        expected = free - direction * max(float(direction @ free) - allowed, 0.0)
        np.testing.assert_allclose(command.diagnostics.A[0], direction, rtol=0, atol=1e-14)
        np.testing.assert_allclose(command.diagnostics.lb, -1.5)
        np.testing.assert_allclose(command.qdot, expected, rtol=0, atol=1e-13)
