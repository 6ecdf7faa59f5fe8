"""Claims as data: what the paper says, and what proxgen adds, each with the rule by which it is judged."""

from dataclasses import dataclass

from proxgen.reproduce.plan import METHODS, SCENES
from proxgen.reproduce.results import Results
from proxgen.reproduce.rules import (
    Agreed,
    All,
    Compare,
    CycleTimes,
    Either,
    InTime,
    Judgement,
    Quantity,
    Rule,
)

D_R = 0.17
"""The paper's threshold below which repulsion is full (17) [m]."""


@dataclass(frozen=True)
class Claim:
    """A sentence that is true or not.

    Attributes:
        text: what is claimed.
        place: where; of the paper its section and figure.
        rule: what has to hold of the data.
    """

    text: str
    place: str
    rule: Rule


@dataclass(frozen=True)
class Verdict:
    """A claim and what the data say."""

    claim: Claim
    judgement: Judgement

    @property
    def word(self) -> str:
        """In one or two words."""
        return {True: "holds", False: "does not hold", None: "not judged"}[self.judgement.holds]


def judge(claims: tuple[Claim, ...], results: Results) -> list[Verdict]:
    """The verdicts on claims, in their order."""
    return [Verdict(claim, claim.rule.judge(results)) for claim in claims]


def _of(experiment: str, key: str, statistic: str = "mean") -> Quantity:
    """A number of one experiment."""
    return Quantity((experiment,), key, statistic)


def _more(key: str, experiment: str, other: str) -> Compare:
    """The mean of a number is greater in one experiment than in another."""
    return Compare(_of(experiment, key), ">", _of(other, key))


def _none(key: str, experiments: tuple[str, ...], label: str = "") -> Compare:
    """Something never happens."""
    return Compare(Quantity(experiments, key, "sum", label), "==", 0.0)


def _targets(experiment: str, relation: str, count: float, statistic: str = "mean") -> Compare:
    """How many targets are reached."""
    return Compare(_of(experiment, "targets_reached", statistic), relation, count)


def _distance(experiments: tuple[str, ...], least: float, label: str = "") -> Compare:
    """No link's axis ever comes nearer."""
    return Compare(Quantity(experiments, "min_distance_axis_m", "least", label), ">=", least)


def _slower_or_nearer(prefix: str) -> Either:
    """The tangential method reaches fewer targets, or as many at a smaller least distance."""
    tangential, proposed = f"{prefix}_tangential", f"{prefix}_proposed"
    targets, distance = "targets_reached", "min_distance_axis_m"
    nearer = Compare(_of(tangential, distance), "<", _of(proposed, distance))
    as_many = Compare(_of(tangential, targets), "==", _of(proposed, targets))
    return Either((_more(targets, proposed, tangential), All((as_many, nearer))))


