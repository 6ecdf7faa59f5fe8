"""Replays recorded runs on emulated processors (`make embed`): the same commands, and what they cost there.

The iiwa 7 is driven through the gap once, in the simulation, by the paper's method and once more with all
additions. What went into its controller is then replayed through the same sources, compiled with DAQP for
this machine, for aarch64 and for a Cortex-M7. Nothing is installed; what is missing is named, by its Debian
package.
"""

import re
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import proxgen
from proxgen.bench.inputs import Inputs, crowded, record
from proxgen.builder import build
from proxgen.builder.solvers import daqp_directory
from proxgen.builder.toolchain import run
from proxgen.config.scene import load_scene
from proxgen.controllers.compiled import CompiledController
from proxgen.errors import ProxgenError
from proxgen.model import build_model

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
OUT = ROOT / "build" / "embed"

ROBOTS = ("iiwa7", "iiwa7_improved")
PROGRAMS = (
    "replay",
    "replay-same",
)  # with the sine of the C library, and with one that is the same everywhere
TOLERANCE = (
    1e-11  # [rad/s] between commands on two processors, whose C libraries' sines differ in the last bit
)
MEAN_INSTRUCTIONS = 30_000  # per cycle on the Cortex-M7, in the recorded runs
MAX_INSTRUCTIONS = 60_000
COUNTER_OVERHEAD = range(1000, 1021)  # what a thousand instructions may be counted as

EMULATORS = {  # what a program is run by
    "native": "",
    "aarch64": "qemu-aarch64",
    "cortex-m7": "qemu-system-arm -M mps2-an500 -icount shift=6 -nographic -monitor none -serial none "
    "-semihosting-config enable=on,target=native -kernel",
}
PACKAGES = [  # command, library that it has to know or None, Debian package
    ("aarch64-linux-gnu-gcc", None, "gcc-aarch64-linux-gnu"),
    ("aarch64-linux-gnu-gcc", "libm.a", "libc6-dev-arm64-cross"),
    ("qemu-aarch64", None, "qemu-user"),
    ("arm-none-eabi-gcc", None, "gcc-arm-none-eabi"),
    ("arm-none-eabi-gcc", "libm.a", "libnewlib-arm-none-eabi"),
    ("qemu-system-arm", None, "qemu-system-arm"),
    ("make", None, "make"),
]
HEAP_OR_CXX = r"malloc|calloc|realloc|_sbrk|^free$|^_free_r$|^_Z|__cxa"
"""Names that must not be in the program for the Cortex-M7."""

PARTS = {  # part of a controller: its object files
    "generated code": r"(kernels|model)\.o",
    "DAQP": r"(daqp|auxiliary|factorization)\.o",
    "replay and board": r"(replay|startup|semihosting)\.o",
    "C library": r".*\.a\(.*\)",
    "runtime": r".*",
}


@dataclass(frozen=True)
class Output:
    """What a processor made of one recorded run.

    Attributes:
        status: (T,) of each cycle.
        instructions: (T,) of each call of step; 0 where they are not counted.
        qdot: (T, n) commands [rad/s].
        thousand: what the counter makes of a thousand instructions.
        stack: deepest stack [bytes]; 0 where it is not measured.
        same: (T, n) commands with a sine that is the same everywhere [rad/s].
    """

    status: NDArray[np.float64]
    instructions: NDArray[np.float64]
    qdot: NDArray[np.float64]
    thousand: float
    stack: float
    same: NDArray[np.float64]


def missing_packages() -> list[str]:
    """The Debian packages without which nothing can be compiled or emulated."""
    missing = []
    for command, library, package in PACKAGES:
        found = shutil.which(command) is not None
        if found and library:
            answer = run([command, f"-print-file-name={library}"], f"{command} failed").strip()
            found = Path(answer).is_absolute() and Path(answer).is_file()
        if not found:
            missing.append(package)
    return missing


def compile_replay(target: str, generated: Path, out: Path) -> Path:
    """Compile the replaying program for a processor; returns its folder."""
    folder = out / target
    settings = [f"TARGET={target}", f"GENERATED={generated}", f"DAQP={daqp_directory()}", f"OUT={folder}"]
    run(["make", "-s", "-f", str(HERE / "Makefile"), *settings], f"the replay does not compile for {target}")
    return folder


