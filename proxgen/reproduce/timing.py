"""Cycle times of two methods side by side: the same machine, the same moment, nothing else at work."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from proxgen.builder.sources import digest
from proxgen.config.hashing import config_hash
from proxgen.config.scene import load_scene
from proxgen.reproduce.store import Store
from proxgen.reproduce.tasks import open_controller, sources, variant

if TYPE_CHECKING:
    from proxgen.bench.inputs import Inputs
    from proxgen.controllers.protocol import Controller

SCENE = "gap"
"""The recorded scene: obstacles near most of the time."""


@dataclass(frozen=True)
class Timing:
    """Times of controllers that replay their own recorded closed loops, taking turns.

    Attributes:
        configuration: YAML file.
        libraries: folder of the compiled controller by method.
        duration: of what is recorded [s].
        passes: how often it is replayed.
    """

    configuration: Path
    libraries: dict[str, Path]
    duration: float
    passes: int

    @property
    def name(self) -> str:
        """Of its record."""
        return "cycle_times"

    @property
    def cost(self) -> float:
        """About how long it takes."""
        return 4.0 * self.duration

    def fingerprint(self) -> str:
        """Digest of everything that its result depends on, but for the machine."""
        hashes = [config_hash(variant(self.configuration, method)) for method in self.libraries]
        return digest([sources(), hashes, self.duration, self.passes])

    def carry_out(self, store: Store) -> None:
        """Record, replay, keep the times: from Python, and, of compiled controllers, from C."""
        from proxgen.bench.inputs import record
        from proxgen.bench.timing import time_steps
        from proxgen.model import build_model

        ready: dict[str, tuple[Controller, Inputs]] = {}
        for method, library in self.libraries.items():
            config = variant(self.configuration, method)
            controller = open_controller(library)
            scene = load_scene(SCENE, beside=self.configuration)
            ready[method] = (
                controller,
                record(config, build_model(config), controller, scene, self.duration),
            )
        from_python: dict[str, list[NDArray[np.float64]]] = {method: [] for method in ready}
        for _ in range(self.passes):
            for method, (controller, inputs) in ready.items():
                from_python[method].append(1e6 * time_steps(controller, inputs.just_made()))
        numbers: dict[str, Any] = {}
        for method, library in self.libraries.items():
            numbers[method] = {
                "python": _times(np.concatenate(from_python[method])),
                "c": self._from_c(method, library, ready[method][1]),
            }
        store.save(self.name, self.fingerprint(), numbers)

    def _from_c(self, method: str, library: Path, inputs: "Inputs") -> dict[str, float]:
        """The same cycles through a C program with the flags of the product."""
        from proxgen.bench.replay import replay
        from proxgen.builder.program import compile_program
        from proxgen.builder.sources import runtime_directory

        backend = variant(self.configuration, method).solver.backend
        with tempfile.TemporaryDirectory(prefix="proxgen-times-") as name:
            work = Path(name)
            main = runtime_directory() / "bench" / "replay.c"
            program = compile_program(main, library / "generated", backend, work / "replay")
            return _times(1e6 * replay(program, inputs, backend, work, self.passes).whole.ravel())


def _times(times: NDArray[np.float64]) -> dict[str, float]:
    """Mean, as in the paper, and percentiles [us]."""
    p50, p99, p999 = np.percentile(times, [50.0, 99.0, 99.9])
    return {
        "mean_us": float(times.mean()), "p50_us": float(p50), "p99_us": float(p99), "p999_us": float(p999),
        "max_us": float(times.max()),
    }  # fmt: skip
