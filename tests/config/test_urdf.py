"""Where the robot description lies, and what can be wrong with it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from proxgen.config import load
from proxgen.config.urdf import read_names, resolve_package
from proxgen.errors import ConfigError, ModelError

PLACE = "robot.yaml:3: robot.urdf: "


@pytest.fixture
def site(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of installed packages: one to import, and two distributions that only hold data."""
    site = tmp_path_factory.mktemp("site")
    files = {
        "robots_to_import/__init__.py": "raise RuntimeError('must not be imported')",
        "robots_to_import/arms/arm.urdf": "<robot><link name='a'/></robot>",
        "cmeel.prefix/share/data-of-robots/robots/arm/arm.urdf": "<robot><link name='b'/></robot>",
        "cmeel.prefix/share/other/robots/arm/arm.urdf": "<robot><link name='c'/></robot>",
        "cmeel.prefix/share/data-of-robots/robots/arm/mesh.stl": "",
    }
    for name, text in files.items():
        (site / name).parent.mkdir(parents=True, exist_ok=True)
        (site / name).write_text(text)
    info = site / "data_of_robots-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: data-of-robots\nVersion: 1.0\n")
    record = [name for name in files if name.startswith("cmeel")] + ["lost/robots/arm/gone.urdf"]
    (info / "RECORD").write_text("".join(f"{name},,\n" for name in record))
    monkeypatch.syspath_prepend(str(site))
    return site


@pytest.mark.parametrize(
    ("uri", "file"),
    [
        ("package://robots_to_import/arms/arm.urdf", "robots_to_import/arms/arm.urdf"),
        (
            "package://data-of-robots/robots/arm/arm.urdf",
            "cmeel.prefix/share/data-of-robots/robots/arm/arm.urdf",
        ),
        (
            "package://data_of_robots/robots/arm/arm.urdf",
            "cmeel.prefix/share/data-of-robots/robots/arm/arm.urdf",
        ),
        (
            "package://data-of-robots/share/other/robots/arm/arm.urdf",
            "cmeel.prefix/share/other/robots/arm/arm.urdf",
        ),
    ],
)
def test_files_of_packages_are_found_without_importing_them(site: Path, uri: str, file: str) -> None:
    assert resolve_package(uri) == site / file


