"""Who is compared: packages in exact versions, and what is not alike between them and proxgen."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Peer:
    """A controller, or a library, that proxgen is compared with.

    Attributes:
        name: of its environment, `build/bench/<name>`.
        title: as the output calls it.
        module: file in this folder that uses it, without `.py`; empty if it is not a controller.
        requirements: what is installed into its environment, with exact versions.
        shown: packages whose versions the output names.
        not_alike: what to know before one reads the ratio.
        settings: of this variant, for the module.
    """

    name: str
    title: str
    module: str
    requirements: tuple[str, ...]
    shown: tuple[str, ...]
    not_alike: tuple[str, ...]
    settings: Mapping[str, bool] = field(default_factory=dict)


REFERENCE = Peer(
    name="reference",
    title="proxgen reference (NumPy, Pinocchio)",
    module="",
    requirements=(),
    shown=("numpy", "pin", "quadprog"),
    not_alike=("the same method, cycle by cycle, certificate included; written to be read, not to be fast",),
)

_PINK = Peer(
    name="pink",
    title="Pink, a barrier per link, made once",
    module="with_pink",
    requirements=("pin-pink==4.4.0", "pin==4.1.0", "quadprog==0.1.14", "numpy==2.4.6"),
    shown=("pin-pink", "pin", "quadprog", "numpy"),
    settings={"made_once": True},
    not_alike=(
        "alike: a row per link in every cycle; where nothing is within influence, its barrier is 10 m away",
        "its barriers are made once, as in its own examples, and moved to the nearest obstacle",
        "gets the nearest obstacle point of each capsule for nothing; proxgen finds it among its sensors",
        "its barrier keeps one coordinate of one frame (the capsule's end) in front of the obstacle, "
        "where proxgen limits the approach of the nearest point along the shortest line",
        "no active avoidance, no acceleration limit, no staged reduction, no certificate",
    ),
)

CONTROLLERS = (
    _PINK,
    replace(
        _PINK,
        title="Pink, a barrier per link, made anew",
        settings={},
        not_alike=(
            "as above, but its barriers are made in every cycle: it then compares q with that of the last "
            "cycle once less per barrier",
        ),
    ),
    replace(
        _PINK,
        title="Pink, barriers of near links alone",
        settings={"only_near": True},
        not_alike=(
            "as the last, but links that have no obstacle within influence get no barrier, where proxgen "
            "keeps their rows: the least work that Pink can be given",
        ),
    ),
    Peer(
        name="neo",
        title="NEO (robotics toolbox)",
        module="with_neo",
        requirements=(
            "roboticstoolbox-python==1.5.0",
            "spatialgeometry==1.4.2",
            "coal==3.0.3",
            "qpsolvers==4.13.0",
            "quadprog==0.1.14",
            "numpy==2.4.6",
        ),
        shown=("roboticstoolbox-python", "spatialgeometry", "coal", "qpsolvers", "quadprog", "numpy"),
        not_alike=(
            "gets the nearest obstacle points, and computes distances of all links to them with a collision "
            "library",
            "maximises manipulability, and softens the task where proxgen damps it",
            "no active avoidance, no acceleration limit, no staged reduction, no certificate",
        ),
    ),
    Peer(
        name="mink",
        title="mink, collision-avoidance limit",
        module="with_mink",
        requirements=("mink==1.3.0", "mujoco==4.0.0", "daqp==0.11.0", "numpy==2.4.6"),
        shown=("mink", "mujoco", "daqp", "numpy"),
        not_alike=(
            "gets the nearest obstacle point of each capsule for nothing, as a body that MuJoCo moves",
            "no active avoidance, no acceleration limit, no staged reduction, no certificate",
        ),
    ),
)

KINEMATICS = Peer(
    name="pinocchio",
    title="Pinocchio C++ (kinematics alone)",
    module="",
    requirements=("pin==4.1.0", "cmeel-eigen==3.4.1", "numpy==2.4.6"),
    shown=("pin", "cmeel-eigen"),
    not_alike=(
        "kinematics alone: body poses, joint Jacobians and the tool's Jacobian, as proxgen's first stage; "
        "both in one C++ program, in turns over the same states, at its own -O3 -DNDEBUG",
    ),
)
