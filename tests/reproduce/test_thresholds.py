"""What a claim's words promise is what its rule asks: numbers, relations, and the runs that it is about."""

import re
from pathlib import Path

import pytest
from made_up_results import made_up_results

from proxgen.config import load
from proxgen.reproduce.claims import BEYOND, D_R, KINEMATIC, PAPER, PROPOSED, SKIN, Claim
from proxgen.reproduce.plan import CONFIGURATIONS, full_plan
from proxgen.reproduce.rules import All, Compare, Either, Quantity, Rule
from proxgen.reproduce.units import unit_of

RELATIONS = {
    ">=": (False, True, True),
    "<=": (True, True, False),
    ">": (False, False, True),
    "<": (True, False, False),
    "==": (False, True, False),
}


@pytest.mark.parametrize("relation", RELATIONS)
def test_relations_hold_below_at_and_above(relation: str, tmp_path: Path) -> None:
    results, quantity = made_up_results(tmp_path), Quantity(("gap_proposed",), "deflection_m")
    value = quantity.value(results)
    assert value is not None
    other = Quantity(("true_gap",), "deflection_m")
    for right, holds in zip((value + 0.01, value, value - 0.01), RELATIONS[relation], strict=True):
        assert Compare(quantity, relation, right).judge(results).holds is holds
        for run in results.numbers["true_gap"]:
            run["deflection_m"] = right  # type: ignore[index]
        assert Compare(quantity, relation, other).judge(results).holds is holds
        assert Compare(quantity, relation, 2.0 * right, 0.5).judge(results).holds is holds


def asked(rule: Rule) -> list[tuple[str, float]]:
    """Key and number of every comparison with a number, in the unit that it is written in."""
    if isinstance(rule, All | Either):
        return [pair for inner in rule.rules for pair in asked(inner)]
    if not isinstance(rule, Compare):
        return []
    if isinstance(rule.right, Quantity):
        return [(rule.left.key, rule.factor)] if rule.factor != 1.0 else []
    return [(rule.left.key, unit_of(rule.left.key).scale * rule.right)] if rule.right else []


@pytest.mark.parametrize(
    "claim", [claim for claim in BEYOND if asked(claim.rule)], ids=lambda claim: claim.text[:40]
)
def test_numbers_of_our_claims_are_those_of_their_rules(claim: Claim) -> None:
    said = {float(number) for number in re.findall(r"\d+(?:\.\d+)?", claim.text)}
    said |= {0.5} if "half" in claim.text else set()
    for key, number in asked(claim.rule):
        if "gap still hold" in claim.text or "In facing" in claim.text:  # those of other claims
            continue
        assert any(number == pytest.approx(each) for each in said), (key, number)


def test_numbers_of_the_paper_s_claims() -> None:
    """Where its words give none, they are ours, and stand here a second time."""
    found = [pair for claim in PAPER for pair in asked(claim.rule)]
    assert found == [
        ("targets_reached", 2.0), ("min_distance_axis_m", 0.17), ("min_distance_axis_m", 0.17),
        ("sudden_obstacles", 1.0), ("start_manipulability", 1.0), ("escape_time_s", 2.0),
        ("targets_reached", 1.0), ("min_distance_axis_m", 0.17), ("targets_reached", 2.0),
        ("passes_between", 2.0), ("targets_reached", 1.0), ("time_below_d0l_fraction", 50.0),
        ("deflection_m", 0.05), ("targets_reached", 2.0),
    ]  # fmt: skip
    noise = next(claim for claim in BEYOND if "still hold" in claim.text)
    facing = next(claim for claim in BEYOND if "In facing" in claim.text)
    assert asked(noise.rule) == [("targets_reached", 12.0), ("targets_reached", 1.0)]
    assert asked(facing.rule) == [("targets_reached", 1.0)]


def test_the_threshold_is_that_of_the_configuration() -> None:
    assert load(CONFIGURATIONS["paper"]).avoidance.d_r == D_R == 0.17


def test_all_runs_are_all_runs() -> None:
    experiments = {one.name: one for one in full_plan().experiments}
    kinematic = {name for name, one in experiments.items() if one.plant == "kinematic"}
    assert set(KINEMATIC) == kinematic
    assert {experiments[name].scene for name in SKIN} == {"pillar", "gap"}
    assert {experiments[name].scene for name in PROPOSED} == {"pillar", "gap", "moving"}
    assert {experiments[name].setup.method for name in PROPOSED} == {"proposed"}


WORDS = {
    "limit": "limit_violations", "penetration": "penetration_samples", "solver failure": "solver_failures",
}  # fmt: skip


def test_what_never_happens_is_what_is_counted() -> None:
    """The keys of all sums that have to be 0 are those that their claims speak of."""
    for claim in (*PAPER, *BEYOND):
        keys = {condition.left.key for condition in _sums(claim.rule)}
        spoken = {key for word, key in WORDS.items() if word in claim.text}
        implied = {"penetration_samples"} if "targets" in claim.text or "avoids" in claim.text else set()
        implied |= {"penetration_samples"} if "still hold" in claim.text else set()
        assert keys <= spoken | implied, claim.text
        assert keys == spoken or not claim.text.startswith("No "), claim.text


def _sums(rule: Rule) -> list[Compare]:
    """The comparisons of sums in a rule."""
    if isinstance(rule, All | Either):
        return [found for inner in rule.rules for found in _sums(inner)]
    return [rule] if isinstance(rule, Compare) and rule.left.statistic == "sum" else []
