"""The generated kinematics and Pinocchio's, in one C++ program that times them in turns."""

from pathlib import Path
from typing import Any

import numpy as np

from proxgen.bench.peers.environment import site_packages
from proxgen.builder.sources import runtime_directory
from proxgen.builder.toolchain import find_toolchain, run
from proxgen.controllers.protocol import Array
from proxgen.errors import BuildError

PASSES = 300
LISTS = ("-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_MPL_LIMIT_LIST_SIZE=30")
"""As Pinocchio's own CMake target says: its list of joint types is longer than Boost's usual ones."""

FLAGS = ("-std=c++17", "-O3", "-DNDEBUG", *LISTS, "-w")
"""Those of Pinocchio's release; -w: warnings in its headers are not ours to answer."""


def time_kinematics(
    arm: dict[str, Any], q: Array, generated: Path, python: Path, directory: Path
) -> tuple[Array, Array, float]:
    """Compile and run `runtime/bench/pinocchio_kinematics.cpp`.

    Args:
        arm: from `describe_arm`.
        q: (T, n) states [rad].
        generated: folder of the arm's generated code.
        python: of the environment that holds Pinocchio's and Eigen's headers.
        directory: for its files.

    Returns:
        (passes,) times per state of the generated code and of Pinocchio, pass by pass [s], and the greatest
        difference between their Jacobians.

    Raises:
        BuildError: it does not compile, or fails.
    """
    toolchain, runtime = find_toolchain(cxx=True), runtime_directory()
    prefix = site_packages(python) / "cmeel.prefix"
    includes = [f"-I{path}" for path in (generated, runtime / "include")]
    foreign = [f"-isystem{path}" for path in (prefix / "include", prefix / "include" / "eigen3")]
    objects = []
    for source in sorted(generated.glob("*.c")):
        objects.append(str(directory / f"{source.stem}.o"))
        command = [*toolchain.compile_command(source), *includes, "-c", str(source), "-o", objects[-1]]
        run(command, f"cannot compile {source.name}")
    program, source = directory / "pinocchio_kinematics", runtime / "bench" / "pinocchio_kinematics.cpp"
    library = prefix / "lib"
    linked = [f"-L{library}", "-lpinocchio_default", f"-Wl,-rpath,{library}", f"-Wl,-rpath-link,{library}"]
    command = [*toolchain.cxx, *FLAGS, *includes, *foreign, str(source), *objects, *linked, "-lm"]
    run([*command, "-o", str(program)], "cannot compile the comparison with Pinocchio")
    given, target = directory / "states.bin", directory / "kinematics.bin"
    given.write_bytes(_input(arm, q).tobytes())
    run([str(program), str(given), str(target), str(PASSES)], "the comparison with Pinocchio failed")
    values = np.fromfile(target)
    if len(values) != 1 + 2 * PASSES:
        raise BuildError(f"the comparison with Pinocchio wrote {len(values)} numbers")
    return values[1 : 1 + PASSES], values[1 + PASSES :], float(values[0])


def _input(arm: dict[str, Any], q: Array) -> Array:
    """The numbers that the program reads, in its order."""
    parts: list[Array] = [np.array([len(q)], dtype=float)]
    for joint in arm["joints"]:
        parts.append(np.array(joint["placement"])[:3].ravel())
        parts.append(np.array([*joint["axis"], joint["prismatic"]], dtype=float))
    parts.append(np.array([arm["tool"]["body"]], dtype=float))
    parts += [np.array(arm["tool"]["placement"])[:3].ravel(), q.ravel()]
    return np.concatenate(parts)
