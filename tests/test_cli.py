"""The command line: what it answers, with which exit status, and what it writes."""

import json
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from proxgen import __version__
from proxgen.cli import files, main
from proxgen.cli.output import columns, progress_bar, write_json
from proxgen.cli.runs import SCENES
from proxgen.config.scene import scene_names
from proxgen.errors import BuildError, ProxgenWarning

ROOT = Path(__file__).parent.parent
PLANAR2 = str(ROOT / "examples" / "planar2" / "planar2.yaml")
VERBS = "bench, build, check, compare, generate, init, reproduce, run, schema"

RUN_KEYS = {
    "scene", "controller", "backend", "sensing", "seed", "duration_s", "cycles", "targets_reached",
    "min_distance_axis_m", "min_distance_surface_m", "time_below_dr_fraction", "penetration_samples",
    "mean_abs_dqdot", "max_abs_dqdot", "status_counts", "solver_failures", "limit_violations", "cycle_us",
}  # fmt: skip
COMPARE_KEYS = {
    "scene", "cycles", "max_abs_qdot_error", "max_abs_H_error", "max_abs_A_error", "max_kkt_residual",
    "status_mismatches",
}  # fmt: skip


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"proxgen {__version__}\n"


@pytest.mark.parametrize("verb", ["", *VERBS.split(", ")])
def test_help(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([verb, "--help"] if verb else ["--help"]) == 0
    assert capsys.readouterr().out.startswith(f"usage: proxgen {verb}".rstrip())


def test_help_of_a_verb_says_what_it_does(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "--help"]) == 0
    assert "\n\nGenerate and compile the controller.\n\n" in capsys.readouterr().out


def test_help_names_the_scenes(capsys: pytest.CaptureFixture[str]) -> None:
    assert list(SCENES) == scene_names()
    assert main(["run", "--help"]) == 0
    assert "facing, gap, moving, pillar, post" in capsys.readouterr().out


def test_no_words_at_all_is_help_and_a_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 2
    assert "verbs:" in capsys.readouterr().out


def test_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", PLANAR2]) == 0
    assert capsys.readouterr().out == (f"{PLANAR2}: no problems (2 joints, 2 capsules, 4 sensor modules)\n")


@pytest.mark.filterwarnings("default::proxgen.errors.ProxgenWarning")
def test_check_warns_of_braking_that_the_drives_may_not_have(capsys: pytest.CaptureFixture[str]) -> None:
    Path("gentle.yaml").write_text(f"extends: {PLANAR2}\nlimits: {{acceleration: 10}}\n")
    assert main(["check", "gentle.yaml"]) == 0
    said = capsys.readouterr()
    assert said.out.startswith("gentle.yaml: no problems")
    assert said.err.startswith("proxgen: warning: gentle.yaml:2: limits.acceleration: in front of a position")
    Path("gentle.yaml").write_text(f"extends: {PLANAR2}\nlimits: {{acceleration: 10, viability: true}}\n")
    assert main(["check", "gentle.yaml"]) == 0
    assert capsys.readouterr().err == ""


def test_check_of_a_scene(capsys: pytest.CaptureFixture[str]) -> None:
    scene = str(ROOT / "examples" / "scenes" / "gap.yaml")
    assert main(["check", scene]) == 0
    assert capsys.readouterr().out == f"{scene}: no problems (a scene with 2 obstacles and 2 targets)\n"


