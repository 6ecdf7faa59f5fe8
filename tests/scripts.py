"""Programs of the repository that are no modules of proxgen, for their tests."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parent.parent


def load_script(path: Path) -> ModuleType:
    """A script as a module; it must not do anything on import."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[path.stem] = importlib.util.module_from_spec(spec)  # dataclasses look there
    spec.loader.exec_module(module)
    return module


def run_with_tools(script: Path, tools: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a script where no programs but those of a folder can be found."""
    environment = {**os.environ, "PATH": str(tools)}
    command = [sys.executable, str(script), *arguments]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
