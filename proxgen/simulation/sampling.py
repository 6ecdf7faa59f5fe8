"""When sensors sample, and what is held between samples: rate, latency, noise and dropouts.

A sensor samples at the times k/rate, and each sample arrives `latency` later. A controller that asks at time
t gets the latest sample that has arrived and was not lost, together with its age. Only samples that some
sensor delivers are ever measured, although luck (noise, loss) is drawn for every one of them: the result does
not depend on how often the controller asks.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Measure = Callable[[float, NDArray[np.intp], Array], Array]
"""(time [s], sensor indices (K,), noise (K,) to be added to what they see) -> their readings (K,)."""

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Timing:
    """How a group of equal sensors samples.

    Attributes:
        rate: [Hz].
        latency: from sampling to arrival [s].
        dropout: probability that a sample is lost.
        noise: standard deviation of a reading; 0 draws none.
    """

    rate: float
    latency: float = 0.0
    dropout: float = 0.0
    noise: float = 0.0


class SampledGroup:
    """Equal sensors: each holds its last delivered sample.

    Attributes:
        indices: (G,) of its sensors in the measurement.
        timing: of all of them.
    """

    def __init__(self, indices: NDArray[np.intp], timing: Timing, seed: np.random.SeedSequence) -> None:
        """Nothing is held before the first `update`."""
        self.indices = indices
        self.timing = timing
        loss_seed, noise_seed = seed.spawn(2)
        self._loss, self._noise = np.random.default_rng(loss_seed), np.random.default_rng(noise_seed)
        self._next: int | None = None
        self._held_index = np.zeros(len(indices), dtype=np.int64)
        self._held_value = np.zeros(len(indices))

    def update(self, time: float, measure: Measure) -> tuple[Array, Array]:
        """Deliver what has arrived at `time`.

        The sensors ran before the first call: its samples all arrived.

        Args:
            time: not before that of the call before [s].
            measure: gives readings of sensors of this group, by their index in the measurement.

        Returns:
            Readings (G,) and their ages (G,) [s].
        """
        newest = math.floor((time - self.timing.latency) * self.timing.rate + _ROUNDING)
        first = newest if self._next is None else self._next
        count = max(newest - first + 1, 0)
        lost = self._draw_lost(count)
        noise = self._draw_noise(count)
        if self._next is None:
            lost[:] = False
        self._next = first + count
        if count:
            arrived = ~lost
            fresh = arrived.any(axis=0)
            latest = count - 1 - np.argmax(arrived[::-1], axis=0)
            for row in np.unique(latest[fresh]):
                chosen = np.flatnonzero(fresh & (latest == row))
                sampled = (first + int(row)) / self.timing.rate
                self._held_value[chosen] = measure(sampled, self.indices[chosen], noise[row, chosen])
                self._held_index[chosen] = first + int(row)
        age: Array = np.maximum(time - self._held_index / self.timing.rate, 0.0)
        return self._held_value.copy(), age

    def _draw_lost(self, count: int) -> NDArray[np.bool_]:
        shape = (count, len(self.indices))
        if self.timing.dropout == 0.0:
            return np.zeros(shape, dtype=bool)
        return self._loss.random(shape) < self.timing.dropout

    def _draw_noise(self, count: int) -> Array:
        shape = (count, len(self.indices))
        return (
            self._noise.normal(0.0, self.timing.noise, shape) if self.timing.noise > 0.0 else np.zeros(shape)
        )
