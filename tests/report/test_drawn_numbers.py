"""Lines, marks and cells of the report are the numbers of the log: which one, of which link, in what unit."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import make_comparison, make_log
from matplotlib.axes import Axes
from numpy.typing import NDArray

from proxgen.compare import Tolerances
from proxgen.report.agreement import agreement_figure, agreement_table, verdict
from proxgen.report.course import course_figure
from proxgen.report.joints import joints_figure
from proxgen.report.links import links_figure
from proxgen.report.numerics import numerics_figure, timing_figure
from proxgen.report.tables import cards, summary_table

Array = NDArray[np.float64]


def drawn(axes: Axes, index: int = 0) -> tuple[Array, Array]:
    """Data of a line of more than two points, or marks."""
    lines = [line for line in axes.lines if len(np.atleast_1d(line.get_xdata())) != 2]
    line = lines[index]
    return np.asarray(line.get_xdata(), dtype=float), np.asarray(line.get_ydata(), dtype=float)


def levels(axes: Axes) -> list[float]:
    """Heights of the horizontal lines."""
    heights = [np.unique(np.asarray(line.get_ydata())) for line in axes.lines if len(line.get_ydata()) == 2]  # type: ignore[arg-type]
    return sorted(float(each[0]) for each in heights if each.size == 1)


def test_cells_of_the_summary() -> None:
    log = make_log(cycles=100)
    axis = np.full((100, 2), 0.5)
    axis[:25, 1] = 0.1234
    log = replace(
        log, true_axis_distance=axis, true_surface_distance=axis - 0.2, cycle_us=np.arange(1.0, 101.0)
    )
    cells = {row.key: row.cells[0] for row in summary_table([log])}
    assert cells["time_below_dr_fraction"] == "25.0 %"
    assert cells["min_distance_axis_m"] == "0.123 m"
    assert cells["min_distance_surface_m"] == "-0.077 m"
    assert cells["penetration_samples"] == "25"
    assert cells["duration_s"] == "2 s"
    assert [cells[f"cycle_us.{name}"] for name in ("p50", "p99", "max")] == ["50.5 µs", "99.0 µs", "100 µs"]
    good = {row.key: row.good[0] for row in summary_table([log])}
    assert good["penetration_samples"] is False and good["solver_failures"] is True
    (card,) = cards([log])
    assert [number for number, _ in card.numbers] == ["1", "0.123 m", "25.0 %", "0", "25", "50.5 µs"]


def test_every_link_has_its_own_panel() -> None:
    log = make_log(capsules=3)
    panels = links_figure(log).axes
    assert [axes.get_title() for axes in panels] == ["link 0", "link 1", "link 2"]
    for index, axes in enumerate(panels):
        time, true = drawn(axes)
        np.testing.assert_array_equal(time, log.time)
        np.testing.assert_array_equal(true, log.true_axis_distance[:, index])
        seen, there = log.controller_distance[:, index], np.isfinite(log.controller_distance[:, index])
        np.testing.assert_array_equal(drawn(axes, 1)[1], np.where(there, seen, np.nan))
        assert levels(axes) == [0.17, 0.22, 0.25, 0.3]


def test_every_joint_has_its_position_velocity_and_limits() -> None:
    log = make_log(joints=3, q_lower=[-2.0, -2.1, -2.2], q_upper=[1.0, 1.1, 1.2], qdot_limit=[1.5, 1.6, 1.7])
    panels = np.array(joints_figure(log).axes).reshape(3, 2)
    for index, (position, velocity) in enumerate(panels):
        np.testing.assert_array_equal(drawn(position)[1], log.q[:, index])
        np.testing.assert_array_equal(drawn(velocity)[1], log.qdot[:, index])
        assert levels(position) == [-2.0 - 0.1 * index, 1.0 + 0.1 * index]
        assert levels(velocity) == [-1.5 - 0.1 * index, 1.5 + 0.1 * index]
        beyond = 0.12 * (3.0 + 0.2 * index)  # what is shown, and shaded, beyond the limits
        shown = -2.0 - 0.1 * index - beyond, 1.0 + 0.1 * index + beyond
        assert position.get_ylim() == pytest.approx(shown)


def test_the_course_shows_targets_distances_and_statuses() -> None:
    log = make_log(distance_reference="surface")
    sawtooth, nearest, strip = course_figure(log, tolerance=0.02).axes
    np.testing.assert_array_equal(drawn(sawtooth)[1], log.target_distance)
    times, distances = drawn(sawtooth, 1)  # the last cycles before the target is another one
    np.testing.assert_array_equal(times, log.time[[49, 99, 149]])
    np.testing.assert_array_equal(distances, log.target_distance[[49, 99, 149]])
    assert levels(sawtooth) == [0.02]
    np.testing.assert_array_equal(drawn(nearest)[1], log.true_surface_distance.min(axis=1))
    assert levels(nearest) == [0.17, 0.22, 0.25, 0.3]
    widths = [patch.get_width() for patch in strip.patches]  # type: ignore[attr-defined]
    widths += [
        extents.x1 - extents.x0
        for c in strip.collections
        for extents in (p.get_extents() for p in c.get_paths())
    ]
    assert sum(widths) == pytest.approx(4.0, abs=0.05)


def test_numerics_are_those_of_the_log() -> None:
    log = make_log()
    log = replace(log, manipulability=np.linspace(0.1, 0.2, 200), damping=np.linspace(1e-3, 1e-2, 200))
    panels = numerics_figure(log, tolerance=1e-8).axes
    for axes, values in zip(panels, (log.manipulability, log.damping, log.kkt_residual), strict=True):
        np.testing.assert_array_equal(drawn(axes)[1], np.maximum(values, 1e-18))
    assert levels(panels[2]) == [1e-8]


def test_percentiles_of_the_cycle_times() -> None:
    log = replace(make_log(cycles=1001), cycle_us=np.arange(1000.0, 2001.0))
    (axes,) = timing_figure([log]).axes
    at = sorted({float(np.asarray(line.get_xdata())[0]) for line in axes.lines})
    assert at == pytest.approx([1500.0, 1990.0, 1999.0])


def test_agreement_is_drawn_and_judged_by_its_tolerances() -> None:
    comparison = make_comparison(qdot_error=3e-9)
    greatest, course = agreement_figure(comparison).axes
    marks = [np.asarray(line.get_xdata()) for line in greatest.lines if len(line.get_xdata()) > 2]  # type: ignore[arg-type]
    bars = [float(np.asarray(line.get_xdata())[0]) for line in greatest.lines if len(line.get_xdata()) == 2]  # type: ignore[arg-type]
    assert [float(each[0]) for each in marks] == [1e-18, 3e-9]
    names = [label.get_text().split(" [")[0] for label in greatest.get_yticklabels()]
    assert dict(zip(names, bars, strict=True)) == dict.fromkeys(names, 1e-10) | {
        "velocity q̇": 1e-8, "slack": 1e-8, "KKT residual": 1e-8, "outside the bounds": 1e-8,
    }  # fmt: skip
    np.testing.assert_array_equal(drawn(course, 1)[1], np.full(100, 3e-9))
    assert levels(course) == [1e-8]
    rows = {row.key: row for row in agreement_table(comparison)}
    assert rows["max_abs_qdot_error"].cells == ["0 rad/s", "3e-09 rad/s"]
    assert rows["max_abs_qdot_error"].good == [True, True]
    assert rows["max_abs_H_error"].good == rows["max_abs_A_error"].good == [True, False]
    assert rows["max_kkt_residual"].good == [True, True]
    wide = replace(comparison, tolerances=Tolerances(qdot=1e-10, kkt=2e-9))
    narrow = {row.key: row for row in agreement_table(wide)}
    for key, limit in (("qdot_error", "1e-10"), ("H_error", "1e-10"), ("A_error", "1e-10")):
        assert f"(at most {limit})" in narrow[f"max_abs_{key}"].title
    assert "(at most 2e-09)" in narrow["max_kkt_residual"].title
    assert narrow["max_abs_qdot_error"].good == narrow["max_kkt_residual"].good == [True, False]
    assert "velocities to 3e-09 rad/s" in verdict(replace(comparison)).sentence
