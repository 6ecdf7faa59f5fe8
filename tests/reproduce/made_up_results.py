"""Results that are made up, and in which every claim holds."""

import copy
from pathlib import Path
from typing import Any

from proxgen.reproduce.plan import Plan, quick_plan
from proxgen.reproduce.results import Results
from proxgen.reproduce.store import Store

RUN: dict[str, Any] = {
    "targets_reached": 13, "min_distance_axis_m": 0.2, "min_distance_surface_m": 0.13,
    "time_below_dr_fraction": 0.05, "time_below_d0l_fraction": 0.4,
    "link_below_dr_fraction": {"upper_arm": 0.0, "forearm": 0.01, "hand": 0.05},
    "penetration_samples": 0, "limit_violations": 0, "solver_failures": 0, "mean_abs_dqdot": 0.01,
    "max_abs_dqdot": 0.4, "mean_abs_dqdot_seen": 0.03, "mean_abs_dqdot_clear": 0.01,
    "mean_abs_dqdot_switching": 0.05, "mean_abs_dqdot_steady": 0.01, "mean_abs_joint_jump": 0.01,
    "sudden_obstacles": 3, "start_manipulability": 1e-4, "escape_time_s": 0.5, "path_per_straight": 1.1,
    "deflection_m": 0.1, "passes_between": 10, "last_motion_m": 0.0,
}  # fmt: skip
"""Numbers of a run, where an experiment has no others."""

OTHERS: dict[str, dict[str, Any]] = {
    "pillar_proposed": {"min_distance_axis_m": 0.11},
    "pillar_tangential": {"targets_reached": 9},
    "gap_tangential": {"targets_reached": 9, "path_per_straight": 1.5},
    "noise_tangential": {"targets_reached": 9},
    "true_facing": {"targets_reached": 1},
    "moving_kinematic": {"time_below_dr_fraction": 0.06, "mean_abs_joint_jump": 0.02},
    "moving_dynamic": {"time_below_dr_fraction": 0.09},
    "cabinet_pillar": {"min_distance_axis_m": 0.19},
    "cabinet_moving": {"min_distance_axis_m": 0.19},
    "dense_moving": {"time_below_dr_fraction": 0.01},
}

TIMES = {"p50_us": 3.0, "p99_us": 5.0, "p999_us": 6.0, "max_us": 9.0}


def made_up_results(directory: Path, plan: Plan | None = None) -> Results:
    """Results of a plan; what `OTHERS` and the methods' names do not change is `RUN`."""
    plan = plan or quick_plan()
    numbers = {}
    for experiment in plan.experiments:
        run = copy.deepcopy(RUN) | OTHERS.get(experiment.name, {})
        if experiment.setup.method == "repulsive":
            run |= {"targets_reached": 1, "time_below_d0l_fraction": 0.1}
        if experiment.name.startswith("true_"):
            run |= {"time_below_dr_fraction": 0.0}
        numbers[experiment.name] = [copy.deepcopy(run) for _ in plan.starts]
    agreements = [
        {
            "setup": one.setup.name,
            "scene": one.scene,
            "sensing": one.sensing,
            "verdict": "pass",
            "failures": [],
            "max_abs_qdot_error": 1e-13,
        }
        for one in plan.agreements
    ]
    times = {
        method: {way: {"mean_us": mean, **TIMES} for way in ("c", "python")}
        for method, mean in (("proposed", 3.0), ("repulsive", 2.0))
    }
    return Results(plan, Store(directory), numbers, agreements, times, minutes=3.0)
