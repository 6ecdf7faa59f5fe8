import shutil
from pathlib import Path

import pytest

from proxgen.builder import BuildResult, build
from proxgen.config.schema import Config


@pytest.fixture(scope="session")
def iiwa7_daqp(iiwa7_config: Config, tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    """The iiwa 7 over DAQP; tests leave it as it is."""
    return build(iiwa7_config, tmp_path_factory.mktemp("iiwa7_daqp") / "built", backend="daqp")


@pytest.fixture
def package(iiwa7_daqp: BuildResult, tmp_path: Path) -> Path:
    """What of it is installed, in another place than where it was built."""
    private = shutil.ignore_patterns(".proxgen", "generated", "python")
    return Path(shutil.copytree(iiwa7_daqp.library_dir, tmp_path / "opt" / "iiwa7", ignore=private))
