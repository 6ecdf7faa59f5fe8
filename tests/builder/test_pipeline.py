import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from proxgen.builder import BuildResult, build, other_owner, pipeline
from proxgen.builder.stamp import PRIVATE
from proxgen.cli import main
from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.errors import BuildError, GenerateError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def built(planar2_daqp: BuildResult, planar2_config: Config, tmp_path: Path) -> BuildResult:
    """A build folder of one's own, which is one that was moved."""
    shutil.copytree(planar2_daqp.library_dir, tmp_path / "build" / "planar2")
    result = build(planar2_config, tmp_path / "build" / "planar2", backend="daqp")
    assert not result.rebuilt
    return result


def installed_files(directory: Path) -> dict[str, bytes]:
    """Everything that a build leaves, but its private memory and the generated code."""
    return {
        str(path.relative_to(directory)): path.read_bytes()
        for path in sorted(directory.rglob("*"))
        if path.is_file() and path.relative_to(directory).parts[0] not in (PRIVATE, "generated")
    }


def with_threshold(config: Config, value: float) -> Config:
    """The configuration with another d_a."""
    avoidance = config.avoidance.model_copy(update={"d_a": value})
    return config.model_copy(update={"avoidance": avoidance})


def test_a_build_leaves_an_installable_folder(planar2_daqp: BuildResult) -> None:
    names = set(installed_files(planar2_daqp.library_dir))
    module = json.loads((planar2_daqp.library_dir / "proxgen.json").read_text())["module"]
    assert names == {
        "include/planar2/controller.h",
        "include/planar2/controller.hpp",
        "include/planar2/model.h",
        "include/proxgen/types.h",
        "lib/cmake/proxgen_planar2/proxgen_planar2Config.cmake",
        "lib/cmake/proxgen_planar2/proxgen_planar2ConfigVersion.cmake",
        "lib/libplanar2.a",
        "lib/libplanar2.so",
        "lib/pkgconfig/proxgen_planar2.pc",
        "proxgen.json",
        f"python/{module}.so",
        "share/proxgen_planar2/LICENSE.daqp",
        "share/proxgen_planar2/LICENSE.proxgen",
        "share/proxgen_planar2/manifest.json",
    }
    assert (planar2_daqp.robot, planar2_daqp.backend) == ("planar2", "daqp")
    assert planar2_daqp.generated == planar2_daqp.library_dir / "generated"


def test_qpoases_is_carried_along(iiwa7_qpoases: BuildResult) -> None:
    assert list((iiwa7_qpoases.library_dir / "lib").glob("libqpOASES.so.*"))
    licence = iiwa7_qpoases.library_dir / "share" / "proxgen_iiwa7" / "LICENSE.qpoases"
    assert "GNU LESSER GENERAL PUBLIC LICENSE" in licence.read_text()


def test_the_static_library_needs_the_heap_only_for_create(planar2_daqp: BuildResult, tmp_path: Path) -> None:
    """What a linker takes out of it for `create_in`, and for `create`."""
    library, needed = planar2_daqp.library_dir / "lib" / "libplanar2.a", {}
    for name in ("create_in_checked", "create_checked"):
        taken = tmp_path / f"{name}.o"
        command = ["ld", "-r", "-u", f"planar2_{name}", str(library), "-o", str(taken)]
        subprocess.run(command, check=True)
        listing = subprocess.run(["nm", "-u", str(taken)], check=True, capture_output=True, text=True).stdout
        needed[name] = set(listing.replace("U", " ").split())
    assert needed["create_in_checked"] & {"malloc", "free"} == set()
    assert needed["create_checked"] - needed["create_in_checked"] == {"malloc", "free"}


def test_nothing_is_done_again_while_nothing_changes(built: BuildResult, planar2_config: Config) -> None:
    times = {path: path.stat().st_mtime_ns for path in built.library_dir.rglob("*") if path.is_file()}
    again = build(planar2_config, built.library_dir, backend="daqp")
    assert not again.rebuilt
    assert {path: path.stat().st_mtime_ns for path in times} == times


