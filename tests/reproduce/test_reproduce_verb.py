"""`proxgen reproduce`, as README.md calls it, with a plan that takes seconds in place of minutes."""

import json
import re
import shlex
from dataclasses import replace
from pathlib import Path

import pytest

from proxgen.cli import main
from proxgen.reproduce.plan import Agreement, Plan, Setup, full_plan

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
COMMANDS = [
    shlex.split(line, comments=True)[1:] for line in re.findall(r"^proxgen reproduce.*$", README, re.M)
]


def tiny_plan() -> Plan:
    """Every experiment from one start for a fraction of a second; one robot's three methods stand for all."""
    plan = full_plan()
    paper = dict.fromkeys(plan.configurations, plan.configurations["paper"])
    return replace(
        plan, name="tiny", configurations=paper, starts=(1,), duration=0.4, agreement_duration=0.2,
        agreements=(Agreement(Setup(), "gap", "skin"), Agreement(Setup(method="repulsive"), "gap", "skin")),
        timed_passes=1,
    )  # fmt: skip


@pytest.fixture
def _tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tiny plans in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    for name in ("full_plan", "quick_plan"):
        monkeypatch.setattr(f"proxgen.reproduce.plan.{name}", tiny_plan)


@pytest.mark.slow
@pytest.mark.usefixtures("_tiny")
@pytest.mark.filterwarnings("ignore:constrained_layout not applied")  # runs too short for their labels
def test_the_command_of_the_readme(capsys: pytest.CaptureFixture[str]) -> None:
    assert len(COMMANDS) == 1
    assert main(COMMANDS[0]) == 0
    said = capsys.readouterr()
    assert said.err == ""  # no progress bar in a pipe
    experiments = [experiment.name for experiment in tiny_plan().experiments]
    assert sorted(re.findall(r"^(\w+): .* targets, least distance", said.out, re.M)) == sorted(experiments)
    assert re.search(r"^claims of the paper: \d+ of \d+ hold", said.out, re.M)
    page = Path(said.out.splitlines()[-1].removeprefix("report: "))
    assert page.is_file()
    content = json.loads((page.parent / "reproduce.json").read_text())
    assert {run["controller"] for run in content["experiments"]["gap_repulsive"]["runs"]} == {"repulsive"}
    assert [one["verdict"] for one in content["agreements"]] == ["pass", "pass"]
    assert content["plan"]["minutes"] > 0.0
    _check_continuation(page.parent / "runs", capsys)


def _check_continuation(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A second call does only what is not there."""
    before = {path.name: path.stat().st_mtime_ns for path in runs.iterdir()}
    assert len(before) == 2 * len(tiny_plan().experiments) + 2 + 3 + 1  # runs, comparisons, films, times
    (runs / "gap_tangential-1.json").unlink()
    assert main(COMMANDS[0]) == 0
    after = {path.name: path.stat().st_mtime_ns for path in runs.iterdir()}
    renewed = {name for name, time in after.items() if time != before.get(name)}
    assert renewed == {"gap_tangential-1.json", "gap_tangential-1.npz"}
    assert set(after) == set(before)
    said = capsys.readouterr().out
    assert re.findall(r"^(\w+): .* targets", said, re.M) == ["gap_tangential"]
    assert "not judged     All of this is reproduced by one command, in time." in said


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--quik"], "proxgen reproduce: unknown flag '--quik'; did you mean '--quick'?"),
        (["now"], "proxgen reproduce: unexpected argument 'now'"),
        (["--out", "file"], "proxgen reproduce: argument --out: file is a file; a folder is needed"),
    ],
)
@pytest.mark.usefixtures("_tiny")
def test_wrong_words(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("file").write_text("")
    assert main(["reproduce", *words]) == 2
    assert capsys.readouterr().err.startswith(message)


@pytest.mark.usefixtures("_tiny")
def test_a_configuration_that_is_missing_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = replace(tiny_plan(), configurations=dict.fromkeys(tiny_plan().configurations, Path("none.yaml")))
    monkeypatch.setattr("proxgen.reproduce.plan.full_plan", lambda: plan)
    assert main(["reproduce"]) == 2
    assert "none.yaml" in capsys.readouterr().err
