from pathlib import Path

import pytest

from proxgen.builder import BuildResult, build
from proxgen.config.schema import Config


@pytest.fixture(scope="session")
def planar2_daqp(planar2_config: Config, tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    """The planar arm over DAQP; tests leave it as it is."""
    return build(planar2_config, tmp_path_factory.mktemp("planar2_daqp") / "built", backend="daqp")


@pytest.fixture(scope="session")
def iiwa7_qpoases(iiwa7_config: Config, tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    """The iiwa 7 over qpOASES; tests leave it as it is."""
    return build(iiwa7_config, tmp_path_factory.mktemp("iiwa7_qpoases") / "built", backend="qpoases")


@pytest.fixture
def no_compilers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A system in which nothing can be found."""
    for name in ("CC", "CXX"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
