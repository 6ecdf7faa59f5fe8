"""The report of runs and of a comparison: which figures there are, what they say, in which order."""

import platform
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

import proxgen
from proxgen.compare import Comparison
from proxgen.config.schema import Config
from proxgen.files import write_whole
from proxgen.model.robot_model import RobotModel
from proxgen.report import agreement, course, joints, links, numerics, path, side_by_side, stills
from proxgen.report import film as films
from proxgen.report.derive import label
from proxgen.report.page import Gallery, Page, Section, write_page
from proxgen.report.tables import cards, summary_table
from proxgen.simulation.log import RolloutLog


def write_report(
    directory: Path,
    logs: Sequence[RolloutLog],
    comparison: Comparison | None = None,
    config: Config | None = None,
    title: str | None = None,
    film: Path | None = None,
) -> Path:
    """Write `index.html` and its figures as PNG into a folder.

    Args:
        directory: made if it does not exist; figures of the same name are replaced.
        logs: one or more runs, shown side by side where there are several.
        comparison: of the compiled controller with the reference; its verdict leads the page.
        config: of the robot that ran; with it the arm is drawn, and tolerances are known.
        title: heading of the page.
        film: of the first run (`film.write_film`); it leads the run's figures.

    Returns:
        The path of the page, which needs no other file and no network.
    """
    gallery = Gallery(directory)
    model = _model(config)
    sections = [] if comparison is None else [_agreement(gallery, comparison)]
    if len(logs) > 1:
        sections.append(_side_by_side(gallery, logs))
    runs = [_run(gallery, index, log, config, model) for index, log in enumerate(logs)]
    if film is not None:
        beside = write_whole(directory / f"figures/run1_film{film.suffix}", film.read_bytes())
        shown = gallery.show(beside, films.TITLE, films.CAPTION)
        runs[0] = replace(runs[0], figures=[shown, *runs[0].figures])
    sections += runs
    sections += [_timing(gallery, logs), _numbers(logs)]
    robots = ", ".join(dict.fromkeys(log.meta["robot"] for log in logs))
    scenes = ", ".join(dict.fromkeys(log.meta["scene"] for log in logs))
    page = Page(
        title or f"{robots}: {scenes}",
        f"Robot {robots}, scene {scenes}. All lengths in metres, angles in radians, times in seconds.",
        f"proxgen {proxgen.__version__}, Python {platform.python_version()}, {platform.machine()}. "
        "Cycle times were measured on this machine, with the simulation running beside the controller.",
        sections,
        cards(logs),
        None if comparison is None else agreement.verdict(comparison),
    )
    return write_page(directory / "index.html", page)


def _model(config: Config | None) -> RobotModel | None:
    """The arm, or None without a configuration."""
    if config is None:
        return None
    from proxgen.model import build_model  # loads Pinocchio: only where an arm is to be drawn

    return build_model(config)


def _run(
    gallery: Gallery, index: int, log: RolloutLog, config: Config | None, model: RobotModel | None
) -> Section:
    """All figures of one run."""
    tolerance = None if config is None else config.task.tolerance
    certified = None if config is None else config.solver.tolerance
    drawings: list[tuple[str, str, str, Callable[[], Figure]]] = [
        ("path", path.TITLE, path.CAPTION, lambda: path.path_figure(log, model)),
        ("course", course.TITLE, course.CAPTION, lambda: course.course_figure(log, tolerance)),
        ("links", links.TITLE, links.CAPTION, lambda: links.links_figure(log)),
        ("joints", joints.TITLE, joints.CAPTION, lambda: joints.joints_figure(log, model)),
        (
            "numerics", numerics.NUMERICS_TITLE, numerics.NUMERICS_CAPTION,
            lambda: numerics.numerics_figure(log, certified),
        ),
    ]  # fmt: skip
    if model is not None:
        drawings.insert(0, ("stills", stills.TITLE, stills.CAPTION, lambda: stills.stills_figure(log, model)))
    name = f"run{index + 1}"
    figures = [
        gallery.add(f"{name}_{suffix}", heading, caption, draw) for suffix, heading, caption, draw in drawings
    ]
    return Section(name, f"Run: {label(log)}", figures=figures)


def _agreement(gallery: Gallery, comparison: Comparison) -> Section:
    """The verdict's reasons."""
    figure = gallery.add(
        "agreement", agreement.TITLE, agreement.CAPTION, partial(agreement.agreement_figure, comparison)
    )
    return Section(
        "agreement", "Agreement with the reference",
        "Both controllers get the same states and readings in every cycle of a closed loop that the compiled "
        "one drives; the reference is written independently, in NumPy with another solver.",
        agreement.agreement_table(comparison), [scene.scene for scene in comparison.scenes], "Scene",
        comparison.failures[:20], [figure],
    )  # fmt: skip


def _side_by_side(gallery: Gallery, logs: Sequence[RolloutLog]) -> Section:
    """Runs in columns, as many as fit at a time."""
    columns = side_by_side.MOST_COLUMNS
    figures = [
        gallery.add(
            f"side_by_side{first // columns + 1}", side_by_side.TITLE, side_by_side.CAPTION,
            partial(side_by_side.side_by_side_figure, logs[first : first + columns]),
        )
        for first in range(0, len(logs), columns)
    ]  # fmt: skip
    return Section("side-by-side", "Side by side", figures=figures)


def _timing(gallery: Gallery, logs: Sequence[RolloutLog]) -> Section:
    """Cycle times of all runs."""
    draw = partial(numerics.timing_figure, logs)
    figure = gallery.add("timing", numerics.TIMING_TITLE, numerics.TIMING_CAPTION, draw)
    return Section("timing", "Cycle times", figures=[figure])


def _numbers(logs: Sequence[RolloutLog]) -> Section:
    """The table of all numbers."""
    lead = "The same numbers, under the same keys, as in the JSON file of proxgen run."
    return Section("numbers", "Numbers", lead, summary_table(logs), [label(log) for log in logs], "Number")
