import numpy as np
import pytest
from compiled_tools import XDOT, Q

from proxgen.controllers.compiled import CompiledController
from proxgen.controllers.protocol import Measurement
from proxgen.errors import ControllerError


def test_parameters_are_those_of_the_manifest(controller: CompiledController) -> None:
    found = controller.parameters
    entries = controller.manifest["parameters"]
    assert list(found) == [entry["name"] for entry in entries]
    for entry in entries:
        np.testing.assert_array_equal(found[entry["name"]], entry["default"])
        assert np.shape(found[entry["name"]]) == tuple(entry["shape"])


def test_parameters_are_changed_by_name(controller: CompiledController, nothing: Measurement) -> None:
    controller.set_parameters(d_a=0.5, qdot_limit=[0.001, 0.002], viability=1)
    assert controller.parameters["d_a"] == 0.5
    np.testing.assert_array_equal(controller.parameters["qdot_limit"], [0.001, 0.002])
    found = controller.step(Q, XDOT, nothing).diagnostics
    assert np.all(np.abs(found.ub) <= [0.001, 0.002])


def test_parameters_that_are_read_are_copies(controller: CompiledController) -> None:
    lower = controller.parameters["q_lower"]
    assert isinstance(lower, np.ndarray)
    lower[:] = 7.0
    assert not np.any(np.asarray(controller.parameters["q_lower"]) == 7.0)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"d_aa": 0.3}, "unknown parameter 'd_aa'; did you mean 'd_a'"),
        ({"d_a": -1.0}, r"'d_a' must be within \S+ and \S+ m, not -1\.0"),
        ({"d_a": float("nan")}, "'d_a' must be within"),
        ({"d_a": [0.3, 0.3]}, r"'d_a' must be one number, not shape \(2,\)"),
        ({"q_lower": 0.0}, r"'q_lower' must be 2 numbers, not shape \(\)"),
        ({"q_lower": "low"}, "'q_lower' must be 2 numbers, not 'low'"),
        ({"qdot_limit": [1.0, 0.0]}, "'qdot_limit' must be within"),
        ({"repulse_speed": 0.1}, r"'repulse_speed' must be within \S+ and 0 m/s, not 0\.1"),
        ({"viability": 0.5}, "'viability' must be 0 or 1, not 0.5"),
        ({"q_lower": [9.0, 0.0]}, "parameters must keep q_lower < q_upper"),
        ({"d_0u": 0.9}, "parameters must keep d_0u < d_a"),
        ({"d_r": 0.1, "d_0l": 0.1}, r"parameters must keep d_r < d_0l, not 0\.1 and 0\.1"),
        ({"d_0l": 0.13}, "parameters must keep d_0l <= d_0u"),
        ({"damper_safety": 0.5}, "parameters must keep damper_safety < damper_influence"),
    ],
)
def test_a_parameter_that_is_not_accepted_changes_none(
    controller: CompiledController, values: dict[str, object], message: str
) -> None:
    before = controller.parameters
    with pytest.raises(ControllerError, match=message):
        controller.set_parameters(period=0.005, **values)
    after = controller.parameters
    for name, value in before.items():
        np.testing.assert_array_equal(after[name], value)


def test_c_refuses_what_python_would_let_through(
    controller: CompiledController, monkeypatch: pytest.MonkeyPatch
) -> None:
    from proxgen.controllers.compiled import controller as module

    monkeypatch.setattr(module, "check_orders", lambda values, names: None)
    with pytest.raises(ControllerError, match="set_parameters failed: ERROR_PARAMETER"):
        controller.set_parameters(d_0u=0.9)
