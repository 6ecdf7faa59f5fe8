"""Of points that are equally near the first counts: ranges, then switches, then points from elsewhere."""

from pathlib import Path

import numpy as np
import pytest
from compiled_tools import XDOT, Q

from proxgen.config.schema import Config
from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Controller, Measurement
from proxgen.controllers.reference import ReferenceController
from proxgen.model import RobotModel
from proxgen.model.kinematics import body_poses


@pytest.fixture(params=["compiled", "reference"])
def either(
    request: pytest.FixtureRequest, library: Path, planar2_config: Config, planar2_model: RobotModel
) -> Controller:
    """Each of the two controllers."""
    if request.param == "compiled":
        return CompiledController.load(library)
    return ReferenceController(planar2_config, planar2_model)


def test_a_reading_of_the_whole_range_is_no_point(either: Controller) -> None:
    """Also where points so far away would count."""
    either.set_parameters(d_a=2.0, d_active=2.0)
    for time, reading in enumerate((1.0, 0.999)):
        seen = Measurement(float(time), np.array([1.0, reading, 1.0, 1.0]), np.zeros(4, dtype=bool))
        found = either.step(Q, XDOT, seen).diagnostics
        assert np.isfinite(found.distance).all() == (reading < 1.0)
        assert found.row_on.any() == (reading < 1.0)


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 2, 0), (3, 0, 2), (2, 3, 1)])
def test_the_first_kind_of_equally_near_points(
    either: Controller, planar2_model: RobotModel, order: tuple[int, int, int]
) -> None:
    """Three of the four modules around link 2 say something at one distance; the kinds go one by one."""
    modules, pose = planar2_model.modules, body_poses(planar2_model, Q)[2]
    (reach,) = {module.capacitive.virtual_distance for module in modules if module.capacitive}
    places = [pose[:3, :3] @ (m.position + reach * m.normal) + pose[:3, 3] for m in modules]
    ranged, closed, given = order
    ranges, switches, points = np.ones(4), np.zeros(4, dtype=bool), places[given][None]
    ranges[ranged], switches[closed] = reach, True
    expected = []
    for time, (seen, on) in enumerate(
        ((ranges, switches), (np.ones(4), switches), (np.ones(4), switches & False))
    ):
        found = either.step(Q, XDOT, Measurement(float(time), seen, on, points=points)).diagnostics
        expected.append(found.nearest_point[1])
    np.testing.assert_allclose(expected, [places[ranged], places[closed], places[given]], atol=1e-12)
