"""The report: claims and verdicts first, then the paper's figures in its order, and the numbers behind."""

import platform
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import proxgen
from proxgen.config import load
from proxgen.files import write_whole
from proxgen.model import build_model
from proxgen.report import film as films
from proxgen.report.page import Gallery, Page, Picture, Section
from proxgen.report.page import write_page as write_html
from proxgen.report.tables import Card
from proxgen.reproduce.claims import BEYOND, PAPER, Verdict, judge
from proxgen.reproduce.figures import FIGURES
from proxgen.reproduce.plan import FILMED, METHODS, SCENES
from proxgen.reproduce.results import Results
from proxgen.reproduce.store import write_json
from proxgen.reproduce.tables import (
    agreement_table,
    claims_table,
    experiments_table,
    headline,
    methods_targets,
    times_table,
)

TITLE = "Collision Avoidance with Proximity Servoing for Redundant Serial Robot Manipulators"

_PILLAR = {method: f"pillar_{method}" for method in METHODS}
_GAP = {method: f"gap_{method}" for method in METHODS}
_MOVING = {"kinematic": "moving_kinematic", "dynamic": "moving_dynamic"}

FIGURE_RUNS: dict[int, dict[str, str]] = {
    6: {"proposed": "pillar_proposed"},
    7: {"proposed": "pillar_proposed"},
    8: {"dynamic": "moving_dynamic"},
    9: {"proposed": "pillar_proposed"},
    10: _PILLAR,
    11: _GAP,
    12: _GAP,
    13: _GAP,
    14: _MOVING,
    15: _MOVING,
}
"""Which experiment each argument of the paper's figures takes."""

WITH_ARM = (6, 7, 8, 11, 14)
"""Figures that draw the arm, or its joints in their units."""


@dataclass(frozen=True)
class Outcome:
    """What came of a plan.

    Attributes:
        results: all numbers.
        paper: verdicts on the paper's claims.
        beyond: verdicts on proxgen's own.
        page: where they are to be read.
    """

    results: Results
    paper: list[Verdict]
    beyond: list[Verdict]
    page: Path


def write_page(results: Results, directory: Path, begin: float | None) -> Outcome:
    """Write `index.html`, its figures and `reproduce.json`.

    Args:
        results: of a plan that is done.
        directory: where to.
        begin: moment of `time.monotonic` at which everything began; None if it did not all happen now.

    Returns:
        The verdicts, and the page, which needs no other file and no network.

    Raises:
        SimulationError: a log cannot be read, or the folder not be written.
    """
    gallery = Gallery(directory)
    parts = [*_paper_sections(results, gallery), *_own_sections(results)]
    # Last, so that the time that figures take is part of what is judged.
    timed = replace(results, minutes=None if begin is None else (time.monotonic() - begin) / 60.0)
    paper, beyond = judge(PAPER, timed), judge(BEYOND, timed)
    write_json(directory / "reproduce.json", _json(timed, paper, beyond))
    page = Page(
        f"Reproduced: {TITLE}",
        "The experiments of Y. Ding and U. Thomas, ICRA 2020, in simulation, each from "
        f"{len(results.plan.starts)} starts (joints ±0.03 rad, targets ±0.02 m) over "
        f"{results.plan.duration:g} s; numbers are mean ± standard deviation over the starts.",
        f"proxgen {proxgen.__version__}, Python {platform.python_version()}, {platform.machine()}, "
        f"plan: {results.plan.name}. All numbers are in reproduce.json, all runs in runs/.",
        [
            _claims("claims", "Claims of the paper", paper),
            _claims("beyond", "Beyond the paper", beyond),
            *parts,
        ],
        _cards(timed, paper, beyond),
    )
    return Outcome(timed, paper, beyond, write_html(directory / "index.html", page))


def _claims(anchor: str, title: str, verdicts: Sequence[Verdict]) -> Section:
    """A table of claims."""
    lead = f"{headline(verdicts)}. Every verdict follows from the runs below by the rule beside it."
    return Section(anchor, title, lead, claims=claims_table(verdicts))


def _paper_sections(results: Results, gallery: Gallery) -> list[Section]:
    """The paper's experiments with its figures."""
    verification, comparison, dynamic = (
        [*_film(results, gallery, filmed), *_figures(results, gallery, numbers)]
        for filmed, numbers in zip(FILMED, ((6, 7, 9, 10), (11, 12, 13), (8, 14, 15)), strict=True)
    )
    return [
        _experiments(
            results, "verification", "V.B Function verification",
            "The pillar, with the paper's skin; beside it the same with true distances, to tell what "
            "the sensors' blind spots do.",
            ("pillar_proposed", "true_pillar"), ("skin", "true distances"), verification,
        ),
        _experiments(
            results, "pillar", "V.C Comparison in pillar", "Three methods with the skin; see figure 10.",
            tuple(_PILLAR.values()), METHODS,
        ),
        _experiments(
            results, "gap", "V.C Comparison in gap", "Three methods with the skin.",
            tuple(_GAP.values()), METHODS, comparison,
        ),
        _experiments(
            results, "dynamic", "V.D Dynamic obstacles",
            "Three spheres approach hand, elbow and forearm at 0.2 m/s. In place of the real robot: a "
            "dynamic arm behind a model of the control cabinet.",
            ("moving_kinematic", "moving_dynamic"), ("kinematic plant", "behind the cabinet"), dynamic,
        ),
        _experiments(
            results, "cabinet", "V.D What the control cabinet does",
            "True distances, as the skin's blind spots are to play no part: commands followed exactly, "
            "and behind the cabinet, which bounds acceleration and jerk.",
            [f"{kind}_{scene}" for scene in ("pillar", "moving") for kind in ("true", "cabinet")],
            [f"{scene}, {plant}" for scene in ("pillar", "moving") for plant in ("kinematic", "cabinet")],
        ),
    ]  # fmt: skip


