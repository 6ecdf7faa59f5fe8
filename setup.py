"""What pyproject.toml cannot say: a wheel carries the runtime's sources, which lie outside the package."""

from pathlib import Path
from shutil import copytree, ignore_patterns

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithRuntime(build_py):
    """Copies `runtime/` to `proxgen/_runtime/`; an editable install uses the checkout's own."""

    def run(self) -> None:
        """Build, then copy."""
        super().run()
        if not self.editable_mode:
            for part in ("include", "src", "bench"):
                target = Path(self.build_lib) / "proxgen" / "_runtime" / part
                copytree(Path("runtime") / part, target, dirs_exist_ok=True, ignore=ignore_patterns(".*"))


setup(cmdclass={"build_py": BuildWithRuntime})
