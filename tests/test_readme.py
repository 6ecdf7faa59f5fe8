"""README.md, line by line: every command in it is run, every program compiled, every link followed.

All blocks run in order in one copy of the repository, so that what a block builds is there for the next one.
"""

import json
import re
import shutil
from pathlib import Path

import pytest
from pages import ROOT, blocks_of, copy_repository, run_block, shell

from proxgen.config import load
from proxgen.model import build_model

README = (ROOT / "README.md").read_text(encoding="utf-8")

pytestmark = pytest.mark.slow


BLOCKS = blocks_of(README)
COMMANDS = [
    line for block in BLOCKS if block.language == "sh" for line in block.text.splitlines() if line.strip()
]
MAKE_TEST = "make test "
"""The test suite itself: what it runs is checked line by line, instead of starting it within itself."""
REPRODUCE = "proxgen reproduce "
"""Minutes: tests/reproduce/test_reproduce_verb.py runs the same words with a plan that takes seconds."""


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository."""
    return copy_repository(tmp_path_factory.mktemp("readme") / "proxgen")


def check_measured_numbers(folder: Path) -> None:
    """The row of the table that the README's own commands measure anew."""
    (row,) = re.findall(r"^\| gap \| skin \| (\d+) \| ([\d.]+) m \| ([\d.]+) % \| (\d+) \|$", README, re.M)
    targets, distance, below, harm = map(float, row)
    summary = json.loads((folder / "out" / "gap" / "summary.json").read_text())
    # Another processor's sine may differ in the last bit, and a closed loop amplifies that a little.
    assert abs(summary["targets_reached"] - targets) <= 1
    assert summary["min_distance_axis_m"] == pytest.approx(distance, abs=0.005)
    assert 100.0 * summary["time_below_dr_fraction"] == pytest.approx(below, abs=1.0)
    assert summary["penetration_samples"] + summary["limit_violations"] + summary["solver_failures"] == harm


def test_the_commands_of_the_readme_are_seen() -> None:
    assert {block.language for block in BLOCKS} == {"math", "sh", "python", "yaml", "c"}
    assert sum(command.startswith(MAKE_TEST) for command in COMMANDS) == 1
    assert sum(command.startswith(REPRODUCE) for command in COMMANDS) == 1
    assert len(COMMANDS) >= 9


def test_everything_in_the_readme_runs_in_order(clone: Path) -> None:
    """Shell blocks are run, Python blocks too; a C block is saved under the name in its first line."""
    said = []
    for block in BLOCKS:
        if block.language == "sh":
            lines = [line for line in block.text.splitlines() if not line.startswith((MAKE_TEST, REPRODUCE))]
            said.append(shell("\n".join(lines), clone))
        elif block.language in {"python", "c"}:
            said.append(run_block(block, clone))
    output = "\n".join(said)
    assert re.search(r"Comparison +pass", output)  # make demo
    assert "verdict: pass" in output  # proxgen compare
    assert re.search(r"^SOLVED \[", output, re.M)  # the Python program
    assert re.search(r"^joint 1 is at -?\d", output, re.M)  # the C program
    demo = [f"out/demo/{name}" for name in ("index.html", "log.npz", "summary.json", "comparison.json")]
    for page in (*demo, "out/gap/index.html", "out/compare.json"):
        assert (clone / page).stat().st_size > 0
    check_measured_numbers(clone)


def test_the_short_configuration_is_a_whole_one(tmp_path: Path) -> None:
    (text,) = [block.text for block in BLOCKS if block.language == "yaml"]
    (tmp_path / "arm.yaml").write_text(text)
    shutil.copy(ROOT / "examples" / "iiwa7" / "iiwa7.urdf", tmp_path / "arm.urdf")
    model = build_model(load(tmp_path / "arm.yaml"))
    assert (model.n, len(model.capsules), len(model.modules)) == (7, 1, 6)


@pytest.mark.parametrize(
    "tool",
    [
        "ruff check",
        "ruff format --check",
        "mypy",
        "clang-format --dry-run -Werror",
        "diff -r generated",
        "pytest -n 2",
    ],
)
def test_make_test_runs(tool: str, clone: Path) -> None:
    """The suite cannot run itself; but make says which lines it would run."""
    assert tool in shell(f"{MAKE_TEST} --dry-run", clone)


def test_pytest_has_the_last_word(clone: Path) -> None:
    assert "pytest" in shell(f"{MAKE_TEST} --dry-run", clone).strip().splitlines()[-1]


@pytest.mark.parametrize("target", re.findall(r"\]\(([^)#]+)\)", README))
def test_links_lead_somewhere(target: str) -> None:
    assert "://" in target or (ROOT / target).exists()


def test_first_lines() -> None:
    """The equation comes first, and the two commands are the first ones."""
    assert [block.language for block in BLOCKS[:2]] == ["math", "sh"]
    assert [line.split("#")[0].strip() for line in BLOCKS[1].text.splitlines()] == ["make demo", "make test"]