def test_check_explain_shows_values_places_and_limits(capsys: pytest.CaptureFixture[str]) -> None:
    line = Path(PLANAR2).read_text().splitlines().index("  d_r: 8 cm") + 1
    assert main(["check", PLANAR2, "--explain"]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert f"d_r: 0.08 m # {PLANAR2}:{line}" in lines
    assert "row_speed: 1.0 rad/s # default" in lines
    assert lines[-4:] == [
        "# limits in use, the URDF's (planar2.urdf) where the file gives none:",
        "# joint lower upper velocity acceleration",
        "# joint_1 -3 3 2 20",
        "# joint_2 -2.8 2.8 2.5 20",
    ]


def test_schema(capsys: pytest.CaptureFixture[str]) -> None:
    titles = []
    for words in (["schema"], ["schema", "--scene"]):
        assert main(words) == 0
        titles.append(json.loads(capsys.readouterr().out)["title"])
    assert titles == ["proxgen robot", "proxgen scene"]
    assert main(["schema", "--page"]) == 0
    assert capsys.readouterr().out == (ROOT / "docs" / "configuration.md").read_text()


def test_a_failure_has_its_status_and_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    failures: dict[int, BaseException] = {
        2: BuildError("the compiler refused the code", ["cc", "-c", "a.c"], "a.c:1: error\n"),
        130: KeyboardInterrupt(),
    }
    for status, failure in failures.items():

        def fail(arguments: object, failure: BaseException = failure) -> int:
            raise failure

        monkeypatch.setattr(files, "carry_out_schema", fail)
        assert main(["schema"]) == status
    assert capsys.readouterr().err == (
        "proxgen: the compiler refused the code\ncommand: cc -c a.c\na.c:1: error\nproxgen: interrupted\n"
    )


def test_a_warning_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def warn(arguments: object) -> int:
        warnings.simplefilter("default")
        warnings.warn("a mesh was not read", ProxgenWarning, stacklevel=1)
        return 0

    monkeypatch.setattr(files, "carry_out_schema", warn)
    assert main(["schema"]) == 0
    assert capsys.readouterr().err == "proxgen: warning: a mesh was not read\n"


def test_a_reader_that_stops_early_is_no_failure() -> None:
    command = f"'{sys.executable}' -m proxgen schema | head -n 1"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=True)
    assert (result.stdout, result.stderr) == ("{\n", "")


def test_run_with_the_reference_writes_what_was_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["run", PLANAR2, "--scene", "post", "--controller", "reference", "--duration", "1 s"]
    words += ["--sensing", "ideal", "--seed", "3"]
    assert main([*words, "--json", "a/run.json", "--out", "b", "--film", "c/film.gif"]) == 0
    captured = capsys.readouterr()
    numbers = json.loads(Path("a/run.json").read_text())
    assert set(numbers) == RUN_KEYS
    assert set(numbers["cycle_us"]) == {"p50", "p99", "p999", "max"}
    assert numbers["cycles"] == sum(numbers["status_counts"].values()) == 50
    assert (numbers["scene"], numbers["controller"], numbers["sensing"], numbers["seed"]) == (
        "post", "reference", "ideal", 3,
    )  # fmt: skip
    assert json.loads(Path("b/summary.json").read_text()) == numbers
    assert {"log.npz", "index.html"} <= {path.name for path in Path("b").iterdir()}
    assert Path("b/figures/run1_film.gif").read_bytes() == Path("c/film.gif").read_bytes()
    assert "film: c/film.gif" in captured.out
    assert captured.err == ""  # no progress bar in a pipe
    assert "report: b/index.html" in captured.out


def test_a_scene_for_another_arm_is_a_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", PLANAR2, "--scene", "gap", "--controller", "reference"]) == 2
    assert "7 joint positions for an arm with 2 joints (joint_1, joint_2)" in capsys.readouterr().err


