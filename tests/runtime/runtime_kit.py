"""Compiles the runtime around the hand-written planar arm, in variants, and runs its C tests.

Objects of the runtime are compiled once per variant and linked with each test program.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from proxgen.builder.solvers import find_solver
from proxgen.builder.toolchain import find_toolchain, run, run_all
from proxgen.program import ADDITIONS
from proxgen.templates import environment

ROOT = Path(__file__).resolve().parents[2]
RUNTIME = ROOT / "runtime"
TESTS = RUNTIME / "tests"

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
SANITIZE = ("-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@dataclass(frozen=True)
class Variant:
    """A way to compile the runtime.

    Attributes:
        backend: `daqp` or `qpoases`.
        options: of compiler and linker: sanitizers, and macros that choose what generated code would.
        robot: prefix of all names; another than `planar` makes a copy of it.
        additions: to the method, of `program.ADDITIONS`; in C the macro PLANAR_<NAME> is 1 for each.
    """

    backend: str
    options: tuple[str, ...] = ()
    robot: str = "planar"
    additions: tuple[str, ...] = ()

    @property
    def arm(self) -> str:
        """Name of the folder with the arm's code."""
        return "-".join([self.robot, *self.additions])

    @property
    def flags(self) -> list[str]:
        """Options of compiler and linker."""
        return [*self.options, *(f"-D{self.robot}_{name}=1".upper() for name in self.additions)]

    @property
    def name(self) -> str:
        """For folders and test ids."""
        words = [option.lstrip("-").replace("=", "_").replace(",", "_") for option in self.options]
        return "-".join([self.arm, self.backend, *words])


class Kit:
    """Compiles variants into a folder, each once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._objects: dict[Variant, list[Path]] = {}

    def robot(self, robot: str, additions: tuple[str, ...] = ()) -> Path:
        """Folder with the arm's code under this name: hand-written files, and rendered public headers."""
        folder = self.folder / "-".join([robot, *additions])
        if not folder.exists():
            folder.mkdir(parents=True)
            for source in (TESTS / "mock_planar").iterdir():
                text = source.read_text().replace("planar", robot).replace("PLANAR", robot.upper())
                (folder / source.name).write_text(text)
            for name in ("controller.h", "controller.hpp"):
                (folder / name).write_text(render_header(name, robot, additions))
        return folder

    def includes(self, variant: Variant) -> list[str]:
        """Options that name the folders of headers."""
        own = [
            self.robot(variant.robot, variant.additions),
            RUNTIME / "include",
            RUNTIME / "src",
            self.folder,
        ]
        return [*(f"-I{path}" for path in own), "-isystem", str(find_solver(variant.backend).include)]

    def compile(self, sources: Sequence[Path], variant: Variant, options: Sequence[str]) -> list[Path]:
        """Objects of some sources, with the flags of the product and these."""
        toolchain, solver = find_toolchain(cxx=True), find_solver(variant.backend)
        folder = self.folder / f"{variant.name}-objects"
        folder.mkdir(exist_ok=True)
        objects = [folder / f"{source.stem}.o" for source in sources]
        flags = [*variant.flags, *options, *self.includes(variant)]
        run_all(
            (
                [
                    *toolchain.compile_command(source),
                    *solver.options(source),
                    *flags,
                    *("-c", str(source), "-o", str(made)),
                ],
                f"{source.name}",
            )
            for source, made in zip(sources, objects, strict=True)
        )
        return objects

    def objects(self, variant: Variant) -> list[Path]:
        """The runtime, the arm and the solver."""
        if variant not in self._objects:
            solver = find_solver(variant.backend)
            units = [path for path in (RUNTIME / "src").glob("*.c") if not path.name.startswith("solver_")]
            units += (RUNTIME / "src").glob(f"solver_{variant.backend}.*")
            arm = self.robot(variant.robot, variant.additions)
            own = self.compile([*sorted(units), arm / "model.c"], variant, WARNINGS)
            self._objects[variant] = own + self.compile(solver.units, variant, ())
        return self._objects[variant]

    def program(self, source: Path, variant: Variant, *options: str, others: Sequence[Variant] = ()) -> Path:
        """A test program, linked with a variant, and with other robots."""
        objects = [*self.compile([source], variant, WARNINGS), *self.objects(variant)]
        libraries: dict[str, None] = {}  # in order, each once
        for each in (variant, *others):
            solver = find_solver(each.backend)
            if (
                each is not variant
            ):  # objects of a solver that is there already are left out, as from an archive
                shared = {f"{unit.stem}.o" for unit in solver.units if each.backend == variant.backend}
                objects += [made for made in self.objects(each) if made.name not in shared]
            if solver.library:
                libraries |= {str(solver.library): None, f"-Wl,-rpath,{solver.library.parent}": None}
        target = self.folder / f"{source.stem}-{variant.name}"
        command = [*find_toolchain(cxx=True).linker, *variant.options, *options, *map(str, objects)]
        run([*command, *libraries, "-lm", "-o", str(target)], f"cannot link {target.name}")
        return target

    def test(self, name: str, variant: Variant, *options: str) -> str:
        """Compile and run `runtime/tests/<name>`; what it printed.

        Raises:
            BuildError: a check in it failed; with all that it printed.
        """
        return run([str(self.program(TESTS / name, variant, *options))], f"{name} with {variant.name} failed")


def render_header(name: str, robot: str, additions: tuple[str, ...] = ()) -> str:
    """A public header for the hand-written arm, from the template of the generated ones."""
    values = {
        "robot": robot,
        "X": robot.upper(),
        "version": "0",
        "config_hash": "0" * 64,
        "banner": "/* test */",
        "additions": additions,
        "additions_mask": sum(1 << ADDITIONS.index(addition) for addition in additions),
    }
    return environment("emit").get_template(f"{name}.j2").render(values)
