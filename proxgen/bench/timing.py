"""Times of a controller's steps from Python, and from many times to one row of results."""

import time
from collections.abc import Iterable
from typing import Any

import numpy as np

from proxgen.controllers.protocol import Array, Controller, Measurement


def time_steps(controller: Controller, cycles: Iterable[tuple[Array, Array, Measurement]]) -> Array:
    """Time of each call of `step` over recorded cycles, from a reset on.

    Args:
        controller: any.
        cycles: joint positions, task velocity and measurement of each.

    Returns:
        One time per cycle [s].
    """
    controller.reset()
    times = []
    for q, xdot, seen in cycles:
        begin = time.perf_counter_ns()
        controller.step(q, xdot, seen)
        times.append((time.perf_counter_ns() - begin) * 1e-9)
    return np.array(times)


def timing_row(name: str, backend: str, times: Array, **more: Any) -> dict[str, Any]:
    """One result: percentiles of times, as microseconds.

    Args:
        name: what was timed.
        backend: QP solver, or whose code it was.
        times: of single cycles [s].
        more: further entries.
    """
    p50, p99, p999 = np.percentile(times, [50.0, 99.0, 99.9], method="higher") * 1e6
    return {
        "name": name,
        "backend": backend,
        "p50_us": float(p50),
        "p99_us": float(p99),
        "p999_us": float(p999),
        "max_us": float(times.max() * 1e6),
        "cycles_per_s": float(1.0 / times.mean()) if times.mean() > 0.0 else float("inf"),
        **more,
    }
