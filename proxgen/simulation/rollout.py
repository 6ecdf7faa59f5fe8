"""The closed loop: sense, task velocity, controller, log, plant, once per control period."""

import time as clock
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proxgen.config.scene import Scene
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Command, Controller, Measurement
from proxgen.errors import SimulationError
from proxgen.model.robot_model import RobotModel
from proxgen.simulation.arm import ArmGeometry
from proxgen.simulation.log import RolloutLog
from proxgen.simulation.obstacles import ObstacleField
from proxgen.simulation.plant import JointHistory, KinematicPlant, Plant
from proxgen.simulation.recorder import Recorder, describe
from proxgen.simulation.scenery import surroundings
from proxgen.simulation.skin import Sensing, open_sensing
from proxgen.simulation.task import TargetTracker
from proxgen.simulation.trajectory import open_tracker
from proxgen.simulation.world import World

Array = NDArray[np.float64]

Progress = Callable[[int, int], None]
"""Called after each cycle with the number of cycles done and the number of all."""


@dataclass(frozen=True)
class Cycle:
    """What went into the controller in one cycle, and what came out.

    Attributes:
        index: from 0.
        time: [s].
        q: (n,) joint positions.
        xdot: (m,) task velocity.
        measurement: of the obstacles.
        command: the controller's decision.
    """

    index: int
    time: float
    q: Array
    xdot: Array
    measurement: Measurement
    command: Command


Observer = Callable[[Cycle], None]
"""Sees every cycle after the controller has decided, before the plant moves; must not change its arrays."""


def run(
    config: Config,
    model: RobotModel,
    controller: Controller,
    scene: Scene,
    *,
    sensing: str = "skin",
    duration: float = 60.0,
    seed: int = 0,
    observers: Sequence[Observer] = (),
    progress: Progress | None = None,
    gui: bool = False,
    start_offset: Array | None = None,
    plant: Plant | None = None,
    self_measurement: bool = False,
) -> RolloutLog:
    """Let a controller move an arm through a scene.

    Args:
        config: control rate, task, thresholds.
        model: the arm that `config` describes.
        controller: is reset first.
        scene: obstacles, targets, start.
        sensing: `skin` (the cuffs' readings) or `ideal` (exact nearest points).
        duration: [s]; the nearest whole number of control periods is run.
        seed: of noise and dropouts; the same seed gives the same run.
        observers: called in every cycle, in this order.
        progress: called in every cycle with (done, all).
        gui: show pybullet's window, at the pace of the clock on the wall.
        start_offset: (n,) added to the scene's start [rad or m].
        plant: what moves; by default every command is followed exactly.
        self_measurement: the skin sees the arm itself, and discards what that explains. If the controller is
            configured to do that (skin.self_measurement), the skin sees the arm and discards nothing anyway.

    Returns:
        The log of all cycles.

    Raises:
        SimulationError: the scene does not fit the arm, an unknown sensing, no cycle at all, or no world.
    """
    cycles = round(duration * config.control.rate)
    if cycles < 1:
        raise SimulationError(f"a duration of {duration:g} s has no cycle at {config.control.rate:g} Hz")
    around, arm = surroundings(scene, model, start_offset), ArmGeometry(model)
    field, tool = around.field, arm.tool(arm.poses(around.start))
    tracker = open_tracker(config.task, model, around.targets, tool)
    moved: Plant = KinematicPlant(around.start) if plant is None else plant
    moved.reset(around.start)
    controller.reset()
    recorder = Recorder(cycles, arm)
    with ExitStack() as stack:
        removal = config.skin.self_measurement.enabled
        eyes = open_sensing(
            sensing,
            field,
            arm,
            max_points=config.skin.max_points,
            seed=seed,
            arm_in_rays=self_measurement or removal,
            discard_own=not removal,
        )
        stack.callback(eyes.close)
        window = stack.enter_context(World(field, arm, gui=True)) if gui else None
        loop = _Loop(
            1.0 / config.control.rate, arm, field, eyes, tracker, controller, moved, recorder, window
        )
        loop.go(cycles, observers, progress)
    meta = describe(config, model, controller, around)
    return recorder.log(meta | {"sensing": sensing, "seed": seed, "plant": moved.name})


@dataclass(frozen=True)
class _Loop:
    """Everything that takes part in a cycle."""

    period: float
    arm: ArmGeometry
    field: ObstacleField
    eyes: Sensing
    tracker: TargetTracker
    controller: Controller
    plant: Plant
    recorder: Recorder
    window: World | None

    def go(self, cycles: int, observers: Sequence[Observer], progress: Progress | None) -> None:
        """All cycles, one after the other."""
        history, begin = JointHistory(self.plant.q), clock.monotonic()
        for index in range(cycles):
            if self.window is not None:
                clock.sleep(max(begin + index * self.period - clock.monotonic(), 0.0))
            cycle = self._cycle(index, history)
            for observer in observers:
                observer(cycle)
            for moment, q in self.plant.advance(cycle.command.qdot, self.period):
                history.append(cycle.time + moment, q)
            if progress is not None:
                progress(index + 1, cycles)

    def _cycle(self, index: int, history: JointHistory) -> Cycle:
        """Sense, task velocity, controller, log."""
        time, q = index * self.period, self.plant.q.copy()
        poses = self.arm.poses(q)
        tool = self.arm.tool(poses)
        if self.window is not None:
            self.window.place(time, poses)
        measurement = self.eyes.measure(time, history)
        velocity = self.tracker.update(tool, time)
        begin = clock.perf_counter_ns()
        command = self.controller.step(q, velocity.xdot, measurement)
        cycle_us = 1e-3 * (clock.perf_counter_ns() - begin)
        near = self.field.near_segments(time, *self.arm.axes(poses))
        self.recorder.record_state(index, time, q, tool, near)
        self.recorder.record_target(index, self.tracker, velocity)
        self.recorder.record_command(index, measurement, command, cycle_us)
        return Cycle(index, time, q, velocity.xdot, measurement, command)
