"""The QP solvers as a build needs them: sources to compile, headers, libraries to carry along."""

import os
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from proxgen.errors import BuildError, unknown_name

DAQP_VERSION = "0.11.0"
DAQP_SHA256 = "2f27baf18d2acca14186498e651b34e0bed455627e777d3fd8ba655e7e40f920"
"""Of the source distribution `daqp-<version>.tar.gz`."""

_DAQP_UNITS = ("daqp.c", "auxiliary.c", "factorization.c")
"""The active-set method itself; its interfaces, which use the heap, are not needed."""


@dataclass(frozen=True)
class Solver:
    """A QP solver that a controller is built with.

    Attributes:
        name: of the back end.
        version: of the solver's package.
        units: its own source files, to be compiled with the controller.
        include: folder of its headers.
        headers: those headers, for fingerprints.
        library: shared library to link with and to carry along, or None.
        licence: its licence text, or None if the package holds none.
    """

    name: str
    version: str
    units: tuple[Path, ...]
    include: Path
    headers: tuple[Path, ...]
    library: Path | None
    licence: Path | None

    @property
    def cxx(self) -> bool:
        """Whether it needs a C++ compiler."""
        return self.library is not None

    def options(self, source: Path) -> tuple[str, ...]:
        """Further options of the compiler for a source file: the solver is compiled in its own way.

        Its loops go along half rows of small matrices; made for vectors of two, they take a third longer.
        """
        of_solver = source in self.units or source.stem == f"solver_{self.name}"
        return ("-fno-tree-vectorize",) if of_solver else ()


def find_solver(backend: str) -> Solver:
    """The solver behind a back end.

    Args:
        backend: `qpoases` or `daqp`.

    Raises:
        BuildError: unknown, or not installed; says how to install it.
    """
    if backend not in _FINDERS:
        raise BuildError(unknown_name("back end", backend, _FINDERS))
    return _FINDERS[backend]()


def daqp_directory() -> Path:
    """Where DAQP's sources are: PROXGEN_DAQP_SOURCE, or where `fetch_daqp` puts them."""
    named = os.environ.get("PROXGEN_DAQP_SOURCE")
    return Path(named) if named else Path(sys.prefix) / "share" / "proxgen" / f"daqp-{DAQP_VERSION}"


def _find_daqp() -> Solver:
    """DAQP: plain C, compiled with the controller."""
    directory = daqp_directory()
    sources, include = directory / "csrc" / "src", directory / "csrc" / "include"
    units = tuple(sources / name for name in _DAQP_UNITS)
    missing = [path for path in (*units, include / "daqp.h") if not path.is_file()]
    if missing:
        raise BuildError(
            f"the sources of DAQP {DAQP_VERSION} are missing ({missing[0]}): "
            "run `python -m proxgen.builder.fetch_daqp`, or choose the back end qpoases"
        )
    licence = directory / "LICENSE"
    return Solver(
        name="daqp",
        version=DAQP_VERSION,
        units=units,
        include=include,
        headers=tuple(sorted(include.glob("*.h"))),
        library=None,
        licence=licence if licence.is_file() else None,
    )


def _find_qpoases() -> Solver:
    """The qpOASES library of the package cmeel-qpoases (LGPL-2.1, so it is linked dynamically)."""
    try:
        files = metadata.files("cmeel-qpoases") or []
        version = metadata.version("cmeel-qpoases")
    except metadata.PackageNotFoundError:
        files, version = [], ""
    headers = tuple(Path(file.locate()) for file in files if file.suffix in (".hpp", ".ipp"))
    library = [Path(file.locate()) for file in files if re.fullmatch(r"libqpOASES\.so\.[\d.]+", file.name)]
    main_header = [header for header in headers if header.name == "qpOASES.hpp"]
    if not (library and main_header):
        raise BuildError("qpOASES is missing: run `pip install cmeel-qpoases`, or choose the back end daqp")
    return Solver(
        name="qpoases",
        version=version,
        units=(),
        include=main_header[0].parent,
        headers=headers,
        library=library[0],
        licence=_licence_in_casadi(),
    )


def _licence_in_casadi() -> Path | None:
    """The licence of qpOASES, which its own package leaves out; that of CasADi has it for its copy."""
    casadi = find_spec("casadi")
    if casadi is None or casadi.origin is None:
        return None
    text = Path(casadi.origin).parent / "include" / "licenses" / "qpOASES" / "LICENSE.txt"
    return text if text.is_file() else None


_FINDERS: dict[str, Callable[[], Solver]] = {"qpoases": _find_qpoases, "daqp": _find_daqp}