def _own_sections(results: Results) -> list[Section]:
    """What proxgen adds, and how it is checked."""
    return [
        _experiments(
            results, "-".join(scenes), f"Improvements in {' and '.join(scenes)}",
            "The paper's hard rows against the improved configuration where every distance is known exactly.",
            [f"{kind}_{scene}" for scene in scenes for kind in ("true", "improved")],
            [f"{scene}, {kind}" for scene in scenes for kind in ("paper", "improved")],
        )
        for scenes in (SCENES[:2], SCENES[2:])
    ] + [
        _experiments(
            results, "dense", "Improvements, denser skin", "Moving obstacles, kinematic plant.",
            ("moving_kinematic", "dense_moving"), ("paper", "improved and denser"),
        ),
        _experiments(
            results, "noise", "Noise", "Gap, with 5 mm of noise (σ) and 5 % lost samples on every sensor.",
            [f"noise_{method}" for method in METHODS], METHODS,
        ),
        Section(
            "times", "Cycle times",
            "Each method replays the cycles of its own run in gap, in turns, alone on the machine.",
            times_table(results), list(results.cycle_times), "Time",
        ),
        Section(
            "agreement", "Agreement of compiled controller and reference",
            "Greatest difference of the velocity, and whether everything else (matrices, statuses, "
            f"certificates) is within its tolerance too, over {results.plan.agreement_duration:g} s in the "
            "closed loop.",
            agreement_table(results), SCENES, "Controller, sensing",
            remarks=[failure for one in results.agreements for failure in one["failures"]],
        ),
    ]  # fmt: skip


def _experiments(
    results: Results,
    anchor: str,
    title: str,
    lead: str,
    names: Sequence[str],
    columns: Sequence[str],
    figures: Sequence[Picture] = (),
) -> Section:
    """A table of some experiments, and figures."""
    return Section(
        anchor, title, lead, experiments_table(results, names), columns, "Over all starts", figures=figures
    )


def _figures(results: Results, gallery: Gallery, numbers: Sequence[int]) -> list[Picture]:
    """Some of the paper's figures."""
    arm = {"model": build_model(load(results.plan.configurations["paper"]))}
    pictures = []
    for number in (number for number in numbers if number in FIGURES):
        figure = FIGURES[number]
        runs = {argument: results.logs(name) for argument, name in FIGURE_RUNS[number].items()}
        title = f"Figure {number}: {figure.title[:1].lower()}{figure.title[1:]}"
        draw = partial(figure.draw, **runs, **(arm if number in WITH_ARM else {}))
        pictures.append(gallery.add(f"figure_{number:02d}", title, figure.caption, draw))
    return pictures


def _film(results: Results, gallery: Gallery, experiment: str) -> list[Picture]:
    """The film of an experiment, if there is one."""
    if experiment not in results.films:
        return []
    path = write_whole(gallery.directory / f"figures/film_{experiment}.webp", results.films[experiment])
    title = f"Film: {results.plan.experiment(experiment).scene}"
    return [gallery.show(path, title, f"The proposed method, one run. {films.CAPTION}")]


def _cards(results: Results, paper: Sequence[Verdict], beyond: Sequence[Verdict]) -> list[Card]:
    """What one looks at first."""
    plan = results.plan
    took = "–" if results.minutes is None else f"{results.minutes:.1f} min"
    held = [sum(verdict.judgement.holds is True for verdict in verdicts) for verdicts in (paper, beyond)]
    return [
        Card(
            "Verdicts",
            [
                (f"{held[0]} of {len(paper)}", "claims of the paper hold"),
                (f"{held[1]} of {len(beyond)}", "claims beyond the paper hold"),
                (str(len(plan.experiments) * len(plan.starts)), f"runs of {plan.duration:g} s"),
                (took, "for everything"),
            ],
        ),
        Card("Pillar", methods_targets(results, "pillar")),
        Card("Gap", methods_targets(results, "gap")),
    ]


def _json(results: Results, paper: Sequence[Verdict], beyond: Sequence[Verdict]) -> dict[str, Any]:
    """Every number of the page, and those of every run."""
    plan = results.plan
    return {
        "proxgen": proxgen.__version__,
        "plan": {
            "name": plan.name, "starts": list(plan.starts), "duration_s": plan.duration,
            "minutes": results.minutes,
        },
        "claims": {"paper": [_verdict(v) for v in paper], "beyond": [_verdict(v) for v in beyond]},
        "experiments": {
            what.name: {
                "scene": what.scene, "configuration": what.setup.configuration, "method": what.setup.method,
                "sensing": what.sensing, "plant": what.plant, "noise_m": what.noise, "dropout": what.dropout,
                "runs": list(results.numbers[what.name]),
            }
            for what in plan.experiments
        },
        "agreements": list(results.agreements),
        "cycle_times": results.cycle_times,
    }  # fmt: skip


def _verdict(verdict: Verdict) -> dict[str, Any]:
    """A claim as plain data."""
    parts = [vars(part) for part in verdict.judgement.parts]
    claim = verdict.claim
    return {"claim": claim.text, "place": claim.place, "verdict": verdict.word, "parts": parts}
