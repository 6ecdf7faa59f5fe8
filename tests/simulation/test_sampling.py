"""Rates, holding, latency, noise and dropouts of sampled sensors."""

import numpy as np
import pytest
from numpy.typing import NDArray

from proxgen.simulation.sampling import SampledGroup, Timing

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class Ramp:
    """Sensors that read the time at which they are asked, and remember that they were."""

    def __init__(self) -> None:
        self.asked: list[float] = []

    def __call__(self, time: float, indices: Indices, noise: Array) -> Array:
        self.asked.append(time)
        return np.full(len(indices), time) + noise


def group(timing: Timing, count: int = 4, seed: int = 1) -> SampledGroup:
    return SampledGroup(np.arange(count), timing, np.random.SeedSequence(seed))


def test_a_slow_sensor_is_held_between_its_samples() -> None:
    sensor, ramp = group(Timing(rate=20.0)), Ramp()
    readings, ages = zip(
        *(sensor.update(time, ramp) for time in (0.0, 0.02, 0.04, 0.06, 0.1, 0.12)), strict=True
    )
    np.testing.assert_allclose([r[0] for r in readings], [0.0, 0.0, 0.0, 0.05, 0.1, 0.1], atol=1e-12)
    np.testing.assert_allclose([a[0] for a in ages], [0.0, 0.02, 0.04, 0.01, 0.0, 0.02], atol=1e-12)
    np.testing.assert_allclose(ramp.asked, [0.0, 0.05, 0.1], atol=1e-12)


def test_a_fast_sensor_gives_its_latest_sample_and_measures_no_other() -> None:
    sensor, ramp = group(Timing(rate=1000.0)), Ramp()
    for index in range(50):
        readings, age = sensor.update(index / 50, ramp)
        np.testing.assert_allclose(readings, index / 50, atol=1e-9)
        np.testing.assert_allclose(age, 0.0, atol=1e-9)
        assert (age >= 0.0).all()
    assert len(ramp.asked) == 50


def test_latency_delays_samples_and_shows_in_their_age() -> None:
    sensor, ramp = group(Timing(rate=100.0, latency=0.035)), Ramp()
    for index in range(20):
        time = index * 0.02
        readings, age = sensor.update(time, ramp)
        newest = np.floor((time - 0.035) * 100.0 + 1e-9) / 100.0
        np.testing.assert_allclose(readings, newest, atol=1e-12)
        np.testing.assert_allclose(age, time - newest, atol=1e-12)
        assert (age >= 0.035 - 1e-9).all()


def test_lost_samples_leave_the_older_one_in_place() -> None:
    sensor, ramp = group(Timing(rate=100.0, dropout=0.3), count=200), Ramp()
    ages = []
    for index in range(100):
        readings, age = sensor.update(index * 0.02, ramp)
        np.testing.assert_allclose(readings, index * 0.02 - age, atol=1e-9)
        ages.append(age)
    assert (ages[0] == 0.0).all()  # they ran before the start
    late = np.concatenate(ages[20:])
    for samples in range(4):
        fraction = (np.abs(late - samples * 0.01) < 1e-9).mean()
        assert fraction == pytest.approx(0.7 * 0.3**samples, abs=0.015)


def test_a_first_sample_is_never_lost() -> None:
    """The sensors ran before: what is held at first is a sample, and not zero."""
    readings, ages = group(Timing(rate=100.0, dropout=0.9), count=50).update(0.5, Ramp())
    np.testing.assert_allclose(readings, 0.5, atol=1e-12)
    np.testing.assert_allclose(ages, 0.0, atol=1e-12)


def test_noise_has_its_standard_deviation_and_each_sensor_its_own() -> None:
    sensor = group(Timing(rate=50.0, noise=0.005), count=100)
    readings = np.array([sensor.update(i / 50, lambda _t, k, noise: 0.4 + noise)[0] for i in range(200)])
    assert readings.std() == pytest.approx(0.005, rel=0.02)
    assert readings.mean() == pytest.approx(0.4, abs=2e-4)
    assert abs(np.corrcoef(readings[:, 0], readings[:, 1])[0, 1]) < 0.25


def test_luck_does_not_depend_on_how_often_one_asks() -> None:
    timing = Timing(rate=100.0, dropout=0.2, noise=0.01)
    often, rarely, ramp = group(timing, 30, seed=3), group(timing, 30, seed=3), Ramp()
    for index in range(101):
        readings, age = often.update(index * 0.01, ramp)
        if index % 5 == 0:
            same_readings, same_age = rarely.update(index * 0.01, ramp)
            np.testing.assert_array_equal(readings, same_readings)
            np.testing.assert_array_equal(age, same_age)


def test_the_seed_decides() -> None:
    def run(seed: int) -> Array:
        sensor = group(Timing(rate=100.0, dropout=0.2, noise=0.01), 5, seed)
        return np.array([sensor.update(i * 0.02, Ramp())[0] for i in range(20)])

    np.testing.assert_array_equal(run(1), run(1))
    assert not np.array_equal(run(1), run(2))
