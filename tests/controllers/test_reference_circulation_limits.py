"""Circulation to the cycle, to 1e-9, and with each of its weights: where it begins to do something else."""

from pathlib import Path

import numpy as np
import pytest
from circulation_tools import CIRCULATION, NOTHING, WALL, Tool, changed, facing
from reference_tools import silence, variant

from proxgen.controllers.reference import ReferenceController
from proxgen.controllers.reference.parameters import Parameters


@pytest.fixture(scope="module")
def p(tmp_path_factory: pytest.TempPathFactory) -> Parameters:
    config, model = variant(tmp_path_factory.mktemp("circulation"), CIRCULATION)
    return ReferenceController(config, model)._parameters


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


def test_what_asks_for_no_motion_is_not_stuck(p: Parameters) -> None:
    """Up to 0.02 m/s, to 1e-9 m/s."""
    for speed, stuck in ((0.02 + 5e-10, False), (0.02 + 2e-9, True)):
        tool = Tool(p)
        for _ in range(25):
            tool.cycle(WALL, xdot=np.array([speed, 0.0, 0.0]))
        assert tool.circulation.circulating is stuck


@pytest.mark.parametrize(
    ("towards", "along", "clear"),
    [
        (0.2 - 2e-9, -1.0, True),
        (0.2 - 5e-10, -1.0, False),
        (np.sqrt(0.75) - 2e-9, 1.0, True),
        (np.sqrt(0.75), 1.0, False),
    ],
)
def test_the_way_is_clear(p: Parameters, towards: float, along: float, clear: bool) -> None:
    """It points at the obstacle by less than 0.2, or goes with the tangent, here z, by more than 0.5."""
    tool = Tool(p, ("x", "z"))
    tool.stick(WALL, np.array([0.25, 0.0]))
    way = np.array([towards, along * np.sqrt(1.0 - towards**2)])
    for _ in range(10):
        tool.cycle(WALL, np.array([0.0, 0.2]), 0.2 * way)
    assert tool.circulation.circulating is not clear


@pytest.mark.parametrize(("part", "follows"), [(0.1, False), (0.101, True)])
def test_a_tangent_that_would_be_short_on_the_surface_stays(
    p: Parameters, part: float, follows: bool
) -> None:
    tool = Tool(p)
    tool.stick()
    tool.cycle(facing([part, 0.0, np.sqrt(1.0 - part**2)], []))
    expected = [-np.sqrt(1.0 - part**2), 0.0, part] if follows else [0.0, 0.0, 1.0]
    np.testing.assert_allclose(tool.circulation.tangent, expected, atol=1e-12)


def test_candidates_that_lie_mostly_in_rows_that_the_task_lacks_are_left_out(p: Parameters) -> None:
    """With x and y alone, (0.2, 0) would point where the task does, but is all that is left of a tangent."""
    tool = Tool(p, ("x", "y"))
    tool.stick(facing([0.98, 0.0, np.sqrt(1.0 - 0.98**2)], []), np.array([0.25, 0.0]))
    height = np.sqrt(1.0 - 0.98**2)
    expected = np.array([height * np.sin(np.pi / 3.0), -0.5, 0.0])
    np.testing.assert_allclose(tool.circulation.tangent, expected / np.linalg.norm(expected), atol=1e-9)


def test_no_obstacle_weighs_as_if_it_were_inside(p: Parameters) -> None:
    """The one above is 0.010 m away and weighs 30, against twice the bias; at 0.1 m it would weigh 3."""
    tool = Tool(changed(p, circulation_bias_z=2.0), ("x", "z"))
    tool.stick(facing([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], distance=5e-5), np.array([0.25, 0.0]))
    assert tool.circulation.tangent[2] == pytest.approx(-1.0)


def test_the_task_comes_back_in_the_blend_time(p: Parameters) -> None:
    """0.1 s, five cycles, of which the cycle of the release is the first."""
    tool = Tool(p)
    tool.stick()
    for _ in range(9):
        tool.cycle(NOTHING)
    for blend in (0.8, 0.6, 0.4, 0.2, 0.0):
        told = tool.cycle(NOTHING)
        np.testing.assert_allclose(told, [(1.0 - blend) * 0.25, 0.0, blend * 0.2], atol=1e-12)


@pytest.mark.parametrize(("bias", "way"), [(0.57, -1.0), (0.585, 1.0)])
def test_weight_of_another_obstacle(p: Parameters, bias: float, way: float) -> None:
    """One above at 0.26 m weighs 0.30/0.26 = 1.154, and the bias twice: up instead of down."""
    tool = Tool(changed(p, circulation_bias_z=bias), ("x", "z"))
    tool.stick(facing([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), np.array([0.25, 0.0]))
    assert tool.circulation.tangent[2] == pytest.approx(way)


@pytest.mark.parametrize(("distance", "stuck"), [(0.14, True), (0.16, False)])
def test_only_what_has_a_row_is_near(tmp_path: Path, distance: float, stuck: bool) -> None:
    """Within d_a = 0.15 m; what is further away counts for the active row alone, here up to 0.3 m."""
    controller = ReferenceController(*variant(tmp_path, CIRCULATION, "planar2"))
    controller.set_parameters(d_active=0.3, damper_influence=0.4)
    q = np.zeros(2)  # the tool is at (0.9, 0, 0.1)
    for index in range(30):
        seen = silence(controller.model, 0.02 * index, np.array([0.9 + distance, 0.0, 0.1]))
        command = controller.step(q, np.array([0.1, 0.0]), seen)
    assert np.isfinite(command.diagnostics.distance).any()
    assert command.diagnostics.circulating is stuck
