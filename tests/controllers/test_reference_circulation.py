"""Circulation: when the tool counts as stuck, which way round it goes, when the way is clear again."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reference_tools import silence, variant

from proxgen.config.scene import load_scene
from proxgen.controllers.protocol import Array, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.avoidance import Nearest
from proxgen.controllers.reference.circulation import Circulation
from proxgen.controllers.reference.parameters import Parameters
from proxgen.errors import ConfigError
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.rollout import run

CIRCULATION = "avoidance: {circulation: {enabled: true}}\n"
POSITION = ("x", "y", "z")
FORWARD = np.array([0.25, 0.0, 0.0])
ON = 0.30


@pytest.fixture(scope="module")
def controller(tmp_path_factory: pytest.TempPathFactory) -> ReferenceController:
    return ReferenceController(*variant(tmp_path_factory.mktemp("circulation"), CIRCULATION))


@pytest.fixture(scope="module")
def p(controller: ReferenceController) -> Parameters:
    return controller._parameters


def facing(*directions: list[float], distance: float = 0.25) -> Nearest:
    """One capsule per direction with an obstacle point in it; an empty one has none."""
    count = len(directions)
    there = np.array([bool(direction) for direction in directions])
    unit = np.array([np.array(d) / np.linalg.norm(d) if d else np.full(3, np.nan) for d in directions])
    distances = np.where(there, distance + 0.01 * np.arange(count), np.inf)
    return Nearest(distances, unit, unit, unit, False)


WALL = facing([1.0, 0.0, 0.0], [])
NOTHING = facing([], [])


class Tool:
    """A task of three rows whose tool moves as `velocity` says; remembers what it was told to do."""

    def __init__(self, p: Parameters, rows: tuple[str, ...] = POSITION) -> None:
        self.circulation, self._p, self._m = Circulation(rows), p, len(rows)

    def cycle(self, nearest: Nearest, velocity: Array | None = None, xdot: Array = FORWARD) -> Array:
        moving = np.zeros(self._m) if velocity is None else velocity
        return self.circulation.change(xdot, np.eye(self._m), moving, nearest, ON, self._p)

    def stick(self, nearest: Nearest = WALL, xdot: Array = FORWARD) -> Array:
        """Stand in front of an obstacle until the tool counts as stuck."""
        for _ in range(100):
            told = self.cycle(nearest, xdot=xdot)
            if self.circulation.circulating:
                return told
        raise AssertionError("never stuck")


def changed(p: Parameters, **values: Any) -> Parameters:
    """Other values."""
    return replace(p, **values)


def test_a_free_tool_is_left_alone(p: Parameters) -> None:
    tool = Tool(p)
    for nearest, velocity, xdot in (
        (NOTHING, np.zeros(3), FORWARD),
        (WALL, 0.3 * FORWARD, FORWARD),
        (WALL, np.zeros(3), 0.05 * FORWARD),
        (facing([1.0, 0.0, 0.0], distance=0.31), np.zeros(3), FORWARD),
    ):
        for _ in range(60):
            np.testing.assert_array_equal(tool.cycle(nearest, velocity, xdot), xdot)
    assert not tool.circulation.circulating


def test_it_is_stuck_after_the_stall_time(p: Parameters) -> None:
    """0.5 s at 50 Hz: in the 25th cycle; what progress there was counts against it."""
    tool = Tool(p)
    found = [bool(tool.cycle(WALL) is not None and tool.circulation.circulating) for _ in range(25)]
    assert found == [False] * 24 + [True]
    tool = Tool(p)
    for _ in range(20):
        tool.cycle(WALL)
    for _ in range(5):
        tool.cycle(WALL, FORWARD)
    found = [bool(tool.cycle(WALL) is not None and tool.circulation.circulating) for _ in range(10)]
    assert found == [False] * 9 + [True]


def test_the_task_velocity_changes_over_in_the_blend_time(p: Parameters) -> None:
    """Fifths in 0.1 s, from the task's velocity to 0.2 m/s along the tangent; upwards at a wall."""
    tool, up = Tool(p), np.array([0.0, 0.0, 0.2])
    told = [tool.stick(), *[tool.cycle(WALL, up) for _ in range(5)]]
    np.testing.assert_allclose(tool.circulation.tangent, [0.0, 0.0, 1.0], atol=1e-12)
    for index, velocity in enumerate(told):
        share = min(0.2 * (index + 1), 1.0)
        np.testing.assert_allclose(velocity, (1.0 - share) * FORWARD + share * up, atol=1e-12)


