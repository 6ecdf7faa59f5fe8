"""Pink: a position task, one position barrier per capsule in every cycle, joint limits.

Pink's own examples make their barriers once. It keeps what a barrier gave as long as q is nearly the same,
and compares twice per barrier and cycle; barriers that are made anew need one of these comparisons less, and
cannot miss a wall that has moved. So both ways are measured.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from pink import Configuration, solve_ik
from pink.barriers import PositionBarrier
from pink.limits import ConfigurationLimit, VelocityLimit
from pink.tasks import FrameTask

FAR = 10.0
"""Where the wall of a capsule stands that has no obstacle within influence [m]."""

_ALIGNED = {(1, 0, 0): "X", (0, 1, 0): "Y", (0, 0, 1): "Z"}


def open_solver(arm: dict[str, Any]) -> Callable[..., Any]:
    """A function from q, xdot, nearest obstacle points and the task point's next place to q̇.

    With `made_once` in `arm`, barriers are kept and their walls moved; with `only_near`, capsules that have
    no obstacle within influence get none.
    """
    model = _pinocchio_model(arm)
    configuration = Configuration(model, model.createData(), pin.neutral(model))
    task = FrameTask("tool", position_cost=1.0, orientation_cost=0.0, lm_damping=arm["damping"])
    goal = pin.SE3.Identity()
    limits = (ConfigurationLimit(model), VelocityLimit(model))
    period, speed = arm["period"], arm["approach_speed"]
    gain = speed / (arm["d_a"] - arm["d_0u"])
    kept: dict[str, PositionBarrier] = {}

    def solve(q: Any, xdot: Any, points: Any, target: Any) -> Any:
        configuration.update(q)
        goal.translation = target
        task.set_target(goal)
        barriers = []
        for index, point in enumerate(points):
            frame, seen = f"capsule_{index}", not np.isnan(point[0])
            if seen:
                place = configuration.get_transform_frame_to_world(frame).translation
                axis = int(np.argmax(np.abs(point - place)))
                side = 1.0 if point[axis] > place[axis] else -1.0
                bound = np.array([point[axis] - side * arm["d_0u"]])
            elif arm.get("only_near"):
                continue
            else:
                axis, side, bound = 0, 1.0, np.array([FAR])
            low, high = (None, bound) if side > 0.0 else (bound, None)
            barrier = kept.get(frame)
            if barrier is None:
                barrier = PositionBarrier(frame, indices=[axis], p_min=low, p_max=high, gain=gain)
            else:
                barrier.indices, barrier.p_min, barrier.p_max = [axis], low, high
            if arm.get("made_once"):
                kept[frame] = barrier
            barriers.append(barrier)
        return solve_ik(
            configuration,
            [task],
            period,
            solver="quadprog",
            damping=arm["damping"],
            limits=limits,
            barriers=barriers,
            safety_break=False,
        )

    return solve


def _pinocchio_model(arm: dict[str, Any]) -> Any:
    """The arm as Pinocchio has it, with a frame at the tool and at the far end of each capsule's axis."""
    model = pin.Model()
    for joint in arm["joints"]:
        letter = _ALIGNED.get(tuple(joint["axis"]))
        kind = "P" if joint["prismatic"] else "R"
        if letter:
            made = getattr(pin, f"JointModel{kind}{letter}")()
        else:
            made = getattr(pin, f"JointModel{'Prismatic' if joint['prismatic'] else 'Revolute'}Unaligned")(
                np.array(joint["axis"])
            )
        model.addJoint(
            model.njoints - 1,
            made,
            pin.SE3(np.array(joint["placement"])),
            joint["name"],
            np.array([1e3]),
            np.array([joint["velocity"]]),
            np.array([joint["lower"]]),
            np.array([joint["upper"]]),
        )
    tool = pin.SE3(np.array(arm["tool"]["placement"]))
    _add_frame(model, "tool", arm["tool"]["body"], tool)
    for index, capsule in enumerate(arm["capsules"]):
        end = pin.SE3(np.eye(3), np.array(capsule["end"]))
        _add_frame(model, f"capsule_{index}", capsule["body"], end)
    return model


def _add_frame(model: Any, name: str, body: int, placement: Any) -> None:
    """A frame that moves with a body."""
    model.addFrame(pin.Frame(name, body, 0, placement, pin.FrameType.OP_FRAME))
