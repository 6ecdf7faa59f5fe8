"""A program of its own around a controller's sources: benchmarks, tests, fuzzing."""

from collections.abc import Sequence
from pathlib import Path

from proxgen.builder.solvers import find_solver
from proxgen.builder.sources import runtime_directory, runtime_units
from proxgen.builder.toolchain import find_toolchain, run, run_all


def compile_program(
    main: Path, generated: Path, backend: str, target: Path, options: Sequence[str] = ()
) -> Path:
    """Compile a C program with a robot's code, the runtime and a solver, with the flags of the product.

    Unlike a program that is linked with the library, it may use what is inside the runtime.

    Args:
        main: source of the program.
        generated: folder of the robot's code.
        backend: `qpoases` or `daqp`.
        target: the executable; objects go into a folder beside it.
        options: further options of compiler and linker.

    Returns:
        `target`.

    Raises:
        BuildError: the compiler refuses, or something is missing.
    """
    solver, runtime = find_solver(backend), runtime_directory()
    toolchain = find_toolchain(cxx=solver.cxx)
    folder = target.with_name(f"{target.name}-objects")
    folder.mkdir(parents=True, exist_ok=True)
    includes = [generated, runtime / "src", runtime / "include", solver.include]
    flags = [*options, *(f"-I{path}" for path in includes)]
    sources = [main, *runtime_units(backend), *solver.units, *sorted(generated.glob("*.c"))]
    objects = [folder / f"{index}_{source.stem}.o" for index, source in enumerate(sources)]
    run_all(
        (
            [
                *toolchain.compile_command(source),
                *solver.options(source),
                *flags,
                "-c",
                str(source),
                "-o",
                str(made),
            ],
            f"cannot compile {source.name}",
        )
        for source, made in zip(sources, objects, strict=True)
    )
    libraries = [str(solver.library), f"-Wl,-rpath,{solver.library.parent}"] if solver.library else []
    names = [str(path) for path in objects]
    run(
        [*toolchain.linker, *options, *toolchain.ldflags, *names, *libraries, "-lm", "-o", str(target)],
        f"cannot link {target.name}",
    )
    return target
