"""`proxgen.generate` and `proxgen.build`: from a configuration to code, or to a controller that runs."""

from pathlib import Path
from typing import TYPE_CHECKING

from proxgen.config import load
from proxgen.config.schema import Config

if TYPE_CHECKING:
    from proxgen.controllers.compiled import CompiledController


def generate(config: Config | str | Path, directory: str | Path | None = None) -> Path:
    """Write the generated code of a robot.

    Args:
        config: of the robot, or its YAML file.
        directory: where to; `generated/<robot>` in the current folder if None.

    Returns:
        The folder.

    Raises:
        GenerateError: code cannot be generated, or the folder cannot be written.
        ConfigError: the file has mistakes, or the robot description does not fit the configuration.
    """
    from proxgen import emit
    from proxgen.model import build_model
    from proxgen.symbolic import build_program

    config = _loaded(config)
    folder = Path(directory or Path("generated") / config.robot.name)
    emit.generate(build_program(config, build_model(config)), folder)
    return folder


def build(
    config: Config | str | Path, directory: str | Path | None = None, backend: str | None = None
) -> "CompiledController":
    """Generate and compile the controller of a robot, unless it is up to date, and load it.

    Args:
        config: of the robot, or its YAML file.
        directory: where to; if None, `build/<robot>` in the current folder, or `build/<robot>.<file>` if that
            holds the controller of another file with the same `robot.name`.
        backend: `qpoases` or `daqp`; that of the configuration if None.

    Returns:
        A new controller, at rest.

    Raises:
        BuildError: compiler, solver or sources missing, or the compiler refuses the code.
        GenerateError: code cannot be generated.
        ConfigError: the file has mistakes, or the robot description does not fit the configuration.
    """
    from proxgen import builder
    from proxgen.controllers.compiled import CompiledController

    return CompiledController.load(builder.build(_loaded(config), directory, backend).library_dir)


def _loaded(config: Config | str | Path) -> Config:
    """The configuration, read if only its file was named."""
    return config if isinstance(config, Config) else load(config)
