"""The command line's answers to mistakes: in the words, in the names of files, in where it is to write."""

from pathlib import Path

import pytest

from proxgen.cli import MOST_PROBLEMS, main

ROOT = Path(__file__).parent.parent
PLANAR2 = str(ROOT / "examples" / "planar2" / "planar2.yaml")
GAP = str(ROOT / "examples" / "scenes" / "gap.yaml")
VERBS = "bench, build, check, compare, generate, init, reproduce, run, schema"


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["chek"], f"proxgen: unknown verb 'chek'; did you mean 'check'? (allowed: {VERBS})"),
        (["fly"], f"proxgen: unknown verb 'fly' (allowed: {VERBS})"),
        (
            ["--verion"],
            "proxgen: unknown flag '--verion'; did you mean '--version'? (allowed: --help, --version)",
        ),
        (
            ["check", "a.yaml", "--explan"],
            "proxgen check: unknown flag '--explan'; did you mean '--explain'? (allowed: --explain, --help)",
        ),
        (
            ["build", "a.yaml", "--backed=daqp"],
            "proxgen build: unknown flag '--backed'; did you mean '--backend'? "
            "(allowed: --backend, --help, --output)",
        ),
        (["check"], "proxgen check: the following arguments are required: FILE"),
        # not that --scene is missing, which was misspelt
        (
            ["init", "a.urdf", "--tol", "tcp"],
            "proxgen init: unknown flag '--tol'; did you mean '--tool'? "
            "(allowed: --force, --help, --output, --tool)",
        ),
        (["check", "a.yaml", "b.yaml"], "proxgen check: unexpected argument 'b.yaml'"),
        (["run", "a.yaml"], "proxgen run: the following arguments are required: --scene"),
        (
            ["build", "a.yaml", "--backend", "dacp"],
            "proxgen build: argument --backend: unknown back end 'dacp'; did you mean 'daqp'? "
            "(allowed: daqp, qpoases)",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--controller", "refrence"],
            "proxgen run: argument --controller: unknown controller 'refrence'; did you mean 'reference'? "
            "(allowed: compiled, reference, repulsive, tangential)",
        ),
        (
            ["compare", "a.yaml", "--sensing", "exact"],
            "proxgen compare: argument --sensing: unknown sensing 'exact' (allowed: ideal, skin)",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--duration", "-1"],
            "proxgen run: argument --duration: -1 is out of range "
            "(allowed: greater than 0 and at most 1e+06 s)",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--duration", "long"],
            "proxgen run: argument --duration: expected a time (a number in s, or with one of the units "
            "s, ms, us), found 'long'",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--plant", "dynamc"],
            "proxgen run: argument --plant: unknown plant 'dynamc'; did you mean 'dynamic'? "
            "(allowed: dynamic, kinematic)",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--latency", "20 ms"],
            "proxgen run: --latency is the control cabinet's; it needs --plant dynamic",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--sensing", "ideal", "--dropout", "0.1"],
            "proxgen run: --dropout is of the skin's sensors; it needs --sensing skin",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--noise", "5 deg"],
            "proxgen run: argument --noise: unit 'deg' does not measure a length (allowed: m, cm, mm)",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--dropout", "1"],
            "proxgen run: argument --dropout: 1 is out of range (allowed: at least 0 and less than 1)",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--seed", "1.5"],
            "proxgen run: argument --seed: expected a whole number from 0, found '1.5'",
        ),
        (
            ["bench", "--replays", "0"],
            "proxgen bench: argument --replays: expected a whole number from 1, found '0'",
        ),
        # before an hour's work, not after it
        (
            ["run", "a.yaml", "--scene", "gap", "--film", "film.mp4"],
            "proxgen run: argument --film: expected a name that ends in .gif or .webp, found 'film.mp4'",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--json", "."],
            "proxgen run: argument --json: . is a folder; a file is needed",
        ),
        (
            ["run", "a.yaml", "--scene", "gap", "--json", "/dev/null/a.json"],
            "proxgen run: argument --json: /dev/null is a file; a folder is needed",
        ),
        (
            ["bench", "--json", "-"],
            "proxgen bench: argument --json: '-' is no file; /dev/stdout is standard output",
        ),
        (
            ["generate", "a.yaml", "-o", "/dev/null"],
            "proxgen generate: argument -o/--output: /dev/null is a file; a folder is needed",
        ),
        (
            ["build", "a.yaml", "-o", "/dev/null/a"],
            "proxgen build: argument -o/--output: /dev/null is a file; a folder is needed",
        ),
        (
            ["init", "a.urdf", "--tool", "tcp", "-o", "."],
            "proxgen init: argument -o/--output: . is a folder; a file is needed",
        ),
        (
            ["compare", "a.yaml", "--out", "/dev/null"],
            "proxgen compare: argument --out: /dev/null is a file; a folder is needed",
        ),
    ],
)
def test_a_mistake_in_the_words(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    first, *usage = capsys.readouterr().err.splitlines()
    assert first == message
    assert usage[0].startswith("usage: proxgen")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["check", "none.yaml"], "none.yaml: the file does not exist\n1 problem\n"),
        (["generate", "none.yaml"], "none.yaml: the file does not exist\n1 problem\n"),
        (["build", "none.yaml"], "none.yaml: the file does not exist\n1 problem\n"),
        (["run", "none.yaml", "--scene", "gap"], "none.yaml: the file does not exist\n1 problem\n"),
        (["compare", "none.yaml"], "none.yaml: the file does not exist\n1 problem\n"),
        (
            ["run", PLANAR2, "--scene", "pots"],
            "pots: unknown scene 'pots'; did you mean 'post'? (allowed: facing, gap, moving, pillar, post)\n"
            "1 problem\n",
        ),
        (
            ["compare", PLANAR2, "--scene", "my.yaml"],
            "my.yaml: the file does not exist\n1 problem\n",
        ),
        (["build", GAP], f"{GAP}: this is a scene; the YAML file of a robot is needed here\n1 problem\n"),
        (
            ["compare", PLANAR2, "--scene", PLANAR2],
            f"{PLANAR2}: this is a robot's file; the YAML file of a scene is needed here\n1 problem\n",
        ),
        (
            ["run", PLANAR2, "--scene", "gap.yaml"],
            "gap.yaml: the file does not exist; the scene 'gap' is named without an ending\n1 problem\n",
        ),
    ],
)
def test_a_file_that_is_not_there_or_another(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    assert capsys.readouterr().err == message
    assert list(Path().iterdir()) == []


def test_of_very_many_problems_the_first_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.yaml").write_text("\n".join(f"key{index:04}: 1" for index in range(3000)))
    assert main(["check", "a.yaml"]) == 2
    *problems, count = capsys.readouterr().err.splitlines()
    assert len(problems) == MOST_PROBLEMS
    assert problems[-1].startswith("a.yaml:98: key0097: unknown key")  # after two that are missing
    assert count == f"3002 problems; these are the first {MOST_PROBLEMS}"


def test_a_full_disk_is_said_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["run", PLANAR2, "--scene", "post", "--controller", "reference", "--duration", "0.1"]
    assert main([*words, "--json", "/dev/full"]) == 1
    assert capsys.readouterr().err == "proxgen: No space left on device\n"


def test_an_output_that_cannot_be_written_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    Path("file").write_text("")
    words = ["run", PLANAR2, "--scene", "post", "--controller", "reference", "--duration", "0.1"]
    assert main([*words, "--json", "file/run.json"]) == 2
    told = capsys.readouterr()
    assert told.err.startswith("proxgen run: argument --json: file is a file; a folder is needed\n")
    assert told.out == ""  # said before the run
    assert [path.name for path in Path().iterdir()] == ["file"]