def outputs_of(target: str, folder: Path, program: str) -> NDArray[np.float64]:
    """What a program writes on a processor, or on its emulator, of the inputs in its folder."""
    command = [*EMULATORS[target].split(), str(folder / program)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{target}: {program} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return np.fromfile(folder / "outputs.bin")


def replay(target: str, folder: Path, inputs: Inputs) -> Output:
    """Replay a recorded run on a processor, or on its emulator."""
    inputs.save(folder / "inputs.bin")
    values, same = (outputs_of(target, folder, program) for program in PROGRAMS)
    cycles, others = (each[1:-1].reshape(inputs.cycles, 2 + inputs.q.shape[1]) for each in (values, same))
    return Output(cycles[:, 0], cycles[:, 1], cycles[:, 2:], values[0], values[-1], others[:, 2:])


def sizes(folder: Path) -> dict[str, int]:
    """Bytes of code and constants of each part in the linked program, by its map."""
    placed = (folder / "replay.map").read_text().split("Linker script and memory map")[1]
    code = re.findall(r"^ \.(?:text|rodata|vectors)\S*\s+0x\w+\s+0x(\w+) (\S+)$", placed, re.M)
    counted: Counter[str] = Counter()
    for size, path in code:
        part = next(name for name, pattern in PARTS.items() if re.fullmatch(pattern, Path(path).name))
        counted[part] += int(size, 16)
    return dict(counted)


def symbols(folder: Path) -> dict[str, int]:
    """Sizes of all that the program for the Cortex-M7 defines, by name."""
    listing = run(["arm-none-eabi-nm", "--print-size", str(folder / "replay")], "nm failed")
    return {name: int(size, 16) for size, name in re.findall(r"^\w+ (\w+) \w (\S+)$", listing, re.M)}


def problems(name: str, native: Output, others: dict[str, Output]) -> list[str]:
    """What is not as it should be, in words."""
    found = []
    for target, output in others.items():
        difference = np.abs(output.qdot - native.qdot).max()
        if not difference <= TOLERANCE:
            found.append(f"{name}, {target}: commands differ by {difference:.1e} rad/s")
        if not np.array_equal(output.same, native.same):
            found.append(f"{name}, {target}: commands differ with the same sine")
        if not np.array_equal(output.status, native.status):
            found.append(f"{name}, {target}: other statuses")
    cortex = others["cortex-m7"]
    if cortex.thousand not in COUNTER_OVERHEAD:
        found.append(f"a thousand instructions are counted as {cortex.thousand:.0f}")
    mean, most = cortex.instructions.mean(), cortex.instructions.max()
    if "crowded" not in name and not (mean <= MEAN_INSTRUCTIONS and most <= MAX_INSTRUCTIONS):
        found.append(f"{name}: {mean:.0f} instructions per cycle, at most {most:.0f}")
    return found


def describe(name: str, native: Output, others: dict[str, Output]) -> str:
    """The figures of one recorded run."""
    statuses = Counter(proxgen.Status(int(status)).name for status in native.status)
    lines = [
        f"{name}: {len(native.status)} cycles, " + ", ".join(f"{n} {s}" for s, n in statuses.most_common())
    ]
    for target, output in others.items():
        difference = np.abs(output.qdot - native.qdot).max()
        same = np.abs(output.same - native.same).max()
        lines.append(
            f"  {target}: commands differ from this machine's by at most {difference:.1e} rad/s, "
            f"with the same sine by {same:.1e}"
        )
    count = others["cortex-m7"].instructions
    p50, p99 = np.percentile(count, [50, 99])
    lines.append(
        f"  cortex-m7: instructions per cycle: mean {count.mean():,.0f}, median {p50:,.0f}, "
        f"p99 {p99:,.0f}, max {count.max():,.0f}; deepest stack {others['cortex-m7'].stack:,.0f} bytes"
    )
    return "\n".join(lines)


def check(robot: str) -> list[str]:
    """Record, compile, replay, compare, for one configuration; what is not as it should be, in words."""
    config = proxgen.load(ROOT / "examples" / "iiwa7" / f"{robot}.yaml")
    out = OUT / robot
    model, built = build_model(config), build(config, out / "controller", backend="daqp")
    controller = CompiledController.load(built.library_dir)
    gap = record(config, model, controller, load_scene("gap"), duration=60.0)
    folders = {target: compile_replay(target, built.generated, out) for target in EMULATORS}
    found = []
    for inputs in (gap, crowded(gap, model, config.skin.max_points)):
        name = f"{robot}, {inputs.name}"
        outputs = {target: replay(target, folder, inputs) for target, folder in folders.items()}
        native = outputs.pop("native")
        print(describe(name, native, outputs))
        found += problems(name, native, outputs)
    parts = ", ".join(f"{part} {size:,}" for part, size in sizes(folders["cortex-m7"]).items())
    defined = symbols(folders["cortex-m7"])
    print(f"{robot}: cortex-m7: code and constants [bytes]: {parts}")
    print(f"{robot}: cortex-m7: static data of a controller: {defined['memory']:,} bytes")
    return found + [f"{robot}: {name} is linked" for name in defined if re.search(HEAP_OR_CXX, name)]


def main() -> int:
    """Check all configurations; 1 if a processor does not do as this one does."""
    missing = missing_packages()
    if missing:
        print("make embed needs cross compilers and emulators that are not here:", file=sys.stderr)
        print(f"  apt-get install {' '.join(missing)}", file=sys.stderr)
        return 1
    found = [problem for robot in ROBOTS for problem in check(robot)]
    for problem in found:
        print(f"failed: {problem}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except ProxgenError as problem:
        sys.exit(f"proxgen: {problem}")
