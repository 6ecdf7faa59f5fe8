"""What pyproject.toml cannot say: a wheel carries runtime and examples, which lie outside the package."""

from pathlib import Path
from shutil import copyfile, copytree, ignore_patterns

from setuptools import setup
from setuptools.command.build_py import build_py

EXAMPLES = ("yaml", "urdf", "csv")
"""Endings of the files that describe robots, scenes and trajectories."""


class BuildWithCompanions(build_py):
    """Copies `runtime/` to `proxgen/_runtime/`, robots and scenes of `examples/` to `proxgen/_examples/`.

    An editable install uses the checkout's own.
    """

    def run(self) -> None:
        """Build, then copy."""
        super().run()
        if self.editable_mode:
            return
        package = Path(self.build_lib) / "proxgen"
        for part in ("include", "src", "bench"):
            target = package / "_runtime" / part
            copytree(Path("runtime") / part, target, dirs_exist_ok=True, ignore=ignore_patterns(".*"))
        copyfile("LICENSE", package / "_runtime" / "LICENSE")
        for source in sorted(path for ending in EXAMPLES for path in Path("examples").glob(f"*/*.{ending}")):
            target = package / "_examples" / source.relative_to("examples")
            target.parent.mkdir(parents=True, exist_ok=True)
            copyfile(source, target)


setup(cmdclass={"build_py": BuildWithCompanions})
