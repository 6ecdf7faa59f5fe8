"""Logs and comparisons that are made up: any number of joints, any statuses, no simulation."""

from dataclasses import replace
from typing import Any

import numpy as np

from proxgen.compare import Comparison, SceneComparison, Tolerances
from proxgen.compare.judge import QUANTITIES
from proxgen.controllers.protocol import Status
from proxgen.model import RobotModel
from proxgen.simulation.log import RolloutLog

PERIOD = 0.02
BOX = {
    "name": "box", "shape": "box", "half_size": [0.25, 0.05, 0.1], "radius": 0.0, "length": 0.0,
    "position": [0.5, 0.0, 0.1], "rotation": np.eye(3).tolist(), "motion": None,
}  # fmt: skip
BALL = BOX | {
    "name": "ball", "shape": "sphere", "half_size": [0.0] * 3, "radius": 0.08, "position": [1.0, 0.0, 0.5],
    "motion": {"direction": [-1, 0, 0], "distance": 0.4, "speed": 0.2, "hold": 3, "period": 20, "phase": 0},
}  # fmt: skip
ROD = BOX | {"name": "rod", "shape": "capsule", "half_size": [0.0] * 3, "radius": 0.05, "length": 0.3}


def make_log(joints: int = 3, capsules: int = 2, cycles: int = 200, **meta: Any) -> RolloutLog:
    """A log of smooth curves: the tool goes to and fro between two targets, reached every 50 cycles."""
    time = np.linspace(0.0, (cycles - 1) * PERIOD, cycles)
    sway = np.cos(2.0 * np.pi * time / 2.0)
    wave = np.sin(time[:, None] + np.arange(joints))
    distance = 0.25 + 0.1 * np.sin(2.0 * time[:, None] + np.arange(capsules))
    index = np.arange(cycles) // 50
    return RolloutLog(
        time=time,
        q=wave,
        qdot=0.5 * wave,
        xdot=np.zeros((cycles, 3)),
        tool_position=np.stack([0.5 + 0.0 * sway, 0.45 * sway, 0.4 + 0.1 * sway**2], axis=1),
        tool_rotation=np.tile(np.eye(3), (cycles, 1, 1)),
        target_index=index % 2,
        target_position=np.zeros((cycles, 3)),
        target_distance=np.array([0.9 - 0.88 * (cycle % 50) / 49.0 for cycle in range(cycles)]),
        targets_reached=index,
        tof_range=np.ones((cycles, 4)),
        capacitive=np.zeros((cycles, 4), dtype=bool),
        status=np.where(np.arange(cycles) == 60, int(Status.STOPPED_INFEASIBLE), int(Status.SOLVED)),
        controller_distance=np.where(distance < 0.3, distance + 0.01, np.inf),
        true_axis_distance=distance,
        true_surface_distance=distance - 0.07,
        manipulability=0.1 + 0.0 * time,
        damping=1e-3 + 0.0 * time,
        kkt_residual=np.where(np.arange(cycles) % 7 == 0, 0.0, 1e-15),
        cycle_us=5.0 + 2.0 * np.abs(sway),
        meta={
            "scene": "made_up", "robot": "arm", "controller": "compiled", "backend": "daqp",
            "sensing": "skin", "plant": "KinematicPlant", "seed": 0, "period": PERIOD,
            "thresholds": {"d_a": 0.3, "d_0u": 0.25, "d_0l": 0.22, "d_r": 0.17}, "distance_reference": "axis",
            "schedule": "paper",
            "q_lower": [-2.0] * joints, "q_upper": [2.0] * joints, "qdot_limit": [1.5] * joints,
            "joint_names": [f"joint_{number}" for number in range(joints)],
            "capsule_names": [f"link_{number}" for number in range(capsules)],
            "capsule_radii": [0.07] * capsules, "targets": [[0.5, 0.45, 0.4], [0.5, -0.45, 0.4]],
            "obstacles": [BOX, BALL],
        } | meta,
    )  # fmt: skip


def make_arm_log(model: RobotModel, cycles: int = 200, **meta: Any) -> RolloutLog:
    """A made-up log with an arm's joints, capsules and sensors, which see nothing."""
    log = make_log(model.n, len(model.capsules), cycles, robot=model.name, **meta)
    return replace(
        log,
        tof_range=np.ones((cycles, len(model.tof_modules))),
        capacitive=np.zeros((cycles, len(model.capacitive_modules)), dtype=bool),
    )


def make_comparison(qdot_error: float = 1e-13, mismatches: int = 0) -> Comparison:
    """Two scenes of 100 cycles; the second has the given error and mismatches."""
    scenes = []
    for name, error, wrong in (("first", 0.0, 0), ("second", qdot_error, mismatches)):
        reference = np.zeros(100, dtype=np.int64)
        status = np.where(np.arange(100) < wrong, int(Status.REDUCED_ACTIVE), reference)
        findings = [f"{name}, cycle {cycle}: status" for cycle in range(wrong)]
        findings += [f"{name}, cycle 3: qdot <differs>"] if error > Tolerances().qdot else []
        errors = {quantity: np.full(100, error) for quantity in QUANTITIES}
        errors["slack"] = np.full(100, np.nan)
        scenes.append(
            SceneComparison(
                name, np.linspace(0.0, 1.98, 100), errors, status, reference, np.zeros(100, dtype=np.int64),
                tuple(findings), len(findings),
            )
        )  # fmt: skip
    return Comparison(tuple(scenes), Tolerances())
