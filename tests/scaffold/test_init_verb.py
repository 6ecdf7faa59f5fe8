"""`proxgen init` on the command line: what it says, and what it leaves behind when it fails."""

from pathlib import Path

import pytest
from arms import RECIPES
from solid_arms import write_solid_urdf

from proxgen.cli import main


def test_it_says_what_it_wrote_and_what_comes_next(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write_solid_urdf(RECIPES[0], tmp_path)
    monkeypatch.chdir(tmp_path)
    assert main(["init", "chain2.urdf", "--tool", "tool", "-o", "arm.yaml"]) == 0
    said = capsys.readouterr()
    assert said.out == (
        "wrote arm.yaml and arm_scene.yaml\n"
        "next: proxgen check arm.yaml && proxgen compare arm.yaml --scene arm_scene.yaml\n"
    )
    assert said.err == ""
    assert main(["check", "arm.yaml"]) == 0
    assert main(["init", "chain2.urdf", "--tool", "tool", "-o", "arm.yaml"]) == 2
    assert "arm.yaml: the file exists already; --force" in capsys.readouterr().err
    assert main(["init", "chain2.urdf", "--tool", "tool", "-o", "arm.yaml", "--force"]) == 0


@pytest.mark.parametrize(
    ("content", "message"),
    [(None, "the mesh 'wedge.obj' does not exist"), ("nothing", "wedge.obj cannot be read: ")],
)
def test_a_missing_or_broken_mesh_stops_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str | None, message: str
) -> None:
    urdf = write_solid_urdf(next(recipe for recipe in RECIPES if recipe.name == "skew6"), tmp_path)
    (tmp_path / "wedge.obj").unlink()
    if content is not None:
        (tmp_path / "wedge.obj").write_text(content)
    before = sorted(tmp_path.iterdir())
    assert main(["init", str(urdf), "--tool", "tool", "-o", str(tmp_path / "arm.yaml")]) == 2
    said = capsys.readouterr()
    assert message in said.err
    assert "Traceback" not in said.err
    assert said.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.filterwarnings("default::proxgen.errors.ProxgenWarning")
def test_blanks_are_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    urdf = write_solid_urdf(RECIPES[0], tmp_path)
    urdf.write_text(urdf.read_text().replace("velocity=", "pace="))
    assert main(["init", str(urdf), "--tool", "tool", "-o", str(tmp_path / "arm.yaml")]) == 0
    said = capsys.readouterr().err
    assert said.startswith("proxgen: warning: ")
    assert said.rstrip().endswith("limits.velocity.joint_0, limits.velocity.joint_1")
    assert main(["check", str(tmp_path / "arm.yaml")]) == 2
    assert "arm.yaml:" in capsys.readouterr().err