@pytest.mark.parametrize(
    ("uri", "message"),
    [
        (
            "package://no_such_robots/arm.urdf",
            "the Python package 'no_such_robots' of 'package://no_such_robots/arm.urdf' is not installed "
            "(pip install no_such_robots)",
        ),
        (
            "package://robots_to_import/arms/arn.urdf",
            "the Python package 'robots_to_import' has no file 'arms/arn.urdf'",
        ),
        (
            "package://data-of-robots/robots/arm/arn.urdf",
            "the Python package 'data-of-robots' has no file 'robots/arm/arn.urdf'; did you mean "
            "'robots/arm/arm.urdf'?",
        ),
        (
            "package://data-of-robots/robots/arm/gone.urdf",
            "the Python package 'data-of-robots' has no file 'robots/arm/gone.urdf'; did you mean "
            "'lost/robots/arm/gone.urdf'?",
        ),
        ("package://robots", "'package://robots' is not of the form package://PACKAGE/path/to/file"),
        ("package:///a.urdf", "'package:///a.urdf' is not of the form package://PACKAGE/path/to/file"),
        (
            "package://p/../a.urdf",
            "'package://p/../a.urdf' is not of the form package://PACKAGE/path/to/file",
        ),
    ],
)
def test_what_is_wrong_with_a_package_is_said(site: Path, uri: str, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        resolve_package(uri)
    assert str(caught.value) == message


def test_the_arm_of_pybullet_is_found() -> None:
    path = resolve_package("package://pybullet_data/kuka_iiwa/model.urdf")
    assert "lbr_iiwa_link_7" in read_names(path).links


def test_a_package_in_the_file(site: Path, folder: Path) -> None:
    text = Path("robot.yaml").read_text()
    Path("robot.yaml").write_text(text.replace("arm.urdf", "package://data-of-robots/robots/arm/arm.urdf"))
    with pytest.raises(ConfigError) as caught:
        load("robot.yaml")
    assert "unknown frame 'tip' (allowed: b)" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("arn.urdf", "the file 'arn.urdf' does not exist; did you mean 'arm.urdf'? (looked for arn.urdf)"),
        ("no/arm.urdf", "the file 'no/arm.urdf' does not exist (looked for no/arm.urdf)"),
        (".", "'.' is a folder; a URDF file is needed"),
        (
            "package://none/arm.urdf",
            "the Python package 'none' of 'package://none/arm.urdf' is not installed (pip install none)",
        ),
    ],
)
def test_a_urdf_that_is_not_there(
    name: str, message: str, expect_problem: Callable[[str, str, str], None]
) -> None:
    expect_problem("urdf: arm.urdf", f"urdf: {name}", f"3: robot.urdf: {message}")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "arm.urdf is not well-formed XML: no element found: line 1, column 0"),
        ("<robot>\n<link>\n</robot>", "arm.urdf is not well-formed XML: mismatched tag: line 3, column 2"),
        ("<sdf/>", "arm.urdf is not a URDF: its root element is <sdf>, not <robot>"),
        ("<robot/>", "arm.urdf has no links"),
        (
            "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:include filename='a'/></robot>",
            "arm.urdf is a xacro file; turn it into a URDF first (xacro arm.urdf > robot.urdf)",
        ),
        (
            "<robot><link name='a'/><joint name='j' type='revolute'><limit upper='${pi}'/></joint></robot>",
            'arm.urdf is a xacro file, as <limit upper="${pi}"> shows; turn it into a URDF first '
            "(xacro arm.urdf > robot.urdf)",
        ),
        (
            "<robot><link name='a'><collision><geometry><mesh filename='$(find a)/b.stl'/></geometry>"
            "</collision></link></robot>",
            'arm.urdf is a xacro file, as <mesh filename="$(find a)/b.stl"> shows; turn it into a URDF first '
            "(xacro arm.urdf > robot.urdf)",
        ),
    ],
)
def test_a_urdf_that_is_none(
    content: str, message: str, folder: Path, expect_problem: Callable[[str, str, str], None]
) -> None:
    Path("arm.urdf").write_text(content)
    expect_problem("rate: 50 Hz", "rate: 50 Hz  # as it was", f"3: robot.urdf: {message}")


def test_many_names_are_counted_instead_of_listed(folder: Path) -> None:
    links = "".join(f"<link name='link_{index}'/>" for index in range(30))
    Path("arm.urdf").write_text(f"<robot>{links}</robot>")
    with pytest.raises(ConfigError) as caught:
        load("robot.yaml")
    assert caught.value.problems[0].message == "unknown frame 'tip' (the URDF has 30 links)"


def test_one_value_for_all_joints_has_a_unit_of_theirs(folder: Path) -> None:
    """An acceleration of 5 m/s^2 was taken for 5 rad/s^2."""
    urdf, robot = Path("arm.urdf"), Path("robot.yaml")
    text = robot.read_text().replace("acceleration: {shoulder: 10, elbow: 20}", "acceleration: 5 m/s^2")
    robot.write_text(text.replace("viability: true", "viability: true\n  tolerance: 1 mm"))
    assert load("robot.yaml").limits.acceleration == 5.0  # the lift slides
    urdf.write_text(urdf.read_text().replace('type="prismatic"', 'type="revolute"'))
    robot.write_text(robot.read_text().replace("{lift: 10 cm}", "{lift: 0.1}"))
    with pytest.raises(ConfigError) as caught:
        load("robot.yaml")
    assert [str(problem) for problem in caught.value.problems] == [
        "robot.yaml:13: limits.acceleration: '5 m/s^2': every joint turns; give an angle",
        "robot.yaml:15: limits.tolerance: '1 mm': every joint turns; give an angle",
    ]
