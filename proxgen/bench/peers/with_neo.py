"""NEO as the robotics toolbox offers it: its Jacobians, joint and collision dampers, quadprog for the QP.

The program is that of the toolbox's own example (Haviland, Corke: NEO, RA-L 2021), with the three rows of a
position task in place of six.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import qpsolvers
import roboticstoolbox as rtb
from spatialgeometry import Cylinder, Sphere

THIN = 1e-3
"""Radius of links and obstacles [m]: distances are to axes and points, as proxgen's are here."""


def open_solver(arm: dict[str, Any]) -> Callable[..., Any]:
    """A function from q, xdot, nearest obstacle points and the task point's next place to q̇."""
    robot = _toolbox_robot(arm)
    n, rows = robot.n, 3
    obstacles = [Sphere(THIN) for _ in arm["capsules"]]
    speed = np.array([joint["velocity"] for joint in arm["joints"]])
    lb, ub = np.r_[-speed, -10.0 * np.ones(rows)], np.r_[speed, 10.0 * np.ones(rows)]

    def solve(q: Any, xdot: Any, points: Any, target: Any) -> Any:
        robot.q = q
        robot._update_link_tf(q)
        robot.update()
        Q = np.eye(n + rows)
        Q[:n, :n] *= 0.01
        Q[n:, n:] /= max(float(np.abs(xdot).sum()), 1e-3)
        Aeq = np.c_[robot.jacob0(q)[:3], np.eye(rows)]
        Ain, bin_ = np.zeros((n + rows, n + rows)), np.zeros(n + rows)
        Ain[:n, :n], bin_[:n] = robot.joint_velocity_damper(q, 0.05, 0.9, n)
        for obstacle, point in zip(obstacles, points, strict=True):
            if np.isnan(point[0]):
                continue
            place = np.eye(4)
            place[:3, 3] = point
            obstacle.T = place
            obstacle.update()
            A, b = robot.link_collision_damper(
                obstacle, q, arm["d_a"], arm["d_0u"], arm["approach_speed"], end=robot.links[-1]
            )
            if A is not None:
                Ain = np.r_[Ain, np.c_[A, np.zeros((len(A), rows))]]
                bin_ = np.r_[bin_, np.ravel(b)]
        c = np.r_[-robot.jacobm(q).reshape(n), np.zeros(rows)]
        solution = qpsolvers.solve_qp(Q, c, Ain, bin_, Aeq, xdot, lb=lb, ub=ub, solver="quadprog")
        return None if solution is None else solution[:n]

    return solve


def _toolbox_robot(arm: dict[str, Any]) -> Any:
    """The arm as the toolbox has it: its joints turn about z, so the links' frames are turned there."""
    links, parent, turned = [], None, np.eye(4)
    carried: dict[int, list[Any]] = {}
    for capsule in arm["capsules"]:
        carried.setdefault(capsule["body"], []).append(capsule)
    for body, joint in enumerate(arm["joints"], start=1):
        to_z = _rotation_of_z(np.array(joint["axis"]))
        place = np.linalg.inv(turned) @ np.array(joint["placement"]) @ to_z
        moves = rtb.ET.tz() if joint["prismatic"] else rtb.ET.Rz()
        link = rtb.Link(
            rtb.ET.SE3(place) * moves,
            name=joint["name"],
            parent=parent,
            qlim=[joint["lower"], joint["upper"]],
        )
        link.collision = [_cylinder(capsule, to_z) for capsule in carried.get(body, [])]
        links.append(link)
        parent, turned = link, to_z
    tool = np.linalg.inv(turned) @ np.array(arm["tool"]["placement"])
    links.append(rtb.Link(rtb.ETS(rtb.ET.SE3(tool)), name="tool", parent=parent))
    return rtb.Robot(links, name=arm["name"])


def _rotation_of_z(direction: Any) -> Any:
    """A transform that turns z into a direction."""
    z = direction / np.linalg.norm(direction)
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    turn = np.eye(4)
    turn[:3, :3] = np.c_[x, np.cross(z, x), z]
    return turn


def _cylinder(capsule: dict[str, Any], to_z: Any) -> Any:
    """A capsule's axis as a thin cylinder in the turned frame of its link."""
    start, end = np.array(capsule["start"]), np.array(capsule["end"])
    length = float(np.linalg.norm(end - start))
    place = _rotation_of_z(end - start) if length > 0.0 else np.eye(4)
    place[:3, 3] = (start + end) / 2.0
    return Cylinder(radius=THIN, length=max(length, THIN), pose=np.linalg.inv(to_z) @ place)
