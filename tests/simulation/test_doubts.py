"""What is said of scenes in which an arm cannot do well."""

import numpy as np
from simulation_tools import scene

from proxgen.config.scene import Obstacle, load_scene, scene_names
from proxgen.model import RobotModel
from proxgen.model.kinematics import tool_pose
from proxgen.simulation.doubts import _reach, doubts


def test_our_scenes_raise_none(iiwa7_model: RobotModel) -> None:
    names = [name for name in scene_names() if name != "post"]  # post is the planar arm's
    assert len(names) >= 4
    for name in names:
        assert doubts(load_scene(name), iiwa7_model) == []


def test_an_arm_that_starts_in_an_obstacle_is_told(planar2_model: RobotModel) -> None:
    ball = Obstacle(name="ball", shape="sphere", radius=0.1, position=(0.2, 0.0, 0.1))
    apart = Obstacle(name="apart", shape="sphere", radius=0.1, position=(0.2, 0.0, 2.0))
    (said,) = doubts(scene(ball, apart, targets=((0.5, 0.2, 0.1),)), planar2_model)
    capsule = planar2_model.capsules[0]
    assert said.startswith(f"the arm starts with capsule '{capsule.name}' ")
    assert said.endswith(" mm inside obstacle 'ball'")


def test_a_target_out_of_reach_is_told_along_the_rows_of_the_task(planar2_model: RobotModel) -> None:
    assert planar2_model.task_rows == ("x", "y")
    _, reach = _reach(planar2_model)
    targets = ((reach - 1e-6, 0.0, 50.0), (0.0, reach + 0.01, 0.0), (500.0, 0.0, 0.0))
    said = doubts(scene(targets=targets), planar2_model)
    assert said == [
        f"targets.1 is {reach + 0.01:.3g} m from the first joint (and 1 more like it); "
        f"the arm reaches {reach:.3g} m at most",
    ]


def test_no_posture_is_out_of_reach(any_model: RobotModel) -> None:
    """Prismatic, mimic and continuous joints among them."""
    rng = np.random.default_rng(8)
    centre, reach = _reach(any_model)
    lower, upper = np.maximum(any_model.q_lower, -4.0), np.minimum(any_model.q_upper, 4.0)
    far = [
        np.linalg.norm(tool_pose(any_model, rng.uniform(lower, upper))[:3, 3] - centre) for _ in range(200)
    ]
    assert 0.3 * reach < max(far) <= reach