def test_it_goes_where_the_task_leans_and_others_are_not(p: Parameters) -> None:
    def chosen(nearest: Nearest, xdot: Array) -> Array:
        tool = Tool(p)
        tool.stick(nearest, xdot)
        return tool.circulation.tangent

    leaning = np.array([0.2, 0.15, 0.0])
    assert chosen(WALL, leaning)[1] > 0.6
    assert chosen(WALL, leaning)[2] > 0.5
    ceiling = chosen(facing([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), FORWARD)
    assert ceiling[2] < 1e-12
    corner = chosen(facing([1.0, 0.0, 0.0], [0.0, 1.0, 0.2]), FORWARD)
    assert corner[1] < -0.1 and corner[2] > 0.5


def test_of_equal_ways_the_first_is_taken(p: Parameters) -> None:
    """Without a bias a wall has no preferred tangent: the first candidate, along the basis."""
    flat = changed(p, circulation_bias_z=0.0)
    tool = Tool(flat)
    tool.stick()
    np.testing.assert_allclose(tool.circulation.tangent, [0.0, 1.0, 0.0], atol=1e-12)


def test_the_tangent_follows_the_surface(p: Parameters) -> None:
    """Over an edge: as the obstacle turns from ahead to below, upwards becomes forwards."""
    tool = Tool(p)
    tool.stick(xdot=np.array([0.25, 0.0, -0.1]))
    for angle in np.radians(np.arange(0.0, 71.0, 5.0)):
        below = facing([np.cos(angle), 0.0, -np.sin(angle)], [])
        tool.cycle(below, np.array([0.0, 0.0, 0.2]), xdot=np.array([0.05, 0.0, -0.25]))
        if not tool.circulation.circulating:
            break
        expected = [np.sin(angle), 0.0, np.cos(angle)]
        np.testing.assert_allclose(tool.circulation.tangent, expected, atol=1e-12)
    assert angle > np.radians(60.0)


@pytest.mark.parametrize(
    ("nearest", "xdot"),
    [
        (NOTHING, FORWARD),
        (WALL, np.array([0.0, -0.25, 0.0])),
        (WALL, np.array([0.15, 0.0, 0.2])),
        (WALL, 0.05 * FORWARD),
    ],
    ids=["nothing near", "past it", "along it", "no motion wanted"],
)
def test_the_way_is_clear_after_the_release_time(p: Parameters, nearest: Nearest, xdot: Array) -> None:
    """0.2 s: in the tenth clear cycle; a blocked one begins the count anew. Then the task is blended in."""
    tool, up = Tool(p), np.array([0.0, 0.0, 0.2])
    tool.stick()
    for _ in range(9):
        tool.cycle(nearest, up, xdot)
    tool.cycle(WALL, up)
    circulating = []
    for _ in range(10):
        tool.cycle(nearest, up, xdot)
        circulating.append(tool.circulation.circulating)
    assert circulating == [True] * 9 + [False]
    for _ in range(5):
        told = tool.cycle(nearest, xdot, xdot)
    np.testing.assert_allclose(told, xdot, atol=1e-12)


def test_without_progress_another_way_round_is_tried(p: Parameters) -> None:
    """The arm cannot go up: after 1 s it goes down, which is the least like it."""
    tool = Tool(p)
    tool.stick()
    turned = 0
    for _ in range(50):
        assert tool.circulation.tangent[2] == pytest.approx(1.0)
        tool.cycle(WALL)
        turned += 1
        if tool.circulation.tangent[2] < 0.0:
            break
    assert turned == 50
    np.testing.assert_allclose(tool.circulation.tangent, [0.0, 0.0, -1.0], atol=1e-12)
    assert tool.circulation.circulating


def test_it_ends_after_the_time_limit(p: Parameters) -> None:
    tool = Tool(changed(p, circulation_time_limit=3.0))
    tool.stick()
    cycles = 0
    while tool.circulation.circulating:
        tool.cycle(WALL, 0.2 * tool.circulation.tangent)
        cycles += 1
    assert cycles == pytest.approx(151, abs=1)


def test_soon_after_the_last_tangent_is_preferred(p: Parameters) -> None:
    """A way round that the bias alone would not choose is taken again within 3 s, and not later."""
    sideways, after = [], []
    for pause in (1.0, 4.0):
        tool = Tool(p)
        tool.stick(facing([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]))
        sideways.append(tool.circulation.tangent.copy())
        for _ in range(round(pause / 0.02)):
            tool.cycle(NOTHING, FORWARD)
        tool.stick(facing([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], distance=0.28))
        after.append(tool.circulation.tangent.copy())
    np.testing.assert_array_equal(sideways[0], after[0])
    flat = changed(p, circulation_bias_z=0.05)
    tool = Tool(flat)
    tool.circulation.tangent, tool.circulation._since = np.array([0.0, -1.0, 0.0]), 0.0
    tool.stick()
    assert tool.circulation.tangent[1] < -0.9
    tool = Tool(flat)
    tool.circulation.tangent, tool.circulation._since = np.array([0.0, -1.0, 0.0]), 3.0
    tool.stick()
    assert tool.circulation.tangent[2] > 0.9


def test_times_of_whole_cycles_last_so_many_cycles(p: Parameters) -> None:
    """Eight times 0.1 s, which add up to a little less than 0.8 s."""
    tenths = changed(p, period=0.1, stall_time=0.8, circulation_release_time=0.8, circulation_patience=0.8)
    tool = Tool(tenths)
    found = [bool(tool.cycle(WALL) is not None and tool.circulation.circulating) for _ in range(8)]
    assert found == [False] * 7 + [True]
    ways = [float(tool.circulation.tangent[2]) for _ in range(8) if tool.cycle(WALL) is not None]
    np.testing.assert_allclose(ways, [1.0] * 7 + [-1.0], atol=1e-12)
    clear = [bool(tool.cycle(NOTHING) is not None and tool.circulation.circulating) for _ in range(8)]
    assert clear == [True] * 7 + [False]


def test_at_its_time_limit_it_goes_on(p: Parameters) -> None:
    """Beyond it no more; 0.125 s and 1 s are not rounded."""
    tool = Tool(changed(p, period=0.125, circulation_patience=100.0, circulation_time_limit=1.0))
    tool.stick()
    found = [bool(tool.cycle(WALL) is not None and tool.circulation.circulating) for _ in range(9)]
    assert found == [True] * 8 + [False]


def test_progress_counts_against_failing(p: Parameters) -> None:
    """30 cycles without, 10 with, 30 without: 50."""
    tool = Tool(p)
    tool.stick()
    for count, velocity in ((30, np.zeros(3)), (10, np.array([0.0, 0.0, 0.1])), (29, np.zeros(3))):
        for _ in range(count):
            tool.cycle(WALL, velocity)
        assert tool.circulation.tangent[2] == pytest.approx(1.0)
    tool.cycle(WALL)
    assert tool.circulation.tangent[2] == pytest.approx(-1.0)


def test_another_way_round_is_along_the_surface(p: Parameters) -> None:
    """Of the normal, wherever the task points."""
    tool = Tool(p)
    tool.stick()
    for _ in range(50):
        tool.cycle(facing([0.8, 0.0, 0.6], []))
    np.testing.assert_allclose(tool.circulation.tangent, [0.6, 0.0, -0.8], atol=1e-12)


@pytest.mark.parametrize(
    ("bias", "since", "way"),
    [
        (1.9, None, -1.0),
        (2.1, None, 1.0),
        (0.4, 0.0, -1.0),
        (0.6, 0.0, 1.0),
        (0.4, 2.48, -1.0),
        (0.4, 2.5, 1.0),
    ],
)
def test_weights_of_the_present_way(p: Parameters, bias: float, since: float | None, way: float) -> None:
    """-2 against a way that failed, ½ for one that was released within 3 s; the bias is for z."""
    leaning = changed(p, circulation_bias_z=bias)
    tool = Tool(leaning, ("x", "z"))
    if since is None:
        tool.stick(WALL, np.array([0.25, 0.0]))
        for _ in range(50):
            tool.cycle(WALL, xdot=np.array([0.25, 0.0]))
    else:
        tool.circulation.tangent, tool.circulation._since = np.array([0.0, 0.0, -1.0]), since
        tool.stick(WALL, np.array([0.25, 0.0]))
    assert tool.circulation.tangent[2] == pytest.approx(way)


@pytest.mark.parametrize(("bias", "way"), [(0.57, -1.0), (0.585, 1.0)])
def test_weight_of_another_obstacle(p: Parameters, bias: float, way: float) -> None:
    """One above at 0.26 m weighs 0.30/0.26 = 1.154, and the bias twice: up instead of down."""
    tool = Tool(changed(p, circulation_bias_z=bias), ("x", "z"))
    tool.stick(facing([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), np.array([0.25, 0.0]))
    assert tool.circulation.tangent[2] == pytest.approx(way)


def test_a_planar_task_goes_round_in_its_plane(p: Parameters) -> None:
    """Candidates out of the plane are left out, although the bias points there."""
    tool = Tool(p, ("x", "y"))
    told = tool.stick(WALL, np.array([0.25, 0.01]))
    assert told.shape == (2,)
    np.testing.assert_allclose(tool.circulation.tangent, [0.0, 1.0, 0.0], atol=1e-12)
    floor = Tool(p, ("x", "y"))
    floor.stick(facing([0.6, 0.0, -0.8], []), np.array([0.25, 0.0]))
    assert abs(floor.circulation.tangent[2]) == 0.0
    assert np.linalg.norm(floor.circulation.tangent) == pytest.approx(1.0)


def test_other_rows_of_the_task_are_not_changed(p: Parameters) -> None:
    tool = Tool(p, ("x", "y", "z", "rx", "ry", "rz"))
    xdot = np.array([0.25, 0.0, 0.0, 0.1, -0.2, 0.3])
    told = tool.stick(WALL, xdot)
    np.testing.assert_array_equal(told[3:], xdot[3:])
    assert told[2] > 0.0


def test_a_task_without_a_linear_row_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="the task has none of these rows"):
        variant(tmp_path, CIRCULATION + "task: {kind: pose, rows: [rx, ry]}\n")


def test_a_reset_forgets_it_and_a_fault_does_not(controller: ReferenceController) -> None:
    """Stuck in front of a point beside the hand: the diagnostics say so, and g has the changed velocity."""
    model, q = controller.model, np.array([0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0])
    controller.reset()
    controller.set_parameters(qdot_limit=np.full(7, 1e-6))
    try:
        point = tool_pose(model, q)[:3, 3] + [[0.2, 0.0, 0.0]]
        for cycle in range(30):
            command = controller.step(q, FORWARD, silence(model, 0.02 * cycle, point))
        assert command.diagnostics.circulating
        changed_g = command.diagnostics.g
        broken = silence(model, 0.62, np.array([[np.nan, 0.0, 0.0]]))
        assert controller.step(q, FORWARD, broken).status is Status.FAULT_NOT_FINITE
        again = controller.step(q, FORWARD, silence(model, 0.64, point)).diagnostics
        assert again.circulating
        np.testing.assert_allclose(again.g, changed_g, rtol=0, atol=1e-6)
        controller.reset()
        fresh = controller.step(q, FORWARD, silence(model, 0.0, point)).diagnostics
        assert not fresh.circulating and not fresh.tangent.any()
        assert np.abs(fresh.g - changed_g).max() > 0.01
    finally:
        controller.set_parameters(qdot_limit=model.qdot_limit)


def test_the_local_minimum_is_left(tmp_path: Path) -> None:
    """In `facing` the arm stops after the first target; with circulation it goes over the pillar."""
    reached = {}
    for enabled in ("false", "true"):
        text = f"avoidance: {{schedule: damper, circulation: {{enabled: {enabled}}}}}\n"
        text += "relaxation: {mode: slack}\n"
        config, model = variant(tmp_path, text)
        log = run(
            config,
            model,
            ReferenceController(config, model),
            load_scene("facing"),
            sensing="ideal",
            duration=16.0,
        )
        reached[enabled] = int(log.targets_reached[-1])
        assert log.true_axis_distance.min() > 0.17
        assert not log.outside_limits().any()
    assert reached["false"] == 1
    assert reached["true"] >= 2
