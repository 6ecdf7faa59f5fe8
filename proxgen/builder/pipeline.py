"""From a configuration to a folder with libraries: generate, compile, link, move into place.

Everything is made in a temporary folder beside the result and moved into place when all of it is done, so
that a failure leaves the last good build as it was. What has not changed is not done again.
"""

import tempfile
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path

from proxgen.builder import sources, stamp, tree
from proxgen.builder.extension import HEADER, PYTHON_FUNCTIONS, declarations, write_extension
from proxgen.builder.objects import Unit, compile_units
from proxgen.builder.solvers import Solver, find_solver
from proxgen.builder.stamp import PRIVATE, Stamp
from proxgen.builder.toolchain import Toolchain, find_toolchain
from proxgen.config.hashing import config_hash
from proxgen.config.schema import Config
from proxgen.errors import BuildError


@dataclass(frozen=True)
class BuildResult:
    """Where a controller was built.

    Attributes:
        library_dir: the folder, for `CompiledController.load`, `find_package` and pkg-config.
        rebuilt: False if it was up to date.
        robot: name.
        backend: QP solver.
        generated: folder of the generated code.
    """

    library_dir: Path
    rebuilt: bool
    robot: str
    backend: str
    generated: Path


@dataclass(frozen=True)
class _Plan:
    """All that determines a build."""

    config: Config
    directory: Path
    generated: Path
    solver: Solver
    toolchain: Toolchain
    generation: str  # digest of what determines the generated code
    key: str  # digest of everything

    @property
    def robot(self) -> str:
        """Name of the robot."""
        return self.config.robot.name

    @property
    def generated_name(self) -> str:
        """Folder of the generated code; relative within the build folder, which may then be moved."""
        inside = self.generated.is_relative_to(self.directory)
        return str(self.generated.relative_to(self.directory) if inside else self.generated)


def default_directory(config: Config) -> Path:
    """`build/<robot>` in the current folder, relative to it."""
    return Path("build") / config.robot.name


def other_owner(config: Config) -> Path | None:
    """The other YAML file of the same `robot.name` whose controller the default folder holds, if one does.

    A file that is not there any more, as it was renamed, owns nothing.
    """
    last = stamp.read_stamp(default_directory(config))
    if last is None or not last.source or Path(last.source) == config.source.resolve():
        return None
    return Path(last.source) if Path(last.source).is_file() else None


def _own_directory(config: Config) -> Path:
    """The default folder, or one beside it with the file's name if that is another file's."""
    folder = default_directory(config)
    return folder if other_owner(config) is None else folder.with_name(f"{folder.name}.{config.source.stem}")


def build(
    config: Config,
    directory: str | Path | None = None,
    backend: str | None = None,
    generated: str | Path | None = None,
) -> BuildResult:
    """Generate and compile the controller of a configuration, unless it is up to date.

    Args:
        config: of the robot.
        directory: where to; if None, `build/<robot>` in the current folder, or `build/<robot>.<file>` if that
            holds the controller of another file with the same `robot.name`.
        backend: `qpoases` or `daqp`; that of the configuration if None.
        generated: folder of the generated code; `generated` within `directory` if None.

    Returns:
        Where it is, and whether anything had to be done.

    Raises:
        BuildError: compiler, solver or sources missing, or the compiler refuses the code.
        GenerateError: code cannot be generated.
        ConfigError: the robot description does not fit the configuration.
    """
    plan = _plan(config, directory, backend, generated)
    rebuilt = False
    if not _up_to_date(plan):
        with stamp.locked(plan.directory):
            if not _up_to_date(plan):  # else another process has just built it
                _rebuild(plan)
                rebuilt = True
    return BuildResult(plan.directory, rebuilt, plan.robot, plan.solver.name, plan.generated)


def _plan(
    config: Config, directory: str | Path | None, backend: str | None, generated: str | Path | None
) -> _Plan:
    """Find everything that a build needs, and its fingerprint."""
    folder = Path(directory or _own_directory(config)).absolute()
    solver = find_solver(backend or config.solver.backend)
    toolchain = find_toolchain(cxx=solver.cxx)
    versions = [metadata.version(name) for name in ("casadi", "pin")]
    named = [config_hash(config), config.source.name]  # the text says from which file it can be made again
    generation = sources.digest([named, sources.digest_files(sources.generator_files()), versions])
    runtime = [*sources.runtime_units(solver.name), *sources.runtime_headers()]
    parts = [
        generation,
        sources.digest_files([*runtime, *solver.units, *solver.headers]),
        toolchain.identity(),
        [solver.name, solver.version, metadata.version("cffi"), _python_include()],
    ]
    key = sources.digest(parts)
    code = Path(generated).absolute() if generated else folder / "generated"
    return _Plan(config, folder, code, solver, toolchain, generation, key)


