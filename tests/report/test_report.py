"""The page: complete, self-contained, honest; and every figure for arms of any size."""

import base64
import io
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from made_up import ROD, make_arm_log, make_comparison, make_log
from matplotlib.image import imread

from proxgen.config.schema import Config
from proxgen.model import RobotModel
from proxgen.report import side_by_side, style, write_report
from proxgen.report.agreement import agreement_figure, verdict
from proxgen.report.course import course_figure, status_legend
from proxgen.report.joints import joints_figure
from proxgen.report.links import links_figure
from proxgen.report.numerics import numerics_figure, timing_figure
from proxgen.report.page import Gallery
from proxgen.report.path import path_figure
from proxgen.report.side_by_side import side_by_side_figure
from proxgen.report.stills import stills_figure
from proxgen.report.tables import summary_table

pytestmark = pytest.mark.usefixtures("coarse")


def pictures(page: str) -> list[bytes]:
    """The pictures inside a page."""
    return [base64.b64decode(data) for data in re.findall(r'src="data:image/png;base64,([^"]+)"', page)]


def test_page_is_complete_and_needs_nothing_else(tmp_path: Path) -> None:
    path = write_report(tmp_path / "report", [make_log(), make_log(scene="other")])
    page = path.read_text(encoding="utf-8")
    assert path == tmp_path / "report" / "index.html"
    assert not re.search(r"https?://|<script|@import|url\(", page)
    shown = pictures(page)
    linked = re.findall(r'href="(figures/[^"]+)"', page)
    assert len(shown) == len(linked) == 12  # 5 per run, side by side, timing
    for data, name in zip(shown, linked, strict=True):
        assert (path.parent / name).read_bytes() == data
        assert imread(io.BytesIO(data)).std() > 0.0
    assert not [file for file in path.parent.rglob("*") if file.name.endswith(".part")]


def test_every_number_of_the_json_file_is_in_the_table() -> None:
    log = make_log()
    keys = {row.key for row in summary_table([log])}
    for name, value in log.summary().items():
        expected = {f"{name}.{inner}" for inner in value} if isinstance(value, dict) else {name}
        assert expected <= keys | {"scene"}


def test_numbers_stand_in_the_column_of_their_run() -> None:
    rows = {row.key: row for row in summary_table([make_log(cycles=120), make_log(cycles=200)])}
    assert rows["cycles"].cells == ["120", "200"]
    assert rows["targets_reached"].cells == ["2", "3"]
    assert rows["cycle_us.max"].cells == ["7.00 µs", "7.00 µs"]
    assert rows["status_counts.STOPPED_INFEASIBLE"].cells == ["1", "1"]


def test_penetration_is_marked_as_bad() -> None:
    log = make_log()
    log = replace(log, true_surface_distance=log.true_surface_distance - 0.1)
    (row,) = [row for row in summary_table([log]) if row.key == "penetration_samples"]
    assert row.good == [False]
    assert int(row.cells[0]) > 0


def test_passing_comparison(tmp_path: Path) -> None:
    page = write_report(tmp_path, [make_log()], make_comparison()).read_text(encoding="utf-8")
    assert '<p class="verdict pass">' in page
    assert "agree in all 200 cycles (first, second)" in page
    assert "1e-13 rad/s" in page
    assert 'class="number bad"' not in page


def test_failing_comparison_says_so_and_why(tmp_path: Path) -> None:
    comparison = make_comparison(qdot_error=1e-3, mismatches=4)
    page = write_report(tmp_path, [make_log()], comparison).read_text(encoding="utf-8")
    assert '<p class="verdict fail">' in page
    assert "5 findings in 200 cycles" in page
    assert "second, cycle 3: qdot &lt;differs&gt;" in page  # escaped: findings are text
    assert page.count('class="number bad"') == 5  # velocity, H, A, residual, statuses of the second scene


def test_an_infinite_error_is_drawn_too(tmp_path: Path) -> None:
    comparison = make_comparison(qdot_error=np.inf)
    with style.house_style():
        figure = agreement_figure(comparison)
        style.save(figure, tmp_path / "agreement.png")
    assert max(np.max(np.asarray(line.get_xdata())) for line in figure.axes[0].lines) == 1e3
    assert not verdict(comparison).passed


@pytest.mark.parametrize(("joints", "capsules"), [(2, 1), (7, 3), (12, 9)])
def test_figures_for_arms_of_any_size(tmp_path: Path, joints: int, capsules: int) -> None:
    log = make_log(joints=joints, capsules=capsules)
    with style.house_style():
        assert len(joints_figure(log).axes) == 2 * joints
        assert len(links_figure(log).axes) == capsules
        assert imread(style.save(joints_figure(log), tmp_path / "joints.png")).shape[1] == round(
            40 * style.WIDTH
        )


def test_unlimited_joints_have_no_limit_lines() -> None:
    log = make_log(joints=2, q_lower=[-1e20, -2.0], q_upper=[1e20, 2.0])
    free, limited = joints_figure(log).axes[0], joints_figure(log).axes[2]
    assert len(free.lines) == 1
    assert len(limited.lines) == 3
    assert max(map(abs, free.get_ylim())) < 10.0


@pytest.mark.parametrize("cycles", [1, 2])
def test_shortest_runs(tmp_path: Path, cycles: int) -> None:
    write_report(tmp_path, [make_log(cycles=cycles)])
    assert len(list((tmp_path / "figures").glob("*.png"))) == 6


