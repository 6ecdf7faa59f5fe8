"""A small robot in a folder of its own, in which the tests make mistakes."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

from proxgen.cli import main
from proxgen.config import load
from proxgen.errors import ConfigError

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")

ROBOT = """\
robot:
  name: arm
  urdf: arm.urdf
  tool: tip
  locked_joints: {lift: 10 cm}
task:
  kind: position
  posture:
    joints: {elbow: 30 deg}
limits:
  position:
    shoulder: [-90 deg, 90 deg]
  acceleration: {shoulder: 10, elbow: 20}
  viability: true
capsules:
  - {name: upper, frame: upper_arm, start: [0, 0, 0], end: [0, 0, 0.3], radius: 5 cm}
  - {name: lower, frame: lower_arm, start: [0, 0, 0], end: [0, 0, 0.3], radius: 5 cm}
skin:
  cuffs:
    - name: wrist
      frame: lower_arm
      rings:
        - {offset: 0.2, radius: 6 cm, modules: 4, tilt: [0, 35 deg]}
  tof:
    range: 1 m
avoidance:
  d_a: 0.30
  d_0u: 0.25
  schedule: paper
solver:
  backend: daqp
control:
  rate: 50 Hz
"""

URDF = """\
<robot name="arm">
  <link name="base"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="column"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" velocity="0.2" effort="100"/>
  </joint>
  <link name="column"/>
  <joint name="shoulder" type="revolute">
    <parent link="column"/><child link="upper_arm"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" velocity="1.5" effort="50"/>
  </joint>
  <link name="upper_arm"/>
  <joint name="elbow" type="continuous">
    <parent link="upper_arm"/><child link="lower_arm"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit velocity="2" effort="30"/>
  </joint>
  <link name="lower_arm"/>
  <joint name="tip_joint" type="fixed">
    <parent link="lower_arm"/><child link="tip"/><origin xyz="0 0 0.3"/>
  </joint>
  <link name="tip"/>
</robot>
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with `robot.yaml` and `arm.urdf`; it is the current one."""
    monkeypatch.chdir(tmp_path)
    Path("robot.yaml").write_text(ROBOT)
    Path("arm.urdf").write_text(URDF)
    return tmp_path


@pytest.fixture
def problems_after(folder: Path) -> Callable[..., list[str]]:
    """Make changes to `robot.yaml`, each (old text, new text), and load it: the problems as texts."""

    def change_and_load(*changes: tuple[str, str]) -> list[str]:
        text = Path("robot.yaml").read_text()
        for old, new in changes:
            assert text.count(old) == 1, f"{old!r} is not unique"
            text = text.replace(old, new)
        Path("robot.yaml").write_text(text)
        with pytest.raises(ConfigError) as caught:
            load("robot.yaml")
        assert caught.value.exit_status == 2
        return [str(problem) for problem in caught.value.problems]

    return change_and_load


@pytest.fixture
def expect_problem(
    problems_after: Callable[..., list[str]], capsys: pytest.CaptureFixture[str]
) -> Callable[[str, str, str], None]:
    """Make one change and expect one problem, from `load` and from the command line, and no file written."""

    def expect(old: str, new: str, text: str) -> None:
        message = f"robot.yaml:{text}"
        assert problems_after((old, new)) == [message]
        assert main(["check", "robot.yaml"]) == 2
        captured = capsys.readouterr()
        assert captured.err == f"{message}\n1 problem\n"
        assert captured.out == ""
        assert sorted(path.name for path in Path().iterdir()) == ["arm.urdf", "robot.yaml"]

    return expect
