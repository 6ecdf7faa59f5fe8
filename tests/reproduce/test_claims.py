"""Claims and rules: each can hold, each condition can make it fail, and what is missing is not judged."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from made_up_results import made_up_results

from proxgen.reproduce.claims import BEYOND, PAPER, Claim, judge
from proxgen.reproduce.plan import Plan, full_plan, quick_plan
from proxgen.reproduce.results import Results
from proxgen.reproduce.rules import (
    Agreed,
    All,
    Compare,
    CycleTimes,
    Either,
    InTime,
    Quantity,
    Rule,
)
from proxgen.reproduce.tables import headline
from proxgen.reproduce.units import mean_and_spread, unit_of

CLAIMS = (*PAPER, *BEYOND)


@pytest.fixture
def results(tmp_path: Path) -> Results:
    """Everything holds."""
    return made_up_results(tmp_path)


def conditions(rule: Rule) -> Iterator[Compare]:
    """All comparisons of a rule."""
    if isinstance(rule, All | Either):
        for inner in rule.rules:
            yield from conditions(inner)
    elif isinstance(rule, Compare):
        yield rule


def put(results: Results, quantity: Quantity, value: Any) -> None:
    """Give a number to every run of a quantity's experiments."""
    *sections, key = quantity.key.split(".")
    for name in quantity.experiments:
        for run in results.numbers[name]:
            target: Any = run
            for section in sections:
                target = target[section]
            target[key] = value


def spoil(results: Results, condition: Compare) -> None:
    """Change the left side so that the condition does not hold."""
    right = condition.right
    asked = right.value(results) if isinstance(right, Quantity) else right
    assert asked is not None
    wrong = {">=": -1.0, "<=": 1.0, ">": 0.0, "<": 0.0, "==": 1.0}[condition.relation]
    put(results, condition.left, condition.factor * asked + wrong)


def spoil_rule(results: Results, rule: Rule) -> None:
    """Make a rule fail; of one with alternatives all of them."""
    if isinstance(rule, Either):
        for alternative in rule.rules:
            spoil(results, list(conditions(alternative))[-1])
    else:
        spoil(results, next(conditions(rule)))


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.text[:40])
def test_every_claim_holds_where_it_should(claim: Claim, results: Results) -> None:
    judgement = claim.rule.judge(results)
    assert judgement.holds is True, judgement.parts
    assert all(part.words and part.measured for part in judgement.parts)


COMPARED = [claim for claim in CLAIMS if list(conditions(claim.rule))]


@pytest.mark.parametrize("claim", COMPARED, ids=lambda claim: claim.text[:40])
def test_every_condition_can_make_its_claim_fail(claim: Claim, tmp_path: Path) -> None:
    """Also those in a longer rule, one by one."""
    rules = claim.rule.rules if isinstance(claim.rule, All) else (claim.rule,)
    for rule in rules:
        results = made_up_results(tmp_path)
        spoil_rule(results, rule)
        assert claim.rule.judge(results).holds is False, list(conditions(rule))


def test_the_other_rules_can_fail(results: Results) -> None:
    assert {type(claim.rule) for claim in CLAIMS if claim not in COMPARED} == {Agreed, CycleTimes, InTime}
    results.agreements[3]["verdict"] = "fail"  # type: ignore[index]
    assert Agreed().judge(results).holds is False
    assert Agreed().judge(replace(results, agreements=[])).holds is None
    results.cycle_times["proposed"]["c"]["mean_us"] = 1.0
    assert CycleTimes("c", longer=True).judge(results).holds is False
    results.cycle_times["repulsive"]["python"]["mean_us"] = 4300.0
    assert CycleTimes("python", longer=False).judge(results).holds is False
    assert InTime().judge(replace(results, minutes=4.1)).holds is False
    assert InTime().judge(replace(results, minutes=None)).holds is None


@pytest.mark.parametrize("claim", COMPARED, ids=lambda claim: claim.text[:40])
def test_what_was_not_measured_is_not_judged(claim: Claim, results: Results) -> None:
    for condition in conditions(claim.rule):
        put(results, condition.left, None)
    assert claim.rule.judge(results).holds is None


def test_a_better_alternative_hides_the_marks_of_the_other(results: Results) -> None:
    quantity = Quantity(("gap_proposed",), "targets_reached")
    fails, holds = Compare(quantity, ">", 100.0), Compare(quantity, ">", 1.0)
    judgement = Either((fails, holds)).judge(results)
    assert (judgement.holds, [part.holds for part in judgement.parts]) == (True, [None, True])
    assert judgement.parts[1].words == "or gap proposed: targets reached, mean > 1"
    assert [part.holds for part in Either((fails, fails)).judge(results).parts] == [False, False]


def test_statistics_are_over_all_runs_of_all_experiments(results: Results) -> None:
    for value, (name, start) in enumerate((n, s) for n in ("gap_proposed", "true_gap") for s in (0, 1)):
        results.numbers[name][start]["deflection_m"] = 0.1 * value  # type: ignore[index]
    both = ("gap_proposed", "true_gap")
    expected = {"mean": 0.15, "least": 0.0, "greatest": 0.3, "sum": 0.6}
    for statistic, wanted in expected.items():
        assert Quantity(both, "deflection_m", statistic).value(results) == pytest.approx(wanted)


def test_numbers_are_written_with_spread_and_unit(results: Results) -> None:
    unit = unit_of("targets_reached")
    assert mean_and_spread([12.0, 14.0], unit) == "13.0 ± 1.4 (12 to 14)"
    assert mean_and_spread([12.0, 12.0], unit) == "12.0 ± 0"
    assert mean_and_spread([12.0], unit) == "12.0"
    assert Quantity(("gap_proposed",), "min_distance_axis_m", "least").written(results) == "0.200 m"
    hand = Quantity(("moving_dynamic",), "link_below_dr_fraction.hand")
    assert hand.what == "time below d_r of the link hand, mean"
    assert hand.written(results) == "5.00 ± 0 %"


def test_a_headline_counts_verdicts(results: Results) -> None:
    assert headline(judge(PAPER, results)) == f"{len(PAPER)} of {len(PAPER)} hold"
    put(results, Quantity(("pillar_proposed",), "limit_violations"), 1)
    unknown = replace(results, minutes=None)
    said = f"{len(BEYOND) - 3} of {len(BEYOND)} hold, 2 do not, 1 cannot be judged"
    assert headline(judge(BEYOND, unknown)) == said


@pytest.mark.parametrize("plan", [full_plan(), quick_plan()], ids=lambda plan: plan.name)
def test_a_plan_has_what_the_claims_ask_for(plan: Plan) -> None:
    names = [experiment.name for experiment in plan.experiments]
    assert len(set(names)) == len(names)
    for claim in CLAIMS:
        for condition in conditions(claim.rule):
            sides = [side for side in (condition.left, condition.right) if isinstance(side, Quantity)]
            assert {name for side in sides for name in side.experiments} <= set(names)
    assert all(plan.configurations[setup.configuration].is_file() for setup in plan.setups)
    assert plan.duration == 60.0
    assert {(one.setup, one.scene) for one in plan.agreements} == {
        (setup, scene) for setup in plan.setups for scene in ("pillar", "gap", "facing", "moving")
    }


def test_the_full_plan_has_eight_starts_and_the_quick_one_some_of_them() -> None:
    assert len(full_plan().starts) >= 8
    assert set(quick_plan().starts) < set(full_plan().starts)
