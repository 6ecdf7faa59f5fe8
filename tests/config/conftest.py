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

DATA = Path(__file__).parent / "data"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with `robot.yaml` and `arm.urdf`; it is the current one."""
    monkeypatch.chdir(tmp_path)
    for name in ("robot.yaml", "arm.urdf"):
        Path(name).write_bytes((DATA / name).read_bytes())
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