PAPER = (
    Claim("The joints do not exceed their limits.", "V.B, fig. 7",
          _none("limit_violations", ("pillar_proposed",))),
    Claim("The joints experience noise where constraints are switched hard.", "V.B, fig. 7",
          Compare(_of("pillar_proposed", "mean_abs_dqdot_switching"), ">",
                  _of("pillar_proposed", "mean_abs_dqdot_steady"))),
    Claim("The noise is particularly prominent when obstacles are detected.", "V.B, fig. 7, 9",
          Compare(_of("pillar_proposed", "mean_abs_dqdot_seen"), ">",
                  _of("pillar_proposed", "mean_abs_dqdot_clear"))),
    Claim("The robot moves around the obstacle and reaches the targets.", "V.B, fig. 6, 10",
          All((_targets("pillar_proposed", ">=", 2, "least"),
               _none("penetration_samples", ("pillar_proposed",))))),
    Claim("In some cases the minimum distances fall below the predefined values.", "V.B, fig. 9",
          Compare(_of("pillar_proposed", "min_distance_axis_m", "least"), "<", D_R)),
    Claim("This is caused by the small coverage of the sensors: the same controller keeps the distances "
          "where it is told them all.", "V.B",
          _distance(("true_pillar",), D_R)),
    Claim("Obstacles slide into the sensing cones from the side, causing sudden spikes.", "V.B, fig. 9",
          Compare(_of("pillar_proposed", "sudden_obstacles"), ">=", 1.0)),
    Claim("The start is singular, and the damping effect moves the robot out of the singularity.",
          "V.B, fig. 10",
          All((Compare(_of("pillar_proposed", "start_manipulability", "greatest"), "<", 1e-3),
               Compare(_of("pillar_proposed", "escape_time_s", "greatest"), "<=", 2.0)))),
    Claim("A cycle takes longer than one of the repulsive method: 7.8 against 4.2 ms.", "V.B",
          CycleTimes("c", longer=True)),
    Claim("Targets are reached faster than with tangential motions.", "V.C, fig. 10",
          _more("targets_reached", "pillar_proposed", "pillar_tangential")),
    Claim("With repulsive motions the robot gets stuck in a local minimum.", "V.C, fig. 10",
          _targets("pillar_repulsive", "<=", 1)),
    Claim("The gap is just large enough to slide through while maintaining the safety distance.",
          "V.C, fig. 11",
          _distance(("gap_proposed",), D_R)),
    Claim("The proposed method goes through between the obstacles, and moves between both targets.",
          "V.C, fig. 11b, 13",
          All((_targets("gap_proposed", ">=", 2, "least"),
               Compare(_of("gap_proposed", "passes_between", "least"), ">=", 2)))),
    Claim("With the tangential method the robot has difficulties reaching the target.", "V.C, fig. 13",
          _more("targets_reached", "gap_proposed", "gap_tangential")),
    Claim("The tangential method moves in front of the obstacles, tangentially.", "V.C, fig. 11c",
          _more("path_per_straight", "gap_tangential", "gap_proposed")),
    Claim("The repulsive method fails, stuck in a local minimum.", "V.C, fig. 11d, 13",
          _targets("gap_repulsive", "<=", 1)),
    Claim("Repulsive motions maintain the minimum distance most of the time, while the other methods fall "
          "below these thresholds.", "V.C, fig. 12",
          All((Compare(_of("gap_repulsive", "time_below_d0l_fraction"), "<", 0.5),
               _more("time_below_d0l_fraction", "gap_proposed", "gap_repulsive"),
               _more("time_below_d0l_fraction", "gap_tangential", "gap_repulsive")))),
    Claim("An obstacle in the path of the end-effector deflects it.", "V.D, fig. 8",
          Compare(_of("moving_dynamic", "deflection_m"), ">=", 0.05)),
    Claim("The robot avoids what approaches its links, while it tries to maintain the end-effector's motion.",
          "V.D, fig. 8",
          All((_none("penetration_samples", ("moving_dynamic",)),
               _targets("moving_dynamic", ">=", 2, "least")))),
    Claim("Compared to the simulation, the minimum distances fall below the thresholds more often.",
          "V.D, fig. 15",
          _more("time_below_dr_fraction", "moving_dynamic", "moving_kinematic")),
    Claim("This is caused by the control cabinet, which does not apply the correction motions immediately "
          "(here: with true distances, so that nothing else differs, distances dip further behind it).",
          "V.D, fig. 15",
          All(tuple(_more("min_distance_axis_m", f"true_{scene}", f"cabinet_{scene}")
                    for scene in ("pillar", "moving")))),
    Claim("Especially at link 3 (here: the hand).", "V.D, fig. 15",
          All(tuple(Compare(_of("moving_dynamic", "link_below_dr_fraction.hand"), ">",
                            _of("moving_dynamic", f"link_below_dr_fraction.{link}"))
                    for link in ("upper_arm", "forearm")))),
    Claim("Disturbances of the joints are less prominent, as the control cabinet smooths them.",
          "V.D, fig. 14",
          _more("mean_abs_joint_jump", "moving_kinematic", "moving_dynamic")),
    Claim("Less path deviation.", "VI",
          _more("path_per_straight", "gap_tangential", "gap_proposed")),
    Claim("With a full coverage skin safety can be increased (here: true distances).", "VI",
          All((_more("time_below_dr_fraction", "moving_kinematic", "true_moving"),
               _more("time_below_dr_fraction", "pillar_proposed", "true_pillar")))),
)  # fmt: skip
"""What the paper says, in its order."""

