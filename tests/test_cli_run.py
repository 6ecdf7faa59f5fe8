"""`proxgen run`: what plant, noise and start do to a run, and where its numbers may go."""

import argparse
import json
from pathlib import Path

import pytest

from proxgen.cli import main
from proxgen.cli.arguments import new_file

EXAMPLES = Path(__file__).parent.parent / "examples"
PLANAR2 = str(EXAMPLES / "planar2" / "planar2.yaml")
IIWA7 = str(EXAMPLES / "iiwa7" / "iiwa7.yaml")


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _numbers_of_run(robot: str, scene: str, *words: str) -> dict[str, object]:
    """The numbers of a short run of the reference."""
    given = ["run", robot, "--scene", scene, "--controller", "reference", "--duration", "2"]
    assert main([*given, *words, "--json", "run.json"]) == 0
    numbers: dict[str, object] = json.loads(Path("run.json").read_text())
    return {key: value for key, value in numbers.items() if key != "cycle_us"}


def test_a_device_needs_no_folder_that_can_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """Such as /dev/stdout for those who are not root."""
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != Path("/dev"))
    assert new_file("/dev/null") == Path("/dev/null")
    with pytest.raises(argparse.ArgumentTypeError, match="nothing can be written in /dev"):
        new_file("/dev/numbers.json")


def test_plant_noise_and_start_of_a_run() -> None:
    plain = _numbers_of_run(PLANAR2, "post")
    assert plain == _numbers_of_run(PLANAR2, "post")
    flags = (
        ["--plant", "dynamic"],
        ["--plant", "dynamic", "--latency", "50 ms"],
        ["--perturb", "1"],
        ["--perturb", "2"],
    )
    runs = [plain, *(_numbers_of_run(PLANAR2, "post", *words) for words in flags)]
    assert len({repr(run) for run in runs}) == len(runs)


def test_noise_and_dropouts_are_the_sensors() -> None:
    noisy = ["--noise", "50 mm", "--dropout", "0.2"]
    ways: list[list[str]] = [[], noisy, [*noisy, "--seed", "1"]]
    runs = [_numbers_of_run(IIWA7, "moving", *words) for words in ways]  # the other arm sees nothing so soon
    assert len({repr(run["mean_abs_dqdot"]) for run in runs}) == len(runs)