def test_run_without_an_obstacle(tmp_path: Path) -> None:
    log = make_log(obstacles=[])
    nothing = np.full_like(log.true_axis_distance, np.inf)
    log = replace(log, true_axis_distance=nothing, true_surface_distance=nothing, controller_distance=nothing)
    page = write_report(tmp_path, [log]).read_text(encoding="utf-8")
    assert "inf" not in re.sub(r'src="[^"]+"|INFEASIBLE', "", page)


def test_unsolved_cycles_leave_a_gap() -> None:
    log = make_log()
    log = replace(log, kkt_residual=np.where(np.arange(log.cycles) < 100, np.nan, 1e-15))
    residual = numerics_figure(log, 1e-8).axes[2].lines[0].get_ydata()
    assert np.isnan(np.asarray(residual)[:100]).all()


def test_every_shape_of_obstacle_is_drawn(tmp_path: Path) -> None:
    log = make_log()
    with style.house_style():
        bare = path_figure(replace(log, meta=log.meta | {"obstacles": []}))
        full = path_figure(replace(log, meta=log.meta | {"obstacles": [*log.meta["obstacles"], ROD]}))
        assert len(bare.axes[0].patches) == 0
        assert len(full.axes[0].patches) == 4  # box, rod, and the ball at both ends of its way
        style.save(full, tmp_path / "path.png")


def test_views_are_to_one_scale() -> None:
    figure = path_figure(make_log())
    figure.draw_without_rendering()
    front, side, top, _ = figure.axes
    scales = []
    for axes in (front, side, top):
        box, (left, right), (bottom, up) = axes.bbox, axes.get_xlim(), axes.get_ylim()
        scales += [box.width / abs(right - left), box.height / abs(up - bottom)]
    assert scales == pytest.approx([scales[0]] * 6, rel=0.02)


def test_side_by_side_has_one_column_per_run() -> None:
    figure = side_by_side_figure([make_log(), make_log(controller="reference"), make_log(sensing="ideal")])
    assert len(figure.axes) == 12
    assert {axes.get_ylim() for axes in figure.axes[:3]} == {figure.axes[0].get_ylim()}


def test_runs_beyond_a_row_get_a_second_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(side_by_side, "MOST_COLUMNS", 1)
    write_report(tmp_path, [make_log(cycles=20), make_log(cycles=20)])
    assert len(list((tmp_path / "figures").glob("side_by_side*.png"))) == 2


def test_percentiles_stand_in_the_histogram() -> None:
    axes = timing_figure([make_log()]).axes[0]
    assert [text.get_text().split()[0] for text in axes.texts] == ["p50", "p99", "p99.9"]


def test_a_single_cycle_is_not_nothing_and_all_others_are_not_all() -> None:
    rare, common = make_log(cycles=3000), make_log(cycles=200)
    texts = [[entry.get_label() for entry in status_legend(log)] for log in (rare, common)]
    assert texts[0] == ["SOLVED  2999 (> 99.9 %)", "STOPPED_INFEASIBLE  1 (< 0.1 %)"]
    assert texts[1] == ["SOLVED  199 (99.5 %)", "STOPPED_INFEASIBLE  1 (0.5 %)"]


def test_rare_statuses_stay_visible() -> None:
    log = make_log(cycles=20000)
    strip = course_figure(log).axes[2]
    seconds = [path.get_extents().width for part in strip.collections for path in part.get_paths()]
    assert min(seconds) >= 400.0 / 701.0


def test_the_same_figure_gives_the_same_bytes(tmp_path: Path) -> None:
    with style.house_style():
        first = style.save(course_figure(make_log()), tmp_path / "first.png")
        second = style.save(course_figure(make_log()), tmp_path / "second.png")
    assert first.read_bytes() == second.read_bytes()


def test_labels_at_the_right_do_not_overlap() -> None:
    figure = course_figure(make_log(thresholds={"d_a": 0.3, "d_0u": 0.222, "d_0l": 0.221, "d_r": 0.22}))
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[1].texts]
    assert len(boxes) == 4
    assert all(upper.y0 >= lower.y1 - 1.0 for upper, lower in pairwise(boxes))


def test_zones_are_those_of_the_law_in_force() -> None:
    damper = {
        "d_a": 0.3,
        "d_0u": 0.25,
        "d_0l": 0.22,
        "d_r": 0.17,
        "damper_influence": 0.4,
        "damper_safety": 0.2,
    }
    paper, other = course_figure(make_log()), course_figure(make_log(schedule="damper", thresholds=damper))
    assert [text.get_text().split()[1] for text in paper.axes[1].texts] == ["0.30", "0.25", "0.22", "0.17"]
    assert [text.get_text().split()[1] for text in other.axes[1].texts] == ["0.40", "0.20"]


def test_figures_have_different_names(tmp_path: Path) -> None:
    gallery = Gallery(tmp_path)
    gallery.add("one", "One", "", lambda: course_figure(make_log(cycles=5)))
    with pytest.raises(ValueError, match="two figures called 'one'"):
        gallery.add("one", "Two", "", lambda: course_figure(make_log(cycles=5)))


def test_arm_is_drawn_and_rendered_where_the_configuration_is_known(
    tmp_path: Path, planar2_config: Config, planar2_model: RobotModel
) -> None:
    log = make_arm_log(planar2_model, 120)
    page = write_report(tmp_path, [log], config=planar2_config).read_text(encoding="utf-8")
    assert len(pictures(page)) == 7
    assert "The arm on one way between two targets" in page
    with style.house_style():
        stills = stills_figure(log, planar2_model).axes
        assert len(stills) == 4
        assert all(np.asarray(axes.images[0].get_array()).std() > 1.0 for axes in stills)
