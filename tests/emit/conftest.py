import ctypes
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STRICT = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
RAW = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wno-unused-parameter", "-Werror"]

Compile = Callable[..., Path]


@pytest.fixture
def compile_c() -> Compile:
    """Compiles one C file of a folder, strictly, into an object beside it."""

    def compile_one(source: Path, *options: str, raw: bool = False) -> Path:
        flags = RAW if raw else STRICT
        target = source.with_suffix(".o")
        include = [f"-I{ROOT / 'runtime' / 'include'}", f"-I{source.parent}"]
        command = [os.environ.get("CC", "cc"), *flags, "-O1", "-fPIC", *include, *options]
        subprocess.run([*command, "-c", str(source), "-o", str(target)], check=True)
        return target

    return compile_one


@pytest.fixture
def load_c(tmp_path: Path) -> Callable[..., ctypes.CDLL]:
    """Links objects into a shared library and loads it."""

    def load(*objects: Path) -> ctypes.CDLL:
        target = tmp_path / "library.so"
        compiler = os.environ.get("CC", "cc")
        subprocess.run([compiler, "-shared", *map(str, objects), "-lm", "-o", str(target)], check=True)
        return ctypes.CDLL(str(target))

    return load