def test_seeing_that_nothing_changed_needs_no_heavy_library(built: BuildResult) -> None:
    script = (
        "import sys, proxgen; from proxgen.builder import build; "
        f"config = proxgen.load({str(ROOT / 'examples/planar2/planar2.yaml')!r}); "
        f"assert not build(config, {str(built.library_dir)!r}, backend='daqp').rebuilt; "
        "assert not {'casadi', 'pinocchio', 'cffi', 'jinja2', 'numpy.random'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_a_changed_value_is_built_anew(built: BuildResult, planar2_config: Config) -> None:
    before = CompiledController.load(built.library_dir)
    changed = with_threshold(planar2_config, 0.4)
    assert build(changed, built.library_dir, backend="daqp").rebuilt
    after = CompiledController.load(built.library_dir)
    assert after.parameters["d_a"] == 0.4
    assert before.parameters["d_a"] != 0.4, "what is loaded stays as it was"
    assert len(list((built.library_dir / "python").iterdir())) == 1, "the old extension is gone"


def test_code_from_another_file_says_so(built: BuildResult, tmp_path: Path) -> None:
    for source in (ROOT / "examples" / "planar2").iterdir():
        (tmp_path / source.name.replace(".yaml", "_copy.yaml")).write_bytes(source.read_bytes())
    copied = build(load(tmp_path / "planar2_copy.yaml"), built.library_dir, backend="daqp")
    assert copied.rebuilt
    assert "proxgen generate planar2_copy.yaml" in (copied.generated / "model.h").read_text()


def test_a_missing_file_is_made_again(built: BuildResult, planar2_config: Config) -> None:
    library = built.library_dir / "lib" / "libplanar2.so"
    content = library.read_bytes()
    library.unlink()
    assert build(planar2_config, built.library_dir, backend="daqp").rebuilt
    assert library.read_bytes() == content


def test_generated_code_that_was_changed_by_hand_is_generated_again(
    built: BuildResult, planar2_config: Config
) -> None:
    model = built.generated / "model.c"
    text = model.read_text()
    model.write_text(text.replace("return", "return 1 +"))
    assert build(planar2_config, built.library_dir, backend="daqp").rebuilt
    assert model.read_text() == text


def test_a_lost_stamp_costs_time_only(built: BuildResult, planar2_config: Config) -> None:
    before = installed_files(built.library_dir)
    (built.library_dir / PRIVATE / "stamp.json").write_text("{")
    assert build(planar2_config, built.library_dir, backend="daqp").rebuilt
    assert installed_files(built.library_dir) == before


def test_builds_are_reproducible(planar2_daqp: BuildResult, planar2_config: Config, tmp_path: Path) -> None:
    again = build(planar2_config, tmp_path / "elsewhere", backend="daqp")
    assert installed_files(again.library_dir) == installed_files(planar2_daqp.library_dir)


def test_the_generated_code_can_be_put_elsewhere(
    built: BuildResult, planar2_config: Config, tmp_path: Path
) -> None:
    elsewhere = tmp_path / "code"
    result = build(planar2_config, built.library_dir, backend="daqp", generated=elsewhere)
    assert result.rebuilt and result.generated == elsewhere and (elsewhere / "model.h").is_file()
    assert not build(planar2_config, built.library_dir, backend="daqp", generated=elsewhere).rebuilt


def test_the_default_folder_is_named_after_the_robot(
    built: BuildResult, planar2_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert build(planar2_config, backend="daqp") == built


def test_files_with_the_same_name_do_not_take_each_others_folder(
    built: BuildResult,
    planar2_config: Config,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Each rebuilt over the other, and whoever linked with the folder got the last one."""
    monkeypatch.chdir(tmp_path)
    variant = tmp_path / "planar2_far.yaml"
    variant.write_text(f"extends: {planar2_config.source}\navoidance: {{d_a: 0.5}}\n")
    before = installed_files(built.library_dir)
    assert other_owner(planar2_config) is None
    assert other_owner(load(variant)) == planar2_config.source
    other = build(load(variant), backend="daqp")
    assert other.rebuilt and other.library_dir == tmp_path / "build" / "planar2.planar2_far"
    assert installed_files(built.library_dir) == before
    assert not build(planar2_config, backend="daqp").rebuilt
    assert not build(load(variant), backend="daqp").rebuilt

    assert main(["build", str(variant)]) == 2
    told = capsys.readouterr().err
    assert told == (
        f"{variant}: robot.name: build/planar2 holds the controller of {planar2_config.source}, which has "
        "the same name 'planar2'; give this file another one, or say with -o where to build\n1 problem\n"
    )
    assert main(["build", str(variant), "--backend", "daqp", "-o", str(other.library_dir)]) == 0


def test_a_file_that_was_renamed_keeps_its_folder(
    built: BuildResult, planar2_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    memory = built.library_dir / PRIVATE / "stamp.json"
    memory.write_text(memory.read_text().replace("planar2.yaml", "planar2_before.yaml"))
    assert other_owner(planar2_config) is None
    assert build(planar2_config, backend="daqp") == built


def test_a_compiler_that_refuses_leaves_the_last_good_build(
    built: BuildResult, planar2_config: Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = installed_files(built.library_dir)
    monkeypatch.setenv("CFLAGS", "-include no_such_header.h")
    with pytest.raises(BuildError) as failure:
        build(planar2_config, built.library_dir, backend="daqp")
    assert "no_such_header.h" in failure.value.output and failure.value.command
    assert installed_files(built.library_dir) == before
    CompiledController.load(built.library_dir)
    monkeypatch.delenv("CFLAGS")
    build(planar2_config, built.library_dir, backend="daqp")
    assert installed_files(built.library_dir) == before


def test_code_of_another_abi_stops_the_compiler(
    planar2_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from proxgen.emit import rendering

    monkeypatch.setattr(rendering, "ABI_VERSION", rendering.ABI_VERSION + 1)
    with pytest.raises(BuildError, match=r"another version of proxgen/types\.h"):
        build(planar2_config, tmp_path / "built", backend="daqp")
    assert not (tmp_path / "built" / "lib").exists()


def test_fast_math_is_refused_by_the_runtime(
    planar2_config: Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CFLAGS", "-ffast-math")
    with pytest.raises(BuildError, match="remove the checks for NaN"):
        build(planar2_config, tmp_path / "built", backend="daqp")


def test_a_failure_between_two_files_is_made_good_by_the_next_build(
    built: BuildResult, planar2_config: Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(made: Path, directory: Path, last: object) -> dict[str, int]:
        (made / "lib" / "libplanar2.a").replace(directory / "lib" / "libplanar2.a")
        raise KeyboardInterrupt

    changed = with_threshold(planar2_config, 0.35)
    with monkeypatch.context() as patch:
        patch.setattr(pipeline, "_move_into_place", interrupted)
        with pytest.raises(KeyboardInterrupt):
            build(changed, built.library_dir, backend="daqp")
    assert build(changed, built.library_dir, backend="daqp").rebuilt
    assert CompiledController.load(built.library_dir).parameters["d_a"] == 0.35
    assert not list((built.library_dir / PRIVATE).glob("work-*"))


def test_after_a_failure_the_old_build_is_not_believed_in(
    built: BuildResult, planar2_config: Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the same code with other flags: nobody can tell any more which of its files are whose."""

    def interrupted(made: Path, directory: Path, last: object) -> dict[str, int]:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setenv("CFLAGS", "-DUNUSED=1")
        patch.setattr(pipeline, "_move_into_place", interrupted)
        with pytest.raises(KeyboardInterrupt):
            build(planar2_config, built.library_dir, backend="daqp")
    assert build(planar2_config, built.library_dir, backend="daqp").rebuilt


def test_builds_at_the_same_time_do_not_disturb_each_other(tmp_path: Path) -> None:
    script = (
        "import sys, proxgen; from proxgen.builder import build; "
        f"config = proxgen.load({str(ROOT / 'examples/planar2/planar2.yaml')!r}); "
        "result = build(config, sys.argv[1], backend='daqp'); "
        "from proxgen.controllers.compiled import CompiledController; "
        "CompiledController.load(result.library_dir); print(result.rebuilt)"
    )
    target = str(tmp_path / "built")
    processes = [
        subprocess.Popen([sys.executable, "-c", script, target], stdout=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    told = sorted(process.communicate()[0].strip() for process in processes)
    assert all(process.returncode == 0 for process in processes)
    assert told == ["False", "False", "True"]


def test_a_folder_that_cannot_be_written_is_an_error_of_ours(planar2_config: Config, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BuildError, match="cannot write"):
        build(planar2_config, tmp_path / "file" / "built", backend="daqp")
    with pytest.raises((BuildError, GenerateError), match="cannot write"):
        build(planar2_config, tmp_path / "built", backend="daqp", generated=tmp_path / "file" / "code")


@pytest.mark.usefixtures("no_compilers")
def test_a_missing_compiler_is_told_before_anything_is_made(planar2_config: Config, tmp_path: Path) -> None:
    with pytest.raises(BuildError, match="no C compiler found"):
        build(planar2_config, tmp_path / "built", backend="daqp")
    assert not (tmp_path / "built").exists()


def test_the_back_end_of_the_configuration_is_the_default(iiwa7_config: Config, tmp_path: Path) -> None:
    solver = iiwa7_config.solver.model_copy(update={"backend": "unknown"})
    with pytest.raises(BuildError, match="unknown back end 'unknown'"):
        build(iiwa7_config.model_copy(update={"solver": solver}), tmp_path)
