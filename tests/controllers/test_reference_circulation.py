"""Circulation: when the tool counts as stuck, which way round it goes, when the way is clear again."""

from pathlib import Path

import numpy as np
import pytest
from circulation_tools import CIRCULATION, FORWARD, NOTHING, WALL, Tool, changed, facing
from reference_tools import silence, variant

from proxgen.config.scene import load_scene
from proxgen.controllers.protocol import Array, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.avoidance import Nearest
from proxgen.controllers.reference.parameters import Parameters
from proxgen.errors import ConfigError
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.rollout import run


@pytest.fixture(scope="module")
def controller(tmp_path_factory: pytest.TempPathFactory) -> ReferenceController:
    return ReferenceController(*variant(tmp_path_factory.mktemp("circulation"), CIRCULATION))


@pytest.fixture(scope="module")
def p(controller: ReferenceController) -> Parameters:
    return controller._parameters


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
