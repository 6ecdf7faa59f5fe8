"""Fuzzes the step function for a while: `python runtime/fuzz/fuzz.py SECONDS` (part of `make sanitize`).

libFuzzer starts from the committed corpus and follows what new code its inputs reach, in the planar arm's
controller, with AddressSanitizer and UndefinedBehaviorSanitizer. Inputs that break a promise are kept in
build/fuzz, and end this program with 1. With `--check`, it only says what is missing.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from proxgen.builder.program import compile_program
from proxgen.builder.toolchain import run
from proxgen.errors import ProxgenError

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OUT = ROOT / "build" / "fuzz"
SHARES = {"daqp": 2 / 3, "qpoases": 1 / 3}  # of the time; the inside of qpOASES is not seen
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


def fuzz(backend: str, seconds: int) -> bool:
    """Compile and run the fuzzer for one back end; False if it found something."""
    program = compile_program(
        HERE / "fuzz_step.c", ROOT / "generated" / "planar2", backend, OUT / backend, OPTIONS
    )
    found = OUT / f"{backend}-corpus"
    found.mkdir(exist_ok=True)
    limits = [*LIMITS, f"-max_total_time={seconds}", f"-artifact_prefix={OUT}/{backend}-"]
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
    print(f"{backend}: {int(runs):,} inputs in {seconds} s reach {places} places; no promise was broken")
    return True


def main(seconds: int | None) -> int:
    """Fuzz with both back ends, if there is a time for it; 1 if something was found or a tool is missing."""
    package = missing_package()
    if package:
        print(f"fuzzing needs clang and its libFuzzer: apt-get install {package}", file=sys.stderr)
        return 1
    if seconds is None:
        return 0
    os.environ |= {"CC": "clang", "CXX": "clang++"}
    OUT.mkdir(parents=True, exist_ok=True)
    kept = [fuzz(name, max(1, round(share * seconds))) for name, share in SHARES.items()]
    return 0 if all(kept) else 1


if __name__ == "__main__":
    try:
        sys.exit(main(None if sys.argv[1:] == ["--check"] else int(sys.argv[1])))
    except ProxgenError as problem:
        sys.exit(f"proxgen: {problem}")
