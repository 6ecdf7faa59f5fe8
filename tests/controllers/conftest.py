from pathlib import Path

import pytest
from compiled_tools import free_space

from proxgen.builder import build
from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Measurement
from proxgen.model import RobotModel


@pytest.fixture(scope="session")
def library(planar2_config: Config, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The planar arm over DAQP."""
    return build(planar2_config, tmp_path_factory.mktemp("planar2") / "built", backend="daqp").library_dir


@pytest.fixture
def controller(library: Path) -> CompiledController:
    return CompiledController.load(library)


@pytest.fixture
def nothing(planar2_model: RobotModel) -> Measurement:
    """A measurement of free space."""
    return free_space(planar2_model)
