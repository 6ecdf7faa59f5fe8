"""The folder that a build leaves: libraries, headers, CMake and pkg-config files, the Python extension.

It can be moved and installed as it is: everything in it finds everything else relative to itself.

    include/<robot>/   controller.h, controller.hpp, model.h; include/proxgen/types.h
    lib/               lib<robot>.so, lib<robot>.a, qpOASES if it is the back end, cmake/, pkgconfig/
    python/            the extension
    share/             manifest.json and licences
    proxgen.json       what was built, for `CompiledController.load`
"""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from struct import calcsize
from typing import Any

from proxgen import __version__
from proxgen.builder.solvers import Solver
from proxgen.builder.toolchain import Toolchain, run

DESCRIPTION = "proxgen.json"
"""File in the root of the folder that says what is in it."""

_PUBLIC_HEADERS = ("controller.h", "controller.hpp", "model.h")


def link(
    tree: Path,
    robot: str,
    objects: Sequence[Path],
    glue: Path,
    module: str,
    toolchain: Toolchain,
    solver: Solver,
) -> None:
    """Link everything: shared library, static library, Python extension.

    The static library is one object in which every name that is not public is local, so that those of two
    robots, and their solvers, never meet. Beside it is the object that takes a controller's memory from the
    heap: the linker leaves it out of a program that does not ask for it.

    Raises:
        BuildError: a tool fails.
    """
    library, python = tree / "lib", tree / "python"
    library.mkdir(parents=True)
    python.mkdir()
    carried = []
    if solver.library:
        shutil.copyfile(solver.library, library / solver.library.name)
        carried = [str(library / solver.library.name), f"-Wl,-rpath-link,{library}"]
    names = [str(path) for path in objects]
    shared = [
        "-shared",
        *toolchain.ldflags,
        "-Wl,-z,defs",
        f"-Wl,-soname,lib{robot}.so",
        "-Wl,-rpath,$ORIGIN",
    ]
    command = [*toolchain.linker, *shared, *names, *carried, "-lm", "-o", str(library / f"lib{robot}.so")]
    run(command, f"lib{robot}.so could not be linked")
    static = library / f"lib{robot}.a"
    _archive(static, objects, toolchain)
    # From the static library, so that two back ends of one robot can be loaded into one process.
    extension = ["-shared", *toolchain.ldflags, "-Wl,--exclude-libs,ALL", "-Wl,-rpath,$ORIGIN/../lib"]
    target = str(python / f"{module}.so")
    command = [*toolchain.linker, *extension, str(glue), str(static), *carried, "-lm", "-o", target]
    run(command, "the Python extension could not be linked")


def _archive(static: Path, objects: Sequence[Path], toolchain: Toolchain) -> None:
    """Merge objects into one with only public names, and put it into an archive, beside that of the heap."""
    merged, heap = static.with_suffix(".o"), static.with_name("heap.o")
    (of_heap,) = [path for path in objects if path.stem.split("-")[0] == "heap"]
    shutil.copyfile(of_heap, heap)
    others = [str(path) for path in objects if path != of_heap]
    groups = ["-Wl,--force-group-allocation"] if toolchain.cxx else []
    run(
        [*toolchain.linker, "-r", "-nostdlib", *groups, *others, "-o", str(merged)],
        "objects could not be merged",
    )
    run(["objcopy", "--localize-hidden", str(merged)], "hidden names could not be made local")
    run(["ar", "rcsD", str(static), str(merged), str(heap)], f"{static.name} could not be archived")
    merged.unlink()
    heap.unlink()


def add_files(
    tree: Path,
    robot: str,
    generated: Path,
    types: Path,
    licence: Path,
    solver: Solver,
    extra: dict[str, Any],
) -> None:
    """Add headers, package files, manifest, licences and description.

    Args:
        tree: the folder, with its libraries.
        robot: name.
        generated: folder of the generated code.
        types: the runtime's `types.h`.
        licence: the runtime's.
        solver: whose licence and library are named.
        extra: further entries of the description.
    """
    include, share = tree / "include", tree / "share" / f"proxgen_{robot}"
    for folder in (include / robot, include / "proxgen", share):
        folder.mkdir(parents=True)
    for name in _PUBLIC_HEADERS:
        shutil.copyfile(generated / name, include / robot / name)
    shutil.copyfile(types, include / "proxgen" / types.name)
    shutil.copyfile(generated / "manifest.json", share / "manifest.json")
    shutil.copyfile(licence, share / "LICENSE.proxgen")
    if solver.licence:
        shutil.copyfile(solver.licence, share / f"LICENSE.{solver.name}")
    _package_files(tree / "lib", robot, solver)
    description = {
        "robot": robot,
        "backend": solver.name,
        "solver_version": solver.version,
        "proxgen": __version__,
        "manifest": f"share/proxgen_{robot}/manifest.json",
        **extra,
    }
    (tree / DESCRIPTION).write_text(json.dumps(description, indent=2) + "\n")


def _package_files(library: Path, robot: str, solver: Solver) -> None:
    """Render what `find_package` and pkg-config read."""
    from proxgen.templates import environment

    templates = environment("builder")
    context = {
        "robot": robot,
        "version": __version__,
        "backend": solver.name,
        "library": solver.library.name if solver.library else "",
        "pointer_size": calcsize("P"),
        "mark": f"Made by proxgen {__version__}.",
    }
    cmake = library / "cmake" / f"proxgen_{robot}"
    targets = {
        "config.cmake.j2": cmake / f"proxgen_{robot}Config.cmake",
        "version.cmake.j2": cmake / f"proxgen_{robot}ConfigVersion.cmake",
        "pkgconfig.pc.j2": library / "pkgconfig" / f"proxgen_{robot}.pc",
    }
    for template, path in targets.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(templates.get_template(template).render(context))
