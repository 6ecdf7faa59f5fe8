"""Self-measurement removal, memory and circulation in C: what the reference does, cycle by cycle."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arms import RECIPES, write_arm
from reference_tools import EXAMPLES

from proxgen.builder import build
from proxgen.compare import compare_controllers_on, random_states
from proxgen.compare.state import State
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Command, Controller, Measurement, Status
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel, build_model
from proxgen.model.kinematics import body_poses

ADDITIONS = """
avoidance: {circulation: {enabled: true}}
skin:
  self_measurement: {enabled: true}
  memory: {enabled: true, capacity: 6}
"""
RECIPE_NAMES = ("chain2", "mimic5")  # a task without y; a joint that follows another


def extended(base: Path, folder: Path, text: str = ADDITIONS) -> tuple[Config, RobotModel]:
    """A configuration with additions, and its model."""
    path = folder / "extended.yaml"
    path.write_text(f"extends: {base}\n{text}", encoding="utf-8")
    config = load(path)
    return config, build_model(config)


class Watched:
    """A controller that keeps the commands it gave."""

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.commands: list[Command] = []

    def __getattr__(self, name: str) -> object:
        return getattr(self.controller, name)

    def step(self, *arguments: object) -> Command:
        self.commands.append(self.controller.step(*arguments))  # type: ignore[arg-type]
        return self.commands[-1]


def check(config: Config, model: RobotModel, folder: Path, backend: str, count: int) -> None:
    """Both agree in everything that `proxgen compare` looks at, and the additions had something to do."""
    compiled = CompiledController.load(build(config, folder / "built", backend=backend).library_dir)
    reference = Watched(ReferenceController(config, model))
    states = random_states(config, model, count, seed=63)
    result = compare_controllers_on(config, states, compiled, reference)  # type: ignore[arg-type]
    assert result.verdict == "pass", "\n".join(result.failures)
    seen = [command.diagnostics for command in reference.commands]
    assert max(each.memory_points for each in seen) == config.skin.memory.capacity
    assert sum(each.self_readings > 0 for each in seen) >= 20
    turns = np.diff([int(each.circulating) for each in seen])
    assert np.count_nonzero(turns > 0) >= 3
    assert np.count_nonzero(turns < 0) >= 3


@pytest.mark.parametrize("backend", ["daqp", "qpoases"])
def test_planar_arm(backend: str, tmp_path: Path) -> None:
    config, model = extended(EXAMPLES / "planar2" / "planar2.yaml", tmp_path)
    check(config, model, tmp_path, backend, 1200)


def test_improved_iiwa(tmp_path: Path) -> None:
    config = load(EXAMPLES / "iiwa7" / "iiwa7_improved.yaml")
    check(config, build_model(config), tmp_path, "daqp", 1000)


@pytest.mark.slow
def test_dense_iiwa(tmp_path: Path) -> None:
    config = load(EXAMPLES / "iiwa7" / "iiwa7_dense.yaml")
    check(config, build_model(config), tmp_path, "qpoases", 1500)


@pytest.mark.slow
def test_lift(tmp_path: Path) -> None:
    config, model = extended(EXAMPLES / "lift4" / "lift4.yaml", tmp_path)
    check(config, model, tmp_path, "daqp", 1500)


@pytest.mark.slow
@pytest.mark.parametrize("name", RECIPE_NAMES)
def test_made_up_arms(name: str, tmp_path: Path) -> None:
    (recipe,) = (recipe for recipe in RECIPES if recipe.name == name)
    config, model = extended(write_arm(recipe, tmp_path), tmp_path)
    check(config, model, tmp_path, "daqp", 2000)


@pytest.fixture(scope="module")
def planar(tmp_path_factory: pytest.TempPathFactory) -> tuple[Config, RobotModel, Path]:
    """The planar arm with all three, built."""
    folder = tmp_path_factory.mktemp("additions")
    config, model = extended(EXAMPLES / "planar2" / "planar2.yaml", folder)
    return config, model, build(config, folder / "built", backend="daqp").library_dir


Both = tuple[CompiledController, ReferenceController, list[State]]


@pytest.fixture
def both(planar: tuple[Config, RobotModel, Path]) -> Iterator[Both]:
    """Both controllers while all three additions are at work; this state and the next."""
    config, model, library = planar
    compiled, reference = CompiledController.load(library), ReferenceController(config, model)
    states = list(random_states(config, model, 2000, seed=61, faults=0.0))
    for index, state in enumerate(states):
        if state.reset:
            compiled.reset()
            reference.reset()
        command = compiled.step(state.q, state.xdot, state.measurement)
        reference.step(state.q, state.xdot, state.measurement)
        reference.follow(command.qdot)
        now = command.diagnostics
        if now.circulating and now.memory_points > 2 and not states[index + 1].reset:
            yield compiled, reference, states[index : index + 2]
            return
    raise AssertionError("no such situation among the states")


def agree(mine: Command, theirs: Command) -> None:
    """Status, velocity and what additions say."""
    assert mine.status is theirs.status
    np.testing.assert_allclose(mine.qdot, theirs.qdot, atol=1e-9)
    for name in ("self_readings", "memory_points", "circulating"):
        assert getattr(mine.diagnostics, name) == getattr(theirs.diagnostics, name), name
    assert type(mine.diagnostics.circulating) is bool
    np.testing.assert_allclose(mine.diagnostics.tangent, theirs.diagnostics.tangent, atol=1e-12)


def spoilt(model: RobotModel, state: State, fault: Status) -> State:
    """The state with a fault."""
    seen, capsule = state.measurement, model.capsules[0]
    inside = body_poses(model, state.q)[capsule.body][:3] @ np.append(capsule.start, 1.0)
    ages = np.full(seen.tof_range.shape, 10.0)
    changes: dict[Status, State] = {
        Status.FAULT_NOT_FINITE: replace(state, xdot=np.full_like(state.xdot, np.nan)),
        Status.FAULT_JOINT_LIMIT: replace(state, q=np.full_like(state.q, 20.0)),
        Status.FAULT_READING: replace(
            state, measurement=replace(seen, tof_range=np.full_like(seen.tof_range, -1.0))
        ),
        Status.FAULT_STALE: replace(state, measurement=replace(seen, tof_age=ages)),
        Status.FAULT_TIME: replace(state, measurement=replace(seen, time=seen.time - 1.0)),
        Status.FAULT_OBSTACLE_INSIDE: replace(state, measurement=replace(seen, points=inside[None, :])),
    }
    return changes[fault]


@pytest.mark.parametrize(
    "fault",
    [
        Status.FAULT_NOT_FINITE,
        Status.FAULT_JOINT_LIMIT,
        Status.FAULT_READING,
        Status.FAULT_STALE,
        Status.FAULT_TIME,
        Status.FAULT_OBSTACLE_INSIDE,
    ],
    ids=lambda status: status.name,
)
def test_what_is_remembered_outlives_faults(fault: Status, both: Both) -> None:
    compiled, reference, (now, following) = both
    later = now.measurement.time + 0.4 * (following.measurement.time - now.measurement.time)
    bad = spoilt(reference.model, replace(now, measurement=replace(now.measurement, time=later)), fault)
    commands = [each.step(bad.q, bad.xdot, bad.measurement) for each in (compiled, reference)]
    assert commands[0].status is fault
    agree(*commands)
    diagnostics = commands[0].diagnostics
    assert (diagnostics.self_readings, diagnostics.memory_points, diagnostics.circulating) == (0, 0, False)
    assert np.isnan(diagnostics.tangent).all()
    after = [each.step(following.q, following.xdot, following.measurement) for each in (compiled, reference)]
    agree(*after)
    assert after[0].diagnostics.memory_points > 0
    assert not np.isnan(after[0].diagnostics.tangent).any()


def test_a_reset_forgets_everything(both: Both) -> None:
    compiled, reference, (_, following) = both
    compiled.reset()
    reference.reset()
    nothing = Measurement(
        time=0.0,
        tof_range=np.array([entry["range"] for entry in compiled.manifest["tof"]]),
        capacitive=np.zeros(len(compiled.manifest["capacitive"]), dtype=bool),
    )
    commands = [each.step(following.q, following.xdot, nothing) for each in (compiled, reference)]
    agree(*commands)
    diagnostics = commands[0].diagnostics
    assert (diagnostics.memory_points, diagnostics.circulating) == (0, False)
    assert not diagnostics.tangent.any()


def test_their_parameters_can_be_changed(both: Both) -> None:
    compiled, reference, (_, following) = both
    for controller in (compiled, reference):
        assert controller.parameters["memory_age"] == 10.0
        controller.set_parameters(memory_age=1e-3, memory_reach=1e-3, circulation_time_limit=0.1)
    commands = [
        each.step(following.q, following.xdot, following.measurement) for each in (compiled, reference)
    ]
    agree(*commands)
    assert commands[0].diagnostics.memory_points == 0


def test_random_parameters(planar: tuple[Config, RobotModel, Path]) -> None:
    """Times, speeds and margins within a factor of ten, zero where that is accepted."""
    config, model, library = planar
    compiled, reference = CompiledController.load(library), ReferenceController(config, model)
    random = np.random.default_rng(8)
    names = [name for name in compiled.parameters if name.startswith(("memory", "circ", "stall", "self_me"))]
    assert len(names) == 15
    limits = {entry["name"]: (entry["lower"], entry["upper"]) for entry in compiled.manifest["parameters"]}
    defaults = {name: float(compiled.parameters[name]) for name in names}
    for seed in range(12):
        factors = 10.0 ** random.uniform(-1.0, 1.0, len(names)) * (random.random(len(names)) > 0.1)
        values = {
            name: float(np.clip(factor * defaults[name], *limits[name]))
            for name, factor in zip(names, factors, strict=True)
        }
        for controller in (compiled, reference):
            controller.set_parameters(**values)
        states = random_states(config, model, 150, seed=seed, faults=0.0)
        result = compare_controllers_on(config, states, compiled, reference)
        assert result.verdict == "pass", (values, result.failures)
