"""`proxgen.generate` and `proxgen.build`: from a configuration to code, or to a controller that runs."""

from pathlib import Path
from typing import TYPE_CHECKING

from proxgen.config.schema import Config

if TYPE_CHECKING:
    from proxgen.controllers.compiled import CompiledController


def generate(config: Config, directory: str | Path | None = None) -> Path:
    """Write the generated code of a robot.

    Args:
        config: of the robot.
        directory: where to; `generated/<robot>` in the current folder if None.

    Returns:
        The folder.

    Raises:
        GenerateError: code cannot be generated, or the folder cannot be written.
        ConfigError: the robot description does not fit the configuration.
    """
    from proxgen import emit
    from proxgen.model import build_model
    from proxgen.symbolic import build_program

    folder = Path(directory or Path("generated") / config.robot.name)
    emit.generate(build_program(config, build_model(config)), folder)
    return folder


def build(
    config: Config, directory: str | Path | None = None, backend: str | None = None
) -> "CompiledController":
    """Generate and compile the controller of a robot, unless it is up to date, and load it.

    Args:
        config: of the robot.
        directory: where to; if None, `build/<robot>` in the current folder, or `build/<robot>.<file>` if that
            holds the controller of another file with the same `robot.name`.
        backend: `qpoases` or `daqp`; that of the configuration if None.

    Returns:
        A new controller, at rest.

    Raises:
        BuildError: compiler, solver or sources missing, or the compiler refuses the code.
        GenerateError: code cannot be generated.
        ConfigError: the robot description does not fit the configuration.
    """
    from proxgen import builder
    from proxgen.controllers.compiled import CompiledController

    return CompiledController.load(builder.build(config, directory, backend).library_dir)
