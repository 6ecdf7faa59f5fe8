"""The hand-written C of the runtime, and the fingerprints of everything that a build depends on."""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path

import proxgen
from proxgen.errors import BuildError

_PACKAGE = Path(proxgen.__file__).parent
_ROOMS = ("config", "model", "symbolic", "emit", "builder")


def runtime_directory() -> Path:
    """The folder `runtime/`: of the checkout, or as it is installed with the package.

    Raises:
        BuildError: it is in neither place.
    """
    places = (_PACKAGE.parent / "runtime", _PACKAGE / "_runtime")
    for place in places:
        if (place / "include" / "proxgen" / "types.h").is_file():
            return place
    raise BuildError(f"proxgen's runtime sources are missing (looked in {places[0]} and {places[1]})")


def runtime_licence() -> Path:
    """The licence of the runtime, which who passes a library on has to pass on with it.

    Raises:
        BuildError: it is neither in the checkout nor in the installed package.
    """
    runtime = runtime_directory()
    for place in (runtime.parent / "LICENSE", runtime / "LICENSE"):
        if place.is_file():
            return place
    raise BuildError(f"proxgen's LICENSE is missing (looked in {runtime.parent} and {runtime})")


def runtime_units(backend: str) -> tuple[Path, ...]:
    """The runtime's source files, with the one back end that is asked for."""
    sources = sorted((runtime_directory() / "src").glob("*.c*"))
    return tuple(
        path for path in sources if not path.stem.startswith("solver_") or path.stem == f"solver_{backend}"
    )


def runtime_headers() -> tuple[Path, ...]:
    """Everything that the runtime's sources include."""
    directory = runtime_directory()
    return (*sorted((directory / "src").glob("*.h")), *sorted((directory / "include").rglob("*.h")))


def generator_files() -> tuple[Path, ...]:
    """The files of proxgen that decide what is generated and how it is built."""
    rooms = (
        path for room in _ROOMS for path in (_PACKAGE / room).rglob("*") if path.suffix in (".py", ".j2")
    )
    return (*(_PACKAGE / name for name in ("__init__.py", "program.py", "templates.py")), *sorted(rooms))


def digest_files(paths: Iterable[Path]) -> str:
    """SHA-256 of the names and contents of files, hexadecimal."""
    digest = hashlib.sha256()
    for path in paths:
        content = path.read_bytes()
        digest.update(f"{path.name}\0{len(content)}\0".encode())
        digest.update(content)
    return digest.hexdigest()


def digest(value: object) -> str:
    """SHA-256 of plain data, hexadecimal."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()
