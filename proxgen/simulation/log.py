"""RolloutLog: everything that happened in a closed loop, cycle by cycle, saved whole."""

import json
import zipfile
from collections import Counter
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from proxgen.controllers.protocol import Status
from proxgen.errors import SimulationError
from proxgen.files import whole_file

Array = NDArray[np.float64]

LIMIT_TOLERANCE = 1e-9
"""A joint counts as outside its limits if it is so by more than this [rad or m]."""


@dataclass(frozen=True)
class RolloutLog:
    """A closed loop of T cycles with n joints, m task rows, S range sensors, C switches, L capsules.

    Attributes:
        time: (T,) of each cycle [s].
        q: (T, n) joint positions before the command [rad or m].
        qdot: (T, n) command [rad/s or m/s].
        xdot: (T, m) task velocity asked for [m/s, rad/s].
        tool_position: (T, 3) task point, world [m].
        tool_rotation: (T, 3, 3) tool frame to world.
        target_index: (T,) which target is pursued.
        target_position: (T, 3) where it is, world [m].
        target_distance: (T,) to it, over the task's position rows [m].
        targets_reached: (T,) how many targets were reached up to this cycle.
        tof_range: (T, S) readings that the controller got [m].
        capacitive: (T, C) switches as the controller got them.
        status: (T,) numbers of `Status`.
        controller_distance: (T, L) nearest distance that the controller found, in its reference [m].
        true_axis_distance: (T, L) from the capsule's axis to the nearest obstacle's surface [m].
        true_surface_distance: (T, L) from the capsule's surface; negative: penetration [m].
        manipulability: (T,) w of (14).
        damping: (T,) lambda of (15).
        kkt_residual: (T,) of the certificate; nan if nothing was solved.
        cycle_us: (T,) wall time of `controller.step` [us].
        meta: scene, robot, controller, method, backend, sensing, plant, seed, period, thresholds, schedule,
            distance_reference, q_lower, q_upper, qdot_limit, joint_names, capsule_names, capsule_radii,
            targets, obstacles: numbers, texts and lists.
    """

    time: Array
    q: Array
    qdot: Array
    xdot: Array
    tool_position: Array
    tool_rotation: Array
    target_index: NDArray[np.int64]
    target_position: Array
    target_distance: Array
    targets_reached: NDArray[np.int64]
    tof_range: Array
    capacitive: NDArray[np.bool_]
    status: NDArray[np.int64]
    controller_distance: Array
    true_axis_distance: Array
    true_surface_distance: Array
    manipulability: Array
    damping: Array
    kkt_residual: Array
    cycle_us: Array
    meta: dict[str, Any]

    def save(self, path: Path) -> None:
        """Write a compressed npz file, whole or not at all; folders are made.

        Raises:
            SimulationError: it cannot be written.
        """
        arrays = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "meta"}
        text = json.dumps(self.meta, sort_keys=True).encode()
        try:
            with whole_file(path) as file:
                np.savez_compressed(file, meta=np.frombuffer(text, dtype=np.uint8), **arrays)
        except OSError as error:
            raise SimulationError(f"cannot write the log {path}: {error.strerror}") from error

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a log that `save` wrote.

        Raises:
            SimulationError: no such file, or not a log.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                meta = json.loads(file["meta"].tobytes().decode())
                names = [field.name for field in fields(cls) if field.name != "meta"]
                return cls(**{name: file[name] for name in names}, meta=meta)
        except OSError as error:
            raise SimulationError(f"cannot read the log {path}: {error.strerror or error}") from error
        except (KeyError, ValueError, zipfile.BadZipFile) as error:
            raise SimulationError(f"{path} is not a rollout log: {error}") from error

    @property
    def cycles(self) -> int:
        """Number of control cycles T."""
        return len(self.time)

    def reference_distance(self) -> Array:
        """(T, L) true distances in the configured reference, axis or surface [m]."""
        surface = self.meta["distance_reference"] == "surface"
        return self.true_surface_distance if surface else self.true_axis_distance

    def dqdot(self) -> Array:
        """(T, n) change of the command in each cycle; the arm is at rest before the first one."""
        return np.diff(self.qdot, axis=0, prepend=np.zeros((1, self.qdot.shape[1])))

    def outside_limits(self) -> NDArray[np.bool_]:
        """(T,) whether any joint is outside its limits by more than `LIMIT_TOLERANCE`."""
        lower, upper = np.array(self.meta["q_lower"]), np.array(self.meta["q_upper"])
        below, above = self.q < lower - LIMIT_TOLERANCE, self.q > upper + LIMIT_TOLERANCE
        return np.asarray((below | above).any(axis=1))

    def summary(self) -> dict[str, Any]:
        """The figures of the run, with the keys of `proxgen run --json`.

        `time_below_dr_fraction`, `penetration_samples` and `limit_violations` count cycles in which some
        capsule or joint is concerned; distances are true ones, over all cycles and capsules (null without an
        obstacle); the changes of the command are per joint and cycle [rad/s].
        """
        counts = Counter(Status(number).name for number in self.status.tolist())
        below = (self.reference_distance() < self.meta["thresholds"]["d_r"]).any(axis=1)
        change = np.abs(self.dqdot())
        p50, p99, p999 = (float(value) for value in np.percentile(self.cycle_us, [50.0, 99.0, 99.9]))
        return {
            "scene": self.meta["scene"],
            "controller": self.meta["controller"],
            "backend": self.meta["backend"],
            "sensing": self.meta["sensing"],
            "seed": self.meta["seed"],
            "duration_s": self.cycles * self.meta["period"],
            "cycles": self.cycles,
            "targets_reached": int(self.targets_reached[-1]),
            "min_distance_axis_m": _least(self.true_axis_distance),
            "min_distance_surface_m": _least(self.true_surface_distance),
            "time_below_dr_fraction": float(below.mean()),
            "penetration_samples": int((self.true_surface_distance < 0.0).any(axis=1).sum()),
            "mean_abs_dqdot": float(change.mean()),
            "max_abs_dqdot": float(change.max()),
            "status_counts": dict(sorted(counts.items())),
            "solver_failures": counts[Status.STOPPED_SOLVER.name],
            "limit_violations": int(self.outside_limits().sum()),
            "cycle_us": {"p50": p50, "p99": p99, "p999": p999, "max": float(self.cycle_us.max())},
        }


def _least(distances: Array) -> float | None:
    """The least distance, or None where there is no obstacle."""
    least = float(distances.min(initial=np.inf))
    return least if np.isfinite(least) else None
