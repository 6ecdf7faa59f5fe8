"""The guides: every command in them is run, in order, every link leads somewhere, every name exists."""

import re
from dataclasses import fields
from pathlib import Path

import pytest
from pages import ROOT, blocks_of, copy_repository, run_block

from proxgen.config import load
from proxgen.controllers.protocol import Diagnostics, Status

GUIDES = ("your-robot", "your-skin", "tune")


def page(name: str) -> str:
    """Text of a guide."""
    return (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository, shared by the guides."""
    return copy_repository(tmp_path_factory.mktemp("guides") / "proxgen")


@pytest.mark.slow
@pytest.mark.parametrize("name", GUIDES)
def test_everything_in_a_guide_runs_in_order(name: str, clone: Path) -> None:
    blocks = blocks_of(page(name))
    assert {block.language for block in blocks} <= {"sh", "python", "yaml"}
    said = "\n".join(run_block(block, clone) for block in blocks)
    if name == "your-robot":
        assert said.count("verdict: pass") == 2
        assert (clone / "out" / "my_arm" / "index.html").stat().st_size > 0
    elif name == "your-skin":
        assert "forearm.1.5" in said
        assert load(clone / "my_skin.yaml").skin.tof is not None
    else:
        assert "SOLVED rows on:" in said
        assert "FAULT_JOINT_LIMIT\ninside again after " in said


@pytest.mark.parametrize("name", GUIDES)
def test_links_of_the_guides_lead_somewhere(name: str) -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", page(name))
    assert [
        target for target in targets if "://" not in target and not (ROOT / "docs" / target).exists()
    ] == []


def test_the_tuning_guide_knows_every_status_and_diagnostic() -> None:
    text = page("tune")
    assert [status.name for status in Status if f"`{status.name}`" not in text] == []
    matrices = {"H", "g", "A"}
    names = [field.name for field in fields(Diagnostics) if field.name not in matrices]
    assert [name for name in names if name not in text] == []
