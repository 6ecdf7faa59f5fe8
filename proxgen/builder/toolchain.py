"""The system's compilers: found, and run in parallel; what they say is kept whole."""

import os
import shlex
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from proxgen.errors import BuildError

# Chosen by measurement: docs/performance.md, "Build flags". -fno-math-errno spares sqrt the call that sets an
# error number; it changes no number. Contracting a*b+c into one operation would: results would depend on the
# processor.
COMMON_FLAGS = ("-O3", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off", "-fno-math-errno")
C_FLAGS = ("-std=c11", *COMMON_FLAGS)
CXX_FLAGS = ("-std=c++17", *COMMON_FLAGS)

_LANGUAGES = {
    "CC": ("C", ("cc", "gcc", "clang"), "apt-get install gcc"),
    "CXX": ("C++", ("c++", "g++", "clang++"), "apt-get install g++"),
}


@dataclass(frozen=True)
class Toolchain:
    """The commands that compile and link.

    Attributes:
        cc: C compiler, as words of a command line.
        cxx: C++ compiler, or () if none is needed.
        cflags: from the environment variable CFLAGS, after ours.
        cxxflags: from CXXFLAGS.
        ldflags: from LDFLAGS.
    """

    cc: tuple[str, ...]
    cxx: tuple[str, ...]
    cflags: tuple[str, ...]
    cxxflags: tuple[str, ...]
    ldflags: tuple[str, ...]

    def compile_command(self, source: Path) -> tuple[str, ...]:
        """The command that compiles a file of this kind, without include paths, input and output."""
        if source.suffix == ".c":
            return (*self.cc, *C_FLAGS, *self.cflags)
        return (*self.cxx, *CXX_FLAGS, *self.cxxflags)

    @property
    def linker(self) -> tuple[str, ...]:
        """The command that links: the C++ compiler if there is C++ in it."""
        return self.cxx or self.cc

    def identity(self) -> list[str]:
        """What makes another compiler, or other flags, of this: for the fingerprint of a build."""
        sources = ["a.c", "a.cpp"] if self.cxx else ["a.c"]
        return [*(command_identity(self.compile_command(Path(name))) for name in sources), *self.ldflags]


def find_toolchain(*, cxx: bool) -> Toolchain:
    """The compilers that CC and CXX name, or else those of the system.

    Args:
        cxx: whether a C++ compiler is needed.

    Raises:
        BuildError: a compiler is missing; says what to install.
    """
    flags = {name: tuple(shlex.split(os.environ.get(name, ""))) for name in ("CFLAGS", "CXXFLAGS", "LDFLAGS")}
    return Toolchain(
        cc=_find("CC"),
        cxx=_find("CXX") if cxx else (),
        cflags=flags["CFLAGS"],
        cxxflags=flags["CXXFLAGS"],
        ldflags=flags["LDFLAGS"],
    )


def run(command: Sequence[str], failure: str) -> str:
    """Run a tool to its end and return its standard output.

    Raises:
        BuildError: it cannot be started, or fails; with everything that it said.
    """
    try:
        result = subprocess.run(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
    except OSError as error:
        raise BuildError(f"{failure}: {error.strerror or error}", command) from error
    if result.returncode != 0:
        raise BuildError(failure, command, result.stdout)
    return result.stdout


def run_all(jobs: Iterable[tuple[Sequence[str], str]]) -> None:
    """Run tools side by side, one per processor; when all have ended, raise the first failure in order."""
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        futures = [pool.submit(run, command, failure) for command, failure in jobs]
    for future in futures:
        future.result()


def _find(variable: str) -> tuple[str, ...]:
    """The words of one compiler's command."""
    language, candidates, install = _LANGUAGES[variable]
    named = shlex.split(os.environ.get(variable, ""))
    if named:
        if shutil.which(named[0]) is None:
            raise BuildError(f"the {language} compiler '{named[0]}', which {variable} names, is not there")
        return tuple(named)
    for candidate in candidates:
        if shutil.which(candidate):
            return (candidate,)
    raise BuildError(
        f"no {language} compiler found (looked for {', '.join(candidates)}): install one, "
        f"for instance with `{install}`, or name it in the environment variable {variable}"
    )


def command_identity(words: Sequence[str]) -> str:
    """A command, and the size and time of the file behind it: an update of the compiler changes it."""
    executable = Path(shutil.which(words[0]) or words[0]).resolve()
    stat = executable.stat()
    return f"{words} {executable} {stat.st_size} {stat.st_mtime_ns}"
