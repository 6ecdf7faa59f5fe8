"""The tables in the documentation are those that the benchmarks wrote."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from proxgen.bench.markdown import BLOCKS, fill

ROOT = Path(__file__).resolve().parents[2]
MEASURED = ROOT / "docs" / "measured"
PAGES = (ROOT / "README.md", ROOT / "docs" / "performance.md")


@pytest.fixture(scope="module")
def measured() -> dict[str, Any]:
    """The JSON files beside the pages."""
    return {
        name: json.loads((MEASURED / f"{name}.json").read_text()) for name in ("bench", "peers", "scaling")
    }


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_show_what_was_measured(page: Path, measured: dict[str, Any]) -> None:
    text = page.read_text(encoding="utf-8")
    assert fill(text, measured) == text, "run docs/measured/measure.py --fill"
    assert len(re.findall(r"<!-- measured: ", text)) == len(re.findall(r"<!-- end -->", text)) > 0


def test_every_table_is_shown_somewhere() -> None:
    shown = {name for page in PAGES for name in re.findall(r"<!-- measured: (.*?) -->", page.read_text())}
    assert shown == set(BLOCKS)


def test_a_changed_figure_changes_its_page(measured: dict[str, Any]) -> None:
    page = "before\n<!-- measured: cycles -->\nold\n<!-- end -->\nafter\n"
    results = json.loads(json.dumps(measured["bench"]))
    (raw,) = [
        row for row in results["results"] if (row["name"], row["backend"]) == ("gap: cycle, raw", "daqp")
    ]
    raw["p50_us"] = 123.4
    filled = fill(page, measured | {"bench": results})
    assert filled.startswith("before\n<!-- measured: cycles -->\n| ") and filled.endswith(
        "\n<!-- end -->\nafter\n"
    )
    assert "| gap, DAQP | 123 |" in filled and "old" not in filled
    assert "| gap, DAQP | 123 |" not in fill(page, measured)


def test_an_unknown_table_is_an_error(measured: dict[str, Any]) -> None:
    with pytest.raises(KeyError, match="wishes"):
        fill("<!-- measured: wishes -->\n<!-- end -->\n", measured)


def test_figures_meet_what_was_promised(measured: dict[str, Any]) -> None:
    """What does not depend on how busy the machine was: no heap, certified, linear."""
    cycles = [row for row in measured["bench"]["results"] if row["name"].endswith(": cycle, raw")]
    assert {row["backend"] for row in cycles} == {"daqp", "qpoases"}
    for row in cycles:
        assert row["worst_kkt_residual"] <= 1e-8
        assert row["backend"] != "daqp" or row["heap_allocations_per_cycle"] == 0.0
    sensors = measured["scaling"]["scaling"]["sensors"]
    distances = dict(zip(sensors["value"], sensors["distances"], strict=True))
    assert distances[512.0] <= 16.0 * distances[32.0]
    assert not measured["peers"]["failures"]
