"""Runs every peer on the cycles of the compiled controller, side by side, and sets the times in relation."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.bench.inputs import Inputs, record
from proxgen.bench.machine import describe_machine
from proxgen.bench.peers.environment import make_environment
from proxgen.bench.peers.kinematics import time_kinematics
from proxgen.bench.peers.problem import Problem, describe_arm, pose_problem
from proxgen.bench.peers.roster import CONTROLLERS, KINEMATICS, REFERENCE, Peer
from proxgen.bench.replay import compile_replay, replay
from proxgen.bench.timing import timing_row
from proxgen.builder.toolchain import run
from proxgen.config.scene import Scene
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Array
from proxgen.errors import BuildError
from proxgen.model import build_model

BACKENDS = ("daqp", "qpoases")
REPLAYS = 3

Progress = Callable[[int, int], None]
"""Called with the number of steps done and the number of all."""


@dataclass(frozen=True)
class PeerBenchmark:
    """What one run of all peers gave.

    Attributes:
        machine: what it was measured on, and with.
        results: one row per peer and scene.
        failures: peers that could not be installed or run, with the reason.
        versions: per peer, of its packages.
        not_alike: per peer, what to know before one reads a ratio.
    """

    machine: dict[str, str]
    results: tuple[dict[str, Any], ...]
    failures: dict[str, str]
    versions: dict[str, dict[str, str]]
    not_alike: dict[str, tuple[str, ...]]

    def to_json(self) -> dict[str, Any]:
        """All of it."""
        return {
            "machine": self.machine,
            "results": list(self.results),
            "failures": self.failures,
            "versions": self.versions,
            "not_alike": {name: list(lines) for name, lines in self.not_alike.items()},
        }


def relate(peer: str, scene: str, times: Array, ours: Mapping[str, Array], **more: Any) -> dict[str, Any]:
    """One result: a peer's times, and how many times proxgen's fit into them.

    Args:
        peer: its title.
        scene: whose cycles these are.
        times: (T,) of the peer's cycles [s].
        ours: per back end, (T,) of the same cycles, measured next to them [s].
        more: further entries.

    Returns:
        Percentiles [µs]; in `against`, per back end: proxgen's own p50, the ratio of the two p50, and the
        quartiles of the ratios of single cycles.
    """
    against = {}
    for backend, own in ours.items():
        own_p50 = float(np.percentile(own, 50.0))
        against[backend] = {
            "p50_us": own_p50 * 1e6,
            "ratio_of_p50": float(np.percentile(times, 50.0)) / own_p50,
            "ratio_of_cycles": [float(value) for value in np.percentile(times / own, [25.0, 50.0, 75.0])],
        }
    return timing_row(f"{scene}: cycle, raw", peer, times, against=against, **more)


def run_peers(
    config: Config,
    scenes: Sequence[Scene],
    directory: Path,
    *,
    duration: float = 60.0,
    progress: Progress | None = None,
) -> PeerBenchmark:
    """Measure the reference and all peers against the compiled controller.

    Args:
        config: of the robot.
        scenes: whose closed loops are recorded, with the skin as the sensor.
        directory: for the peers' environments and files; kept, so that a second run installs nothing.
        duration: of each scene [s].
        progress: called after each step of the work.

    Raises:
        BuildError: compiler or solver missing.
        GenerateError: an arm or a task that not every peer can express.
        SimulationError: a scene does not fit the arm.
    """
    model = build_model(config)
    arm = describe_arm(config, model)
    bench = _Bench(config, directory, arm)
    steps, done = 2 + len(CONTROLLERS), 0

    def advance() -> None:
        nonlocal done
        done += 1
        if progress:
            progress(done, steps)

    controller = CompiledController.load(directory / "daqp" / "controller")
    recorded = [record(config, model, controller, scene, duration) for scene in scenes]
    problems = []
    for inputs in recorded:
        ours = bench.times(inputs)
        problem = pose_problem(config, model, inputs)
        bench.add(REFERENCE, inputs, problem.reference_times, ours)
        problems.append(problem)
    bench.versions[REFERENCE.name] = {name: metadata.version(name) for name in REFERENCE.shown}
    advance()
    for peer in CONTROLLERS:
        bench.attempt(peer, lambda peer=peer: bench.time_controller(peer, recorded, problems))  # type: ignore[misc]
        advance()
    bench.attempt(KINEMATICS, lambda: bench.time_kinematics(np.vstack([inputs.q for inputs in recorded])))
    advance()
    return PeerBenchmark(
        describe_machine(model),
        tuple(bench.results),
        bench.failures,
        bench.versions,
        {peer.title: peer.not_alike for peer in (REFERENCE, *CONTROLLERS, KINEMATICS)},
    )


class _Bench:
    """The work in progress: programs, environments, results so far."""

    def __init__(self, config: Config, directory: Path, arm: dict[str, Any]) -> None:
        """Compile proxgen's own side with both back ends."""
        self.directory, self.arm = directory, arm
        self.results: list[dict[str, Any]] = []
        self.failures: dict[str, str] = {}
        self.versions: dict[str, dict[str, str]] = {}
        self._programs = {}
        for backend in BACKENDS:
            (directory / backend).mkdir(parents=True, exist_ok=True)
            self._programs[backend] = compile_replay(config, backend, directory / backend)

    def times(self, inputs: Inputs) -> dict[str, Array]:
        """Per back end, raw times of the last of a few replays, (T,) [s]."""
        return {
            backend: replay(program, inputs, backend, self.directory / backend, REPLAYS).whole[-1]
            for backend, program in self._programs.items()
        }

    def add(self, peer: Peer, inputs: Inputs, times: Array, ours: Mapping[str, Array], **more: Any) -> None:
        """Keep one result."""
        self.results.append(relate(peer.title, inputs.name, times, ours, **more))

    def attempt(self, peer: Peer, work: Callable[[], None]) -> None:
        """Do a peer's part; that it cannot be installed or run is a result as well."""
        try:
            work()
        except BuildError as error:
            self.failures[peer.title] = str(error)

    def time_controller(self, peer: Peer, recorded: Sequence[Inputs], problems: Sequence[Problem]) -> None:
        """Run a peer over all recordings, each next to a replay of proxgen's own."""
        python = make_environment(self.directory / peer.name, peer.requirements)
        for inputs, problem in zip(recorded, problems, strict=True):
            source = self.directory / f"{inputs.name}.npz"
            target = self.directory / f"{inputs.name}_{peer.name}.npz"
            problem.save(source, self.arm | dict(peer.settings))
            ours = self.times(inputs)
            script = Path(__file__).with_name("run_peer.py")
            run([str(python), str(script), peer.module, str(source), str(target)], f"{peer.title} failed")
            found = np.load(target)
            no_answer = int(np.isnan(found["qdot"][:, 0]).sum())
            if no_answer == inputs.cycles:
                raise BuildError(f"{peer.title} found no answer in any cycle of {inputs.name}")
            near = float((~np.isnan(problem.points[:, :, 0])).sum(axis=1).mean())
            more = {"cycles_without_answer": no_answer, "mean_links_near": near}
            self.add(peer, inputs, found["times"], ours, **more)
            installed = json.loads(str(found["versions"]))
            self.versions[peer.name] = {name: installed[name] for name in peer.shown}

    def time_kinematics(self, q: Array) -> None:
        """Pinocchio's C++ against the generated kinematics, in one program."""
        python = make_environment(self.directory / KINEMATICS.name, KINEMATICS.requirements)
        generated = self.directory / "daqp" / "controller" / "generated"
        ours, theirs, worst = time_kinematics(
            self.arm, q, generated, python, self.directory / KINEMATICS.name
        )
        if worst > 1e-9:
            raise BuildError(f"Pinocchio's Jacobian differs by {worst:.1e}: it is not the same arm")
        self.results.append(relate(KINEMATICS.title, "all states", theirs, {"kinematics": ours}))
        script = "import sys; from importlib.metadata import version; print(*map(version, sys.argv[1:]))"
        said = run([str(python), "-c", script, *KINEMATICS.shown], "cannot read the versions")
        self.versions[KINEMATICS.name] = dict(zip(KINEMATICS.shown, said.split(), strict=True))
