"""From many times to one row of results."""

from typing import Any

import numpy as np

from proxgen.controllers.protocol import Array


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