def _up_to_date(plan: _Plan) -> bool:
    """Whether the folder holds exactly what the plan would make."""
    last = stamp.read_stamp(plan.directory)
    return (
        last is not None
        and (last.key, last.generated) == (plan.key, plan.generated_name)
        and last.holds(plan.directory)
    )


def _rebuild(plan: _Plan) -> None:
    """Generate, compile, link in a temporary folder; then move what changed into place."""
    last = stamp.read_stamp(plan.directory)
    private = plan.directory / PRIVATE
    with tempfile.TemporaryDirectory(dir=private, prefix="work-") as folder:
        work = Path(folder)
        _generate(plan, last)
        module = f"_{plan.robot}_{plan.key[:12]}"
        objects = compile_units(_units(plan, module, work), private / "objects", work, plan.toolchain)
        result = work / "tree"
        tree.link(result, plan.robot, objects[1:], objects[0], module, plan.toolchain, plan.solver)
        types = sources.runtime_directory() / "include" / "proxgen" / "types.h"
        extra = {
            "extension": f"python/{module}.so",
            "module": module,
            "config_hash": config_hash(plan.config),
        }
        licence = sources.runtime_licence()
        tree.add_files(result, plan.robot, plan.generated, types, licence, plan.solver, extra)
        stamp.remove_stamp(plan.directory)
        files = _move_into_place(result, plan.directory, last)
        code = stamp.digest_folder(plan.generated)
        source = str(plan.config.source.resolve())
        made = Stamp(plan.key, plan.generation, plan.generated_name, code, files, source)
        stamp.write_stamp(plan.directory, made, work)


def _generate(plan: _Plan, last: Stamp | None) -> None:
    """Generate the code, unless that of the last build still stands."""
    if (
        last is not None
        and (last.generation, last.generated) == (plan.generation, plan.generated_name)
        and last.generated_holds(plan.directory)
    ):
        return
    from proxgen.builder.api import generate

    generate(plan.config, plan.generated)


def _units(plan: _Plan, module: str, work: Path) -> list[Unit]:
    """Everything to compile; the glue of the Python extension comes first."""
    runtime = sources.runtime_directory()
    include = (plan.generated, runtime / "include", runtime / "src")
    headers = (*sorted(plan.generated.glob("*.h")), *sources.runtime_headers())
    solver = plan.solver
    functions = [f"{plan.robot}_{name}" for name in PYTHON_FUNCTIONS]
    header = runtime / "src" / HEADER
    cdef = declarations(header, include, plan.toolchain.cc, functions, _new_folder(work / "system"))
    glue = work / f"{module}.c"
    write_extension(module, cdef, glue)
    units = [Unit(glue, (*include, Path(_python_include())), headers, ("-O1",))]
    units += [Unit(plan.generated / name, include, headers) for name in ("kernels.c", "model.c")]
    for source in sources.runtime_units(solver.name):
        unit = Unit(source, include, headers, solver.options(source))
        if source.stem == f"solver_{solver.name}":
            unit = replace(unit, include=(*include, solver.include), headers=(*headers, *solver.headers))
        units.append(unit)
    foreign = (Unit(path, (solver.include,), solver.headers, solver.options(path)) for path in solver.units)
    return [*units, *foreign]


def _move_into_place(made: Path, directory: Path, last: Stamp | None) -> dict[str, int]:
    """Move the files that changed, remove those of the last build that are gone; sizes by path."""
    files = {str(path.relative_to(made)): path for path in sorted(made.rglob("*")) if path.is_file()}
    sizes = {name: path.stat().st_size for name, path in files.items()}
    try:
        for name, path in files.items():
            target = directory / name
            if not (target.is_file() and target.read_bytes() == path.read_bytes()):
                target.parent.mkdir(parents=True, exist_ok=True)
                path.replace(target)
        for name in set(last.files if last else ()) - set(files):
            (directory / name).unlink(missing_ok=True)
    except OSError as error:
        raise BuildError(f"cannot write {directory}: {error.strerror or error}") from error
    return sizes


def _new_folder(path: Path) -> Path:
    """A folder that was not there."""
    path.mkdir()
    return path


def _python_include() -> str:
    """Folder of Python.h."""
    import sysconfig

    return sysconfig.get_path("include")
