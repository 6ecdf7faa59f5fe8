"""Whatever goes in, a velocity comes out that is finite, within its bounds, and certified if it says so."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from proxgen.builder import build
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import OFF, Array, Command, Measurement, Status
from proxgen.errors import ControllerError

N, TOF, CAPACITIVE = 2, 4, 4  # of planar2
ANY = st.floats(width=64)
FEW = settings(max_examples=60, deadline=None, derandomize=True)


@pytest.fixture(scope="module", params=["daqp", "qpoases"])
def either(
    request: pytest.FixtureRequest, planar2_config: Config, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """The planar arm, over each of the solvers."""
    folder = tmp_path_factory.mktemp(request.param)
    return build(planar2_config, folder / "built", backend=request.param).library_dir


def usual(low: float, high: float, count: int) -> st.SearchStrategy[Array]:
    """Vectors of what a working robot sends."""
    return arrays(np.float64, count, elements=st.floats(low, high, allow_subnormal=False))


def measurements(
    low: float, high: float, values: st.SearchStrategy[float] | None = None
) -> st.SearchStrategy[Measurement]:
    """Measurements of something, at time 0; `values` in place of ranges, ages and places, if given."""

    def vector(low: float, high: float, count: int) -> st.SearchStrategy[Array]:
        return arrays(np.float64, count, elements=values) if values is not None else usual(low, high, count)

    points = st.integers(0, 6).flatmap(lambda count: vector(-1.5, 1.5, 3 * count))
    return st.builds(
        Measurement,
        time=st.just(0.0),
        tof_range=vector(low, high, TOF),
        capacitive=arrays(np.bool_, CAPACITIVE),
        tof_age=st.none() | vector(0.0, 0.09, TOF),
        capacitive_age=st.none() | vector(0.0, 0.09, CAPACITIVE),
        points=points.map(lambda values: values.reshape(-1, 3)),
    )


def at(seen: Measurement, time: float) -> Measurement:
    """The same at another time."""
    return Measurement(time, seen.tof_range, seen.capacitive, seen.tof_age, seen.capacitive_age, seen.points)


def check(command: Command, limit: Array) -> None:
    """What every command promises."""
    found, qdot = command.diagnostics, command.qdot
    assert np.all(np.isfinite(qdot))
    assert np.all((qdot >= found.lb) & (qdot <= found.ub) & (np.abs(qdot) <= limit))
    assert command.status.success == (found.kkt_residual <= 1e-8)
    if command.status == Status.SOLVED:
        assert np.all(found.A @ qdot <= found.ubA + 1e-8)


WORKING = st.tuples(usual(-2.5, 2.5, N), usual(-0.5, 0.5, N), measurements(0.0, 0.3))
ANYTHING = st.tuples(
    arrays(np.float64, N, elements=ANY),
    arrays(np.float64, N, elements=ANY),
    measurements(0.0, 1.0, ANY),
)


@FEW
@given(cycles=st.lists(st.tuples(WORKING | ANYTHING, ANY | st.just(0.02)), max_size=8))
def test_any_input(either: Path, cycles: list[tuple[tuple[Array, Array, Measurement], float]]) -> None:
    controller, time = CompiledController.load(either), 0.0
    limit = np.asarray(controller.parameters["qdot_limit"])
    for (q, xdot, seen), elapsed in cycles:
        time += elapsed
        check(controller.step(q, xdot, at(seen, time)), limit)
        if not np.isfinite(time):
            time = 0.0
            controller.reset()
    assert controller.counters.cycles == len(cycles) == sum(controller.counters.status_count.values())


@FEW
@given(cycle=WORKING, others=arrays(np.float64, (20, N), elements=st.floats(-3.0, 3.0)))
def test_nothing_that_is_allowed_is_better(
    either: Path, cycle: tuple[Array, Array, Measurement], others: Array
) -> None:
    q, xdot, seen = cycle
    command = CompiledController.load(either).step(q, xdot, at(seen, 1.0))
    found = command.diagnostics
    assume(command.status == Status.SOLVED)
    for other in np.clip(others, found.lb, found.ub):
        if np.all(found.A @ other <= found.ubA):
            cost, least = (0.5 * x @ found.H @ x + found.g @ x for x in (other, command.qdot))
            assert least <= cost + 1e-9


@FEW
@given(cycles=st.lists(WORKING, min_size=1, max_size=6))
def test_the_same_inputs_give_the_same_bits(
    either: Path, cycles: list[tuple[Array, Array, Measurement]]
) -> None:
    first, again = CompiledController.load(either), CompiledController.load(either)
    again.step(np.array([0.3, 0.3]), np.array([0.2, 0.0]), at(cycles[0][2], 5.0))
    again.reset()
    for index, (q, xdot, seen) in enumerate(cycles):
        commands = [controller.step(q, xdot, at(seen, 0.02 * index)) for controller in (first, again)]
        assert commands[0].qdot.tobytes() == commands[1].qdot.tobytes()
        assert commands[0].status == commands[1].status


@FEW
@given(data=st.data(), cycle=WORKING)
def test_any_parameters(either: Path, data: st.DataObject, cycle: tuple[Array, Array, Measurement]) -> None:
    controller = CompiledController.load(either)
    before = controller.parameters
    names = data.draw(st.lists(st.sampled_from(sorted(before)), min_size=1, max_size=3, unique=True))
    factor = st.floats(0.1, 10.0) | ANY
    changed = {name: np.multiply(before[name], data.draw(factor)) for name in names}
    try:
        controller.set_parameters(**changed)
    except ControllerError as error:
        assert any(name in str(error) for name in names)
        changed = {}
    after = controller.parameters
    for name, value in before.items():
        np.testing.assert_array_equal(after[name], changed.get(name, value))
    q, xdot, seen = cycle
    command = controller.step(q, xdot, at(seen, 1.0))
    check(command, np.asarray(after["qdot_limit"]))
    assert np.all(command.diagnostics.ubA <= OFF)
