"""Arms for the tests: the two of the repository, and several that are made on the spot."""

from pathlib import Path

import pytest
from arms import RECIPES, write_arm

from proxgen.config import load
from proxgen.config.schema import Config
from proxgen.model import RobotModel, build_model

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples"


@pytest.fixture(scope="session")
def iiwa7_config() -> Config:
    """The iiwa 7 of the examples."""
    return load(EXAMPLES / "iiwa7" / "iiwa7.yaml")


@pytest.fixture(scope="session")
def iiwa7_model(iiwa7_config: Config) -> RobotModel:
    """Its model."""
    return build_model(iiwa7_config)


@pytest.fixture(scope="session")
def planar2_config() -> Config:
    """The planar two-link arm of the examples."""
    return load(EXAMPLES / "planar2" / "planar2.yaml")


@pytest.fixture(scope="session")
def planar2_model(planar2_config: Config) -> RobotModel:
    """Its model."""
    return build_model(planar2_config)


@pytest.fixture(scope="session", params=RECIPES, ids=lambda recipe: recipe.name)
def any_config(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Config:
    """Arms that are not in the repository (see `arms.py`)."""
    return load(write_arm(request.param, tmp_path_factory.mktemp(request.param.name)))


@pytest.fixture(scope="session")
def any_model(any_config: Config) -> RobotModel:
    """Their models."""
    return build_model(any_config)


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few pixels, so that many figures can be drawn."""
    from proxgen.report import style

    monkeypatch.setattr(style, "DPI", 40)