SKIN = tuple(f"{scene}_{method}" for scene in ("pillar", "gap") for method in METHODS)
IMPROVED = tuple(f"improved_{scene}" for scene in SCENES)
KINEMATIC = (*SKIN, "moving_kinematic", *(f"true_{scene}" for scene in SCENES), *IMPROVED, "dense_moving",
             *(f"noise_{method}" for method in METHODS))  # fmt: skip
PROPOSED = ("pillar_proposed", "gap_proposed", "moving_kinematic", "moving_dynamic")

BEYOND = (
    Claim("The proposed method reaches at least 7 targets in pillar and 12 in gap.", "skin",
          All((_targets("pillar_proposed", ">=", 7), _targets("gap_proposed", ">=", 12)))),
    Claim("The repulsive method reaches at most 1 in both.", "skin",
          All((_targets("pillar_repulsive", "<=", 1), _targets("gap_repulsive", "<=", 1)))),
    Claim("The tangential method reaches fewer targets in gap, or as many at a smaller least distance.",
          "skin",
          _slower_or_nearer("gap")),
    Claim("No solver failure, no limit violation.", "skin",
          All((_none("solver_failures", SKIN, "pillar and gap"),
               _none("limit_violations", SKIN, "pillar and gap")))),
    Claim("No penetration with the proposed method.", "skin",
          _none("penetration_samples", PROPOSED, "pillar, gap, moving")),
    Claim("The improved method reaches at least 8 targets in pillar, 12 in gap, 6 in facing.",
          "true distances",
          All((_targets("improved_pillar", ">=", 8), _targets("improved_gap", ">=", 12),
               _targets("improved_facing", ">=", 6)))),
    Claim("In facing the paper's method stops.", "true distances", _targets("true_facing", "<=", 1)),
    Claim("The least distance stays at least 0.17 m, also where obstacles move at 0.2 m/s.",
          "true distances",
          _distance(IMPROVED, D_R, "improved, all scenes")),
    Claim("The commands are smooth: they change by at most 15 mrad/s per cycle in the mean, and never by "
          "more than 0.5 rad/s.", "true distances",
          All((*(Compare(_of(name, "mean_abs_dqdot"), "<=", 0.015) for name in IMPROVED),
               Compare(Quantity(IMPROVED, "max_abs_dqdot", "greatest", "improved, all scenes"), "<=", 0.5)))),
    Claim("With moving obstacles the improved and denser skin spends at most half of the paper's time below "
          "d_r, without penetration.", "skin, dense",
          All((Compare(_of("dense_moving", "time_below_dr_fraction"), "<=",
                       _of("moving_kinematic", "time_below_dr_fraction"), 0.5),
               _none("penetration_samples", ("dense_moving",))))),
    Claim("With 5 mm of noise and 5 % lost samples the claims about gap still hold.", "noise",
          All((_targets("noise_proposed", ">=", 12), _targets("noise_repulsive", "<=", 1),
               _slower_or_nearer("noise"), _none("penetration_samples", ("noise_proposed",))))),
    Claim("The compiled controller equals the reference in every scene and mode.", "agreement", Agreed()),
    Claim("No joint limit is passed by more than 1e-9 rad on the kinematic plant.", "all runs",
          _none("limit_violations", KINEMATIC, "all runs")),
    Claim("Cycles are faster than the paper's, also when called from Python.", "cycle times",
          CycleTimes("python", longer=False)),
    Claim("All of this is reproduced by one command, in time.", "this call", InTime()),
)  # fmt: skip
"""What proxgen sets itself beyond the paper."""