def test_init_writes_a_file_that_check_accepts(capsys: pytest.CaptureFixture[str]) -> None:
    urdf = str(ROOT / "examples" / "planar2" / "planar2.urdf")
    assert main(["init", urdf, "--tool", "tool", "-o", "arm/arm.yaml"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "wrote arm/arm.yaml and arm/arm_scene.yaml"
    assert main(["check", "arm/arm.yaml"]) == 0
    assert main(["check", "arm/arm_scene.yaml"]) == 0
    assert main(["init", urdf, "--tool", "tool", "-o", "arm/arm.yaml"]) == 2
    assert "the file exists already" in capsys.readouterr().err


@pytest.mark.slow
def test_generate_build_run_and_compare(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", PLANAR2]) == 0
    assert capsys.readouterr().out == "generated generated/planar2\n"
    assert Path("generated/planar2/model.h").is_file()
    assert main(["build", PLANAR2, "--backend", "qpoases"]) == 0
    assert capsys.readouterr().out == "built build/planar2\n"
    assert main(["build", PLANAR2]) == 0
    assert capsys.readouterr().out == "up to date: build/planar2\n"
    assert main(["run", PLANAR2, "--scene", "post", "--duration", "1"]) == 0
    assert "compiled" in capsys.readouterr().out
    words = ["compare", PLANAR2, "--duration", "2", "--json", "compare.json", "--out", "report"]
    assert main(words) == 0
    numbers = json.loads(Path("compare.json").read_text())
    assert numbers["verdict"] == "pass"
    assert [scene["scene"] for scene in numbers["scenes"]] == ["post"]  # the others are the iiwa's
    assert set(numbers["scenes"][0]) == COMPARE_KEYS
    assert capsys.readouterr().out.splitlines()[-1] == "verdict: pass"
    assert Path("report/index.html").is_file()


def test_a_comparison_that_fails_has_status_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Failed:
        verdict = "fail"
        failures = ("post, cycle 3: qdot differs by 0.1 rad/s",)
        scenes = ()

        def to_json(self) -> dict[str, object]:
            return {"scenes": [dict.fromkeys(COMPARE_KEYS, 0)], "verdict": "fail"}

    monkeypatch.setattr("proxgen.compare.compare", lambda *arguments, **options: Failed())
    assert main(["compare", PLANAR2, "--scene", "post", "--json", "compare.json"]) == 1
    assert capsys.readouterr().out.splitlines()[-2:] == [
        "post, cycle 3: qdot differs by 0.1 rad/s",
        "verdict: fail",
    ]
    assert json.loads(Path("compare.json").read_text())["verdict"] == "fail"


def test_an_interruption_while_modules_are_loaded_is_no_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class CtrlC:
        def find_spec(self, name: str, *rest: object) -> None:
            if name == "proxgen.cli.parser":
                raise KeyboardInterrupt

    monkeypatch.delitem(sys.modules, "proxgen.cli.parser", raising=False)
    monkeypatch.setattr(sys, "meta_path", [CtrlC(), *sys.meta_path])
    assert main(["--version"]) == 130
    assert capsys.readouterr().err == "proxgen: interrupted\n"


@pytest.mark.filterwarnings("default::proxgen.errors.ProxgenWarning")
def test_an_arm_without_sensors_is_told_that_it_sees_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    text = Path(PLANAR2).read_text().replace("urdf: ", f"urdf: {Path(PLANAR2).parent}/")
    begin, end = text.index("  cuffs:\n"), text.index("  tof: {")
    Path("blind.yaml").write_text(f"{text[:begin]}  cuffs: []\n{text[end:]}")
    words = ["run", "blind.yaml", "--scene", "post", "--controller", "reference", "--duration", "0.1"]
    assert main(words) == 0
    assert capsys.readouterr().err.startswith("proxgen: warning: blind.yaml: the arm has no sensors")
    assert main([*words, "--sensing", "ideal"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.filterwarnings("default::proxgen.errors.ProxgenWarning")
def test_a_scene_in_which_nothing_can_go_well_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    Path("far.yaml").write_text("name: far\ntargets: [{position: [500, 0, 0]}]\n")
    words = ["run", PLANAR2, "--scene", "far.yaml", "--controller", "reference", "--duration", "0.1"]
    assert main(words) == 0
    assert capsys.readouterr().err.startswith(
        "proxgen: warning: far.yaml: targets.0 is 500 m from the first joint"
    )


def test_json_that_nothing_else_reads_is_not_written() -> None:
    write_json(Path("folder/a.json"), {"x": 1.0})
    with pytest.raises(ValueError, match="not JSON compliant"):
        write_json(Path("folder/a.json"), {"x": float("nan")})
    assert json.loads(Path("folder/a.json").read_text()) == {"x": 1.0}
    assert [path.name for path in Path("folder").iterdir()] == ["a.json"]


def test_a_progress_bar_on_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with progress_bar("in a pipe") as progress:
        assert progress is None
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with progress_bar("on a terminal") as progress:
        assert progress is not None
        progress(1, 2)
        progress(2, 2)
    assert "on a terminal" in capsys.readouterr().err


def test_columns() -> None:
    assert columns([("name", "a"), ("x", "10.5"), ("longer", "")]) == "name       a\nx       10.5\nlonger"
