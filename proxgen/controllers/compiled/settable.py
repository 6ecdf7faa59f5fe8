"""Parameters by name, checked against the manifest of the generated code before C sees them."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from proxgen.errors import ControllerError, unknown_name

_ORDERS = (
    ("q_lower", "<", "q_upper"),
    ("d_0u", "<", "d_a"),
    ("d_0l", "<=", "d_0u"),
    ("d_r", "<", "d_0l"),
    ("damper_safety", "<", "damper_influence"),
    ("self_d_0u", "<", "self_d_a"),
    ("self_d_0l", "<=", "self_d_0u"),
    ("self_d_r", "<", "self_d_0l"),
)
"""What has to hold between parameters (table of docs/method.md); C checks it as well."""


def checked(name: str, value: Any, manifest: Mapping[str, Mapping[str, Any]]) -> np.ndarray:
    """A new value for a parameter, as an array of its shape.

    Args:
        name: of the parameter.
        value: a number, or one per joint.
        manifest: the parameters of `manifest.json` by name.

    Raises:
        ControllerError: unknown name, wrong type or shape, or out of its range.
    """
    if name not in manifest:
        raise ControllerError(unknown_name("parameter", name, manifest))
    entry = manifest[name]
    shape = tuple(entry["shape"])
    words = f"{shape[0]} numbers" if shape else "one number"
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ControllerError(f"parameter '{name}' must be {words}, not {value!r}") from error
    if array.shape != shape:
        raise ControllerError(f"parameter '{name}' must be {words}, not shape {array.shape}")
    lower, upper = entry["lower"], entry["upper"]
    if not np.all((array >= lower) & (array <= upper)):
        unit = f" {entry['unit']}" if entry["unit"] else ""
        raise ControllerError(
            f"parameter '{name}' must be within {lower:g} and {upper:g}{unit}, not {value!r}"
        )
    if name == "viability" and array not in (0.0, 1.0):
        raise ControllerError(f"parameter 'viability' must be 0 or 1, not {value!r}")
    return array


def check_orders(values: Mapping[str, Any], names: Iterable[str]) -> None:
    """Refuse values that are right by themselves, but not together.

    Args:
        values: all parameters by name, as they would be.
        names: those that exist for this robot.

    Raises:
        ControllerError: names the two that are out of order.
    """
    known = set(names)
    for low, relation, high in _ORDERS:
        if not {low, high} <= known:
            continue
        below, above = np.asarray(values[low]), np.asarray(values[high])
        if not np.all(below < above if relation == "<" else below <= above):
            raise ControllerError(
                f"parameters must keep {low} {relation} {high}, not {values[low]} and {values[high]}"
            )
