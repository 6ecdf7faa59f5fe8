"""Compiles source files into objects, side by side, and only those whose inputs changed.

An object is named after the digest of everything that it is made from: its source, all headers that it could
include, compiler and flags. So a file that is there is right, whoever made it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from proxgen.builder.sources import digest, digest_files
from proxgen.builder.toolchain import Toolchain, command_identity, run_all

_KEEP = 100
"""Objects that are kept: those of about four builds."""


@dataclass(frozen=True)
class Unit:
    """A source file to compile.

    Attributes:
        source: C or C++.
        include: folders of headers, in order.
        headers: all headers that it could include, but those of the system.
        options: further options.
    """

    source: Path
    include: tuple[Path, ...]
    headers: tuple[Path, ...]
    options: tuple[str, ...] = ()


def compile_units(units: Sequence[Unit], cache: Path, work: Path, toolchain: Toolchain) -> list[Path]:
    """Compile what is not in the cache yet.

    Args:
        units: what to compile.
        cache: folder of the objects; the oldest ones are removed.
        work: a folder for what is not finished; on the same file system.
        toolchain: the compilers.

    Returns:
        Objects in the order of the units.

    Raises:
        BuildError: the compiler refuses a file; with the command and all that it said.
    """
    cache.mkdir(parents=True, exist_ok=True)
    objects = [cache / f"{unit.source.stem}-{_key(unit, toolchain)}.o" for unit in units]
    missing = [(unit, target) for unit, target in zip(units, objects, strict=True) if not target.is_file()]
    # The slowest come first, so that none of them starts last: the longest text is taken for the slowest.
    missing.sort(key=lambda pair: pair[0].source.stat().st_size, reverse=True)
    run_all(_job(unit, work / target.name, toolchain) for unit, target in missing)
    for _, target in missing:
        (work / target.name).replace(target)
    _tidy(cache, objects)
    return objects


def _key(unit: Unit, toolchain: Toolchain) -> str:
    """Digest of everything that an object is made from."""
    compiler = command_identity(toolchain.compile_command(unit.source))
    content = digest_files((unit.source, *unit.headers))
    return digest([compiler, content, unit.options])[:24]


def _job(unit: Unit, target: Path, toolchain: Toolchain) -> tuple[list[str], str]:
    """The command that compiles a unit, and what to say if it fails."""
    include = [f"-I{folder}" for folder in unit.include]
    command = [*toolchain.compile_command(unit.source), *unit.options, *include]
    command.append(f"-fmacro-prefix-map={unit.source.parent}=.")  # else __FILE__ would hold a temporary path
    return [*command, "-c", str(unit.source), "-o", str(target)], f"{unit.source.name} could not be compiled"


def _tidy(cache: Path, used: Sequence[Path]) -> None:
    """Keep what is used, and the latest of the rest: switching back and forth compiles nothing."""
    for path in used:
        path.touch()
    oldest_first = sorted(cache.iterdir(), key=lambda path: path.stat().st_mtime_ns)
    for path in oldest_first[: -max(_KEEP, len(used))]:
        path.unlink()
