"""The runtime's own tests in C, on both solvers, plain and with sanitizers; what it needs and offers."""

import re
from pathlib import Path

import numpy as np
import pytest
from runtime_kit import RUNTIME, SANITIZE, TESTS, Kit, Variant

from proxgen.builder.solvers import find_solver
from proxgen.builder.toolchain import find_toolchain, run
from proxgen.errors import BuildError

BACKENDS = ("daqp", "qpoases")
SLACK = "-DPG_RELAXATION_SLACK=1"
DAMPER = "-DPLANAR_SCHEDULE_DAMPER=1"
NO_ACTIVE_ROW = "-DPLANAR_ACTIVE_ROW=0"
FEW_CHANGES = "-DPG_MAX_ITERATIONS=2"
STRICT = "-DPG_TOLERANCE=1e-17"
INJECTION = "-DPG_FAULT_INJECTION"
SELF_COLLISION = ("self_collision",)
SELF_MEASUREMENT = ("self_measurement",)
MEMORY = ("memory",)
CIRCULATION = ("circulation",)
WITHOUT_METHODS = (*SELF_MEASUREMENT, *MEMORY, *CIRCULATION, *SELF_COLLISION)
REPULSIVE, TANGENTIAL = ("repulsive",), ("tangential",)

CASES = [
    ("test_faults.c", ()),
    ("test_faults.c", (SLACK,)),
    ("test_ladder.c", ()),
    ("test_ladder.c", (DAMPER,)),
    ("test_ladder.c", (NO_ACTIVE_ROW,)),
    ("test_slack.c", (SLACK,)),
    ("test_skin.c", ()),
    ("test_limits.c", ()),
    ("test_certificate.c", ()),
    ("test_minimum.c", ()),
    ("test_solver.c", ()),
    ("test_solver.c", (FEW_CHANGES,)),
    ("test_life.c", ()),
    ("test_life.c", (SLACK,)),
    ("test_injection.c", (INJECTION,)),
    ("test_wrapper.cpp", ()),
]


CASES_OF_ADDITIONS = [
    ("test_self_collision.c", (), SELF_COLLISION),
    ("test_self_collision.c", (SLACK,), SELF_COLLISION),
    ("test_self_collision.c", (DAMPER, NO_ACTIVE_ROW), SELF_COLLISION),
    ("test_life.c", (), SELF_COLLISION),
    ("test_self_measurement.c", (), SELF_MEASUREMENT),
    ("test_memory.c", (), MEMORY),
    ("test_circulation.c", (), CIRCULATION),
    ("test_faults.c", (), (*SELF_MEASUREMENT, *MEMORY, *CIRCULATION)),
    ("test_life.c", (), WITHOUT_METHODS),
    ("test_baselines.c", (), REPULSIVE),
    ("test_baselines.c", (DAMPER,), REPULSIVE),
    ("test_baselines.c", (), TANGENTIAL),
    ("test_baselines.c", (DAMPER,), TANGENTIAL),
    ("test_life.c", (), TANGENTIAL),
]


@pytest.fixture(scope="session")
def kit(tmp_path_factory: pytest.TempPathFactory) -> Kit:
    """Compiles into one folder."""
    return Kit(tmp_path_factory.mktemp("runtime"))


@pytest.mark.parametrize("checks", [(), SANITIZE], ids=["plain", "sanitizers"])
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("name", "options"), CASES, ids=lambda value: "".join(value))
def test_in_c(name: str, options: tuple[str, ...], backend: str, checks: tuple[str, ...], kit: Kit) -> None:
    assert kit.test(name, Variant(backend, (*options, *checks))) == "", "the runtime prints something"


@pytest.mark.parametrize("checks", [(), SANITIZE], ids=["plain", "sanitizers"])
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("name", "options", "additions"), CASES_OF_ADDITIONS, ids=lambda value: "".join(value)
)
def test_additions_in_c(
    name: str,
    options: tuple[str, ...],
    additions: tuple[str, ...],
    backend: str,
    checks: tuple[str, ...],
    kit: Kit,
) -> None:
    kit.test(name, Variant(backend, (*options, *checks), additions=additions))


@pytest.mark.parametrize("additions", [(), WITHOUT_METHODS], ids=["plain", "additions"])
def test_no_heap_with_daqp(additions: tuple[str, ...], kit: Kit) -> None:
    wrap = ",".join(f"--wrap={name}" for name in ("malloc", "calloc", "realloc", "free"))
    kit.test("test_heap.c", Variant("daqp", additions=additions), f"-Wl,{wrap}")


