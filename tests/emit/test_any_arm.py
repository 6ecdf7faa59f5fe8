"""The generated code of arms that are not in the repository."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from proxgen.config.schema import Config
from proxgen.emit import generate
from proxgen.model import RobotModel
from proxgen.symbolic import build_program

ROOT = Path(__file__).resolve().parents[2]


def test_it_compiles_without_a_warning_and_is_laid_out(
    any_config: Config, any_model: RobotModel, compile_c: Callable[..., Path], tmp_path: Path
) -> None:
    generate(build_program(any_config, any_model), tmp_path)
    compile_c(tmp_path / "model.c")
    compile_c(tmp_path / "kernels.c", raw=True)
    clang_format = Path(sys.executable).parent / "clang-format"
    command: list[str | Path] = [
        clang_format,
        f"--style=file:{ROOT / '.clang-format'}",
        "--dry-run",
        "-Werror",
    ]
    readable = [path for path in sorted(tmp_path.glob("*.[ch]*")) if path.stem != "kernels"]
    assert len(readable) == 5
    subprocess.run([*command, *readable], check=True)
