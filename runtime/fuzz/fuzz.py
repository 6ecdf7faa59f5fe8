"""Fuzzes the step function for a while: `python runtime/fuzz/fuzz.py SECONDS` (part of `make sanitize`).

libFuzzer starts from the committed corpus and follows what new code its inputs reach, in controllers with
hard and with soft rows, with AddressSanitizer and UndefinedBehaviorSanitizer. Inputs that break a promise are
kept in build/fuzz, and end this program with 1. With `--check`, it only says what is missing.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import proxgen
from proxgen.builder.program import compile_program
from proxgen.builder.toolchain import run
from proxgen.errors import ProxgenError

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OUT = ROOT / "build" / "fuzz"
TARGETS = [  # robot, back end, share of the time; the inside of qpOASES is not seen
    ("planar2/planar2.yaml", "daqp", 0.5),
    ("planar2/planar2.yaml", "qpoases", 0.2),
    ("iiwa7/iiwa7_improved.yaml", "daqp", 0.2),
    ("iiwa7/iiwa7_improved.yaml", "qpoases", 0.1),
]
OPTIONS = ["-g", "-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all"]
LIMITS = ["-max_len=1000", "-timeout=10", "-rss_limit_mb=2000", "-print_final_stats=1"]


def missing_package() -> str | None:
    """The Debian package without which nothing can be fuzzed, if it is not there."""
    if not (shutil.which("clang") and shutil.which("clang++")):
        return "clang"
    libraries = Path(run(["clang", "-print-runtime-dir"], "clang failed").strip())
    if any(libraries.glob("libclang_rt.fuzzer*")):
        return None
    (version,) = re.findall(r"version (\d+)", run(["clang", "--version"], "clang failed"))
    return f"libclang-rt-{version}-dev"


def fuzz(robot: str, backend: str, seconds: int) -> bool:
    """Compile and run the fuzzer for one robot and back end; False if it found something."""
    name = f"{Path(robot).stem}-{backend}"
    generated = proxgen.generate(proxgen.load(ROOT / "examples" / robot), OUT / f"{name}-generated")
    program = compile_program(HERE / "fuzz_step.c", generated, backend, OUT / name, OPTIONS)
    found = OUT / f"{name}-corpus"
    found.mkdir(exist_ok=True)
    limits = [*LIMITS, f"-max_total_time={seconds}", f"-artifact_prefix={OUT}/{name}-"]
    done = subprocess.run(
        [str(program), *limits, str(found), str(HERE / "corpus")],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
    )
    if done.returncode != 0:
        print(done.stdout[-5000:], file=sys.stderr)
        return False
    (runs,) = re.findall(r"^Done (\d+) runs", done.stdout, re.M)
    places = re.findall(r" cov: (\d+) ", done.stdout)[-1]
    print(f"{name}: {int(runs):,} inputs in {seconds} s reach {places} places; no promise was broken")
    return True


def main(seconds: int | None) -> int:
    """Fuzz all targets, if there is a time for it; 1 if something was found or a tool is missing."""
    package = missing_package()
    if package:
        print(f"fuzzing needs clang and its libFuzzer: apt-get install {package}", file=sys.stderr)
        return 1
    if seconds is None:
        return 0
    os.environ |= {"CC": "clang", "CXX": "clang++"}
    OUT.mkdir(parents=True, exist_ok=True)
    kept = [fuzz(robot, backend, max(1, round(share * seconds))) for robot, backend, share in TARGETS]
    return 0 if all(kept) else 1


if __name__ == "__main__":
    try:
        sys.exit(main(None if sys.argv[1:] == ["--check"] else int(sys.argv[1])))
    except ProxgenError as problem:
        sys.exit(f"proxgen: {problem}")