def test_threads_share_nothing(kit: Kit) -> None:
    kit.test("test_threads.c", Variant("daqp", ("-g", "-fsanitize=thread")), "-pthread")
    assert kit.test("test_threads.c", Variant("qpoases"), "-pthread") == "", "something is printed"


@pytest.mark.parametrize("second", BACKENDS)
def test_two_robots_in_one_program(second: str, kit: Kit) -> None:
    others = [Variant(second, robot="second")]
    kit.robot("second")
    program = kit.program(TESTS / "test_two_robots.c", Variant("daqp"), others=others)
    assert run([str(program)], "two robots disturb each other") == f"daqp and {second}\n"


def records(program: Path, folder: Path, *options: str) -> np.ndarray:
    """Rows of status, residual and velocities of random cycles."""
    path = folder / "cycles"
    run([str(program), "100000", "1", *options, "--record", str(path)], "a promise is broken")
    values = np.fromfile(path)
    return values.reshape(100000, -1)


@pytest.mark.slow
@pytest.mark.parametrize("options", [("--plain",), ()], ids=["default parameters", "random parameters"])
@pytest.mark.parametrize("mode", [(), (SLACK,)], ids=["staged", "slack"])
def test_random_cycles_agree(
    mode: tuple[str, ...], options: tuple[str, ...], kit: Kit, tmp_path: Path
) -> None:
    check_that_back_ends_agree(kit, tmp_path, mode, (), options)


@pytest.mark.slow
@pytest.mark.parametrize("additions", [SELF_COLLISION, REPULSIVE, TANGENTIAL], ids="".join)
def test_random_cycles_with_other_rows_agree(additions: tuple[str, ...], kit: Kit, tmp_path: Path) -> None:
    """Pairs of rows against each other, and rows that one joint alone can serve."""
    check_that_back_ends_agree(kit, tmp_path, (), additions, ())


def check_that_back_ends_agree(
    kit: Kit, tmp_path: Path, mode: tuple[str, ...], additions: tuple[str, ...], options: tuple[str, ...]
) -> None:
    source = TESTS / "random_cycles.c"
    first, second = (kit.program(source, Variant(backend, mode, additions=additions)) for backend in BACKENDS)
    daqp = records(first, tmp_path, *options)
    (tmp_path / "cycles").rename(tmp_path / "daqp")
    qpoases = records(second, tmp_path, *options, "--follow", str(tmp_path / "daqp"))
    assert np.array_equal(daqp[:, 0], qpoases[:, 0]), "statuses differ"
    stages = {0} if mode else {0, 1, 2, 3, 8} if additions in (REPULSIVE, TANGENTIAL) else {0, 1, 2, 3, 4, 8}
    assert set(np.unique(daqp[:, 0])) >= stages | {16, 17, 18, 20, 22}
    difference = np.abs(daqp[:, 2:] - qpoases[:, 2:]).max(axis=1)
    # A touching obstacle may leave a joint to a row with a lever arm of 1e-6 m, so 1e-8 m/s is much.
    assert np.count_nonzero(difference > 1e-8) <= 2


