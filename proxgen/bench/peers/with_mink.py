"""mink: a position task, its collision-avoidance limit between capsules and points, joint limits."""

from collections.abc import Callable
from typing import Any

import mink
import mujoco
import numpy as np

THIN = 1e-3
"""Radius of links and obstacles [m]: distances are to axes and points, as proxgen's are here."""

FAR = 10.0
"""Where an obstacle waits that is not there [m]."""


def open_solver(arm: dict[str, Any]) -> Callable[..., Any]:
    """A function from q, xdot, nearest obstacle points and the task point's next place to q̇."""
    model = mujoco.MjModel.from_xml_string(_description(arm))
    configuration = mink.Configuration(model)
    task = mink.FrameTask("tool", "site", position_cost=1.0, orientation_cost=0.0, lm_damping=arm["damping"])
    pairs = [([f"capsule_{index}"], [f"obstacle_{index}"]) for index in range(len(arm["capsules"]))]
    limits = [
        mink.ConfigurationLimit(model),
        mink.VelocityLimit(model, {joint["name"]: joint["velocity"] for joint in arm["joints"]}),
        mink.CollisionAvoidanceLimit(
            model,
            geom_pairs=pairs,
            gain=min(arm["period"] * arm["approach_speed"] / (arm["d_a"] - arm["d_0u"]), 1.0),
            minimum_distance_from_collisions=arm["d_0u"],
            collision_detection_distance=arm["d_a"],
        ),
    ]
    identity = mink.SO3.identity()
    period, damping = arm["period"], arm["damping"]

    def solve(q: Any, xdot: Any, points: Any, target: Any) -> Any:
        configuration.data.mocap_pos[:] = np.where(np.isnan(points), FAR, points)
        configuration.update(q)
        task.set_target(mink.SE3.from_rotation_and_translation(identity, target))
        return mink.solve_ik(
            configuration, [task], period, solver="daqp", damping=damping, limits=limits, safety_break=False
        )

    return solve


def _description(arm: dict[str, Any]) -> str:
    """The arm and one movable point per capsule, in MuJoCo's own format."""
    opening, closing = "", ""
    for body, joint in enumerate(arm["joints"], start=1):
        kind = "slide" if joint["prismatic"] else "hinge"
        opening += (
            f'<body {_pose(joint["placement"])}><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
            f'<joint name="{joint["name"]}" type="{kind}" axis="{_text(joint["axis"])}" limited="true" '
            f'range="{joint["lower"]!r} {joint["upper"]!r}"/>'
        )
        for index, capsule in enumerate(arm["capsules"]):
            if capsule["body"] == body:
                ends = _text([*capsule["start"], *capsule["end"]])
                opening += f'<geom name="capsule_{index}" type="capsule" size="{THIN}" fromto="{ends}"/>'
        if arm["tool"]["body"] == body:
            opening += f'<site name="tool" {_pose(arm["tool"]["placement"])}/>'
        closing += "</body>"
    obstacles = "".join(
        f'<body mocap="true" pos="{FAR} {FAR} {FAR}">'
        f'<geom name="obstacle_{index}" type="sphere" size="{THIN}"/></body>'
        for index in range(len(arm["capsules"]))
    )
    return (
        '<mujoco><compiler angle="radian"/><option><flag contact="enable"/></option>'
        f"<worldbody>{opening}{closing}{obstacles}</worldbody></mujoco>"
    )


def _text(values: Any) -> str:
    """Numbers as an attribute, to the last digit."""
    return " ".join(repr(float(value)) for value in values)


def _pose(placement: Any) -> str:
    """A 4x4 transform as attributes."""
    matrix, quaternion = np.array(placement), np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(matrix[:3, :3]).ravel())
    return f'pos="{_text(matrix[:3, 3])}" quat="{_text(quaternion)}"'
