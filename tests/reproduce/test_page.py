"""The page of results that are made up: complete, self-contained, and the same in JSON."""

import json
import re
from base64 import b64decode
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
from made_up import BOX, make_log
from made_up_results import made_up_results

from proxgen.report import style
from proxgen.reproduce.claims import BEYOND, PAPER
from proxgen.reproduce.figures import FIGURES
from proxgen.reproduce.page import FIGURE_RUNS, Outcome, write_page
from proxgen.reproduce.results import Results

FILM = b"RIFF of a WebP"
ABOVE = BOX | {"name": "above", "position": [0.5, 0.0, 0.8]}


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """A page of short logs of the iiwa 7."""
    directory = tmp_path_factory.mktemp("page")
    results = made_up_results(directory / "runs")
    results.numbers["gap_repulsive"][0]["targets_reached"] = 5  # type: ignore[index]
    results.agreements[0]["failures"].append("gap, cycle 3: qdot <differs>")
    names = {name for runs in FIGURE_RUNS.values() for name in runs.values()}
    for name in names:
        for start in results.plan.starts:
            log = make_log(7, 3, 60, obstacles=[BOX, ABOVE])
            log = replace(log, tof_range=np.ones((60, 32)), capacitive=np.zeros((60, 32), dtype=bool))
            results.store.save(f"{name}-{start}", "now", {}, log)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "DPI", 40)  # small pictures are as complete as large ones, and sooner there
        return write_page(replace(results, minutes=None, films={"gap_proposed": FILM}), directory, None)


@pytest.fixture(scope="module")
def text(outcome: Outcome) -> str:
    """The page without its markup."""
    return unescape(re.sub(r"<[^>]*>", " ", outcome.page.read_text()))


def test_every_claim_is_there_with_rule_measurement_and_verdict(outcome: Outcome, text: str) -> None:
    assert [verdict.claim for verdict in (*outcome.paper, *outcome.beyond)] == [*PAPER, *BEYOND]
    for verdict in (*outcome.paper, *outcome.beyond):
        assert verdict.claim.text in text
        for part in verdict.judgement.parts:
            assert part.words in text
            assert part.measured in text
    for word in ("holds", "does not hold", "not judged"):
        assert re.search(rf"\b{word}\b", text)
    assert f"{len(PAPER) - 1} of {len(PAPER)} hold, 1 do not" in text


def test_every_figure_of_the_paper_is_there_in_its_order(outcome: Outcome, text: str) -> None:
    order = [int(number) for number in re.findall(r"Figure (\d+):", text)]
    assert sorted(order) == sorted(FIGURES) == sorted(FIGURE_RUNS)
    assert order == [6, 7, 9, 10, 11, 12, 13, 8, 14, 15]
    for number in order:
        assert (outcome.page.parent / "figures" / f"figure_{number:02d}.png").stat().st_size > 0


def test_a_film_stands_before_the_figures_of_its_section(outcome: Outcome, text: str) -> None:
    assert (outcome.page.parent / "figures" / "film_gap_proposed.webp").read_bytes() == FILM
    (shown,) = re.findall(r'src="data:image/webp;base64,([^"]*)"[^>]* class="film"', outcome.page.read_text())
    assert b64decode(shown) == FILM
    assert text.index("Figure 10:") < text.index("Film: gap.") < text.index("Figure 11:")
    assert text.count("Film:") == 1  # there were no others


def test_the_page_needs_nothing_else(outcome: Outcome) -> None:
    page = outcome.page.read_text()
    links = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert len(links) > 20
    for link in links:
        inside = link.startswith(("#", "data:image/"))
        assert inside or (outcome.page.parent / link).is_file(), link
    assert "http" not in re.sub(r"data:image/[^\"]*", "", page)


def test_what_differs_is_said(text: str) -> None:
    assert "gap, cycle 3: qdot <differs>" in text


def test_all_numbers_are_in_the_json_file(outcome: Outcome) -> None:
    content = json.loads((outcome.page.parent / "reproduce.json").read_text())
    results: Results = outcome.results
    assert set(content) == {"proxgen", "plan", "claims", "experiments", "agreements", "cycle_times"}
    assert [len(content["claims"][key]) for key in ("paper", "beyond")] == [len(PAPER), len(BEYOND)]
    assert set(content["claims"]["paper"][0]) == {"claim", "place", "verdict", "parts"}
    for name, runs in results.numbers.items():
        assert content["experiments"][name]["runs"] == runs
    assert content["agreements"] == results.agreements
    assert content["cycle_times"] == results.cycle_times