@pytest.mark.slow
@pytest.mark.parametrize("options", [(), SANITIZE], ids=["plain", "sanitizers"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_random_cycles_with_anything_that_is_accepted(
    backend: str, options: tuple[str, ...], kit: Kit
) -> None:
    program = kit.program(TESTS / "random_cycles.c", Variant(backend, options))
    run([str(program), "20000" if options else "100000", "2", "--extreme"], "a promise is broken")


@pytest.mark.parametrize("extreme", [(), ("--extreme",)], ids=["usual", "extreme"])
def test_random_cycles_with_additions(extreme: tuple[str, ...], kit: Kit) -> None:
    """Points come and go, and the task changes its direction, under sanitizers."""
    variant = Variant("daqp", SANITIZE, additions=WITHOUT_METHODS)
    run([str(kit.program(TESTS / "random_cycles.c", variant)), "20000", "5", *extreme], "a promise is broken")


@pytest.mark.parametrize("mode", [(), (SLACK,)], ids=["staged", "slack"])
def test_a_tolerance_near_rounding_is_kept(mode: tuple[str, ...], kit: Kit) -> None:
    """Then many answers are not good enough, most are asked for again, and the best of them counts."""
    program = kit.program(TESTS / "random_cycles.c", Variant("daqp", (STRICT, *mode)))
    counted = run([str(program), "20000", "6"], "a promise is broken")
    assert "STOPPED_SOLVER" in counted
    (chances, refused) = re.findall(r"(\d+) second chances, (\d+) not certified", counted)[0]
    assert int(chances) > 1000 and int(refused) > 100


@pytest.mark.parametrize("backend", BACKENDS)
def test_few_changes_still_end_in_a_decision(backend: str, kit: Kit) -> None:
    program = kit.program(TESTS / "random_cycles.c", Variant(backend, (FEW_CHANGES, *SANITIZE)))
    assert "STOPPED_SOLVER" in run([str(program), "5000", "3"], "a promise is broken")


def symbols(path: Path) -> list[tuple[str, str]]:
    """Kind and name of all symbols of an object."""
    lines = run(["nm", "--portability", str(path)], "nm").splitlines()
    return [(line.split()[1], line.split()[0]) for line in lines]


@pytest.mark.parametrize(
    "additions", [(), WITHOUT_METHODS, TANGENTIAL], ids=["plain", "additions", "tangential"]
)
def test_what_a_library_needs_and_offers(additions: tuple[str, ...], kit: Kit) -> None:
    objects = kit.objects(Variant("daqp", additions=additions))
    found = {path.stem: symbols(path) for path in objects}
    defined = {name for each in found.values() for kind, name in each if kind not in "Uw"}
    if not additions:
        off = ("self_measurement", "memory", "circulation", "tangents", "self_collision", "baselines")
        assert {stem: found[stem] for stem in off} == {stem: [] for stem in off}, "what is off costs code"
    needed = {
        name for stem, each in found.items() if stem != "heap" for kind, name in each if kind == "U"
    } - defined
    allowed = {
        "memcpy",
        "memmove",
        "memset",
        "memcmp",
        "sqrt",
        "sin",
        "cos",
        "sincos",
        "_GLOBAL_OFFSET_TABLE_",
    }
    assert needed <= allowed, "more of the C library than embedded use allows"

    solver = {path.stem for path in find_solver("daqp").units}
    ours = [(kind, name) for stem, each in found.items() if stem not in solver for kind, name in each]
    offered = {name for kind, name in ours if kind in "TDBRC"}
    assert {name for name in offered if not name.startswith("planar_")} == set()
    assert [name for kind, name in ours if kind in "DdBbC"] == [], "there are no variables"


def test_versions_must_fit(kit: Kit, tmp_path: Path) -> None:
    binding = (kit.robot("planar") / "binding.h").read_text()
    (tmp_path / "binding.h").write_text(re.sub(r"(?<=PG_MODEL_ABI)\s+1", " 2", binding))
    toolchain, source = find_toolchain(cxx=False), RUNTIME / "src" / "cycle.c"
    command = [*toolchain.compile_command(source), f"-I{tmp_path}", *kit.includes(Variant("daqp"))]
    with pytest.raises(BuildError, match="run `proxgen generate` again"):
        run([*command, "-c", str(source), "-o", "/dev/null"], "refused")


@pytest.mark.parametrize("option", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_fast_math_is_refused(kit: Kit, option: str) -> None:
    toolchain, source = find_toolchain(cxx=False), RUNTIME / "src" / "cycle.c"
    command = [*toolchain.compile_command(source), option, *kit.includes(Variant("daqp"))]
    with pytest.raises(BuildError, match="remove the checks for NaN"):
        run([*command, "-c", str(source), "-o", "/dev/null"], "refused")


def test_the_program_in_the_readme_runs(kit: Kit, tmp_path: Path) -> None:
    (code,) = re.findall(r"^```c\n(.*?)^```", (RUNTIME / "README.md").read_text(), re.M | re.S)
    source = tmp_path / "readme.c"
    source.write_text(code.replace("<arm/", "<planar/").replace("arm_", "planar_").replace("ARM_", "PLANAR_"))
    assert run([str(kit.program(source, Variant("daqp")))], "the program in the README fails") == ""


def test_the_readme_names_tests_that_exist() -> None:
    readme = (RUNTIME / "README.md").read_text()
    section = readme[readme.index("## Faults") :]
    texts = {path.name: path.read_text() for path in [*TESTS.iterdir(), Path(__file__)] if path.is_file()}
    python = Path(__file__).read_text()
    rows = [line for line in section.splitlines() if line.startswith("| ") and "`" in line.split("|")[-2]]
    assert len(rows) > 20
    for row in rows:
        names = re.findall(r"`([a-z]\w*(?:\.c)?|parameters_out_of_\*)`", row.split("|")[-2])
        for name in names:
            known = name in texts or any(f"{name.rstrip('*')}" in text for text in (*texts.values(), python))
            assert known, f"{name} is nowhere"
