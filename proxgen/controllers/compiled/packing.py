"""The input of a cycle as one block of bytes, in the order of `runtime/src/packed.h`."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from proxgen.controllers.protocol import Array, Measurement
from proxgen.errors import ControllerError

_FLOAT = np.dtype(np.float64)
_BOOL = np.dtype(np.bool_)
_NAMES = (
    "q",
    "xdot",
    "measurement.tof_range",
    "measurement.tof_age",
    "measurement.capacitive_age",
)
_join: Callable[[Iterable[Any]], bytes] = b"".join


class Packer:
    """Packs what a controller's `step` is given, after a look at sizes and types.

    One call joins all arrays; to copy each of them into memory of its own takes six times as long. The block
    belongs to the cycle alone, so that threads need not wait for each other here.
    """

    def __init__(self, dimensions: Mapping[str, int]) -> None:
        """Note the sizes.

        Args:
            dimensions: those of `manifest.json`.
        """
        tof, capacitive = dimensions["tof"], dimensions["capacitive"]
        self._capacity = dimensions["max_points"]
        self._vectors = ((dimensions["joints"],), (dimensions["task_rows"],), (tof,), (tof,), (capacitive,))
        self._switches = (capacitive,)
        self._fresh_tof, self._fresh_capacitive = np.zeros(tof), np.zeros(capacitive)

    def pack(self, q: Array, xdot: Array, measurement: Measurement) -> tuple[bytes, int]:
        """The block, and its number of points.

        Args:
            q: (n,) joint positions.
            xdot: (m,) task velocity.
            measurement: what the sensors saw.

        Raises:
            ControllerError: an array of the wrong size or type.
        """
        tof_range, capacitive, points = measurement.tof_range, measurement.capacitive, measurement.points
        tof_age, capacitive_age = measurement.tof_age, measurement.capacitive_age
        if tof_age is None:
            tof_age = self._fresh_tof
        if capacitive_age is None:
            capacitive_age = self._fresh_capacitive
        count = len(points)
        try:  # what nearly every caller passes needs nothing but these comparisons
            if (
                q.dtype == xdot.dtype == tof_range.dtype == tof_age.dtype == capacitive_age.dtype == _FLOAT
                and (q.shape, xdot.shape, tof_range.shape, tof_age.shape, capacitive_age.shape)
                == self._vectors
                and capacitive.dtype == _BOOL
                and capacitive.shape == self._switches
                and (count == 0 or (points.dtype == _FLOAT and points.shape == (count, 3)))
                and count <= self._capacity
            ):
                return _join((q, xdot, tof_range, tof_age, capacitive_age, points, capacitive)), count
        except (AttributeError, TypeError):
            pass  # something is no array, or does not lie in one piece
        vectors = map(_as_array, (q, xdot, tof_range, tof_age, capacitive_age), self._vectors, _NAMES)
        return self._convert(list(vectors), points, count, capacitive), count

    def _convert(self, vectors: list[np.ndarray], points: Any, count: int, capacitive: Any) -> bytes:
        """The same of lists, of numbers of other types, and of arrays that do not lie in one piece."""
        if count > self._capacity:
            raise ControllerError(
                f"measurement.points holds {count} points; skin.max_points allows {self._capacity}"
            )
        if count and np.shape(points) != (count, 3):
            raise ControllerError(f"measurement.points must have the shape (P, 3), not {np.shape(points)}")
        if count:
            vectors.append(_as_array(points, (count, 3), "measurement.points"))
        doubles = b"".join(np.asarray(array, _FLOAT).tobytes() for array in vectors)
        switches = _as_array(capacitive, self._switches, "measurement.capacitive")
        return doubles + switches.astype(_BOOL).tobytes()


def _as_array(value: Any, shape: tuple[int, ...], name: str) -> np.ndarray:
    """An argument as an array, if it has the right size and consists of real numbers.

    Raises:
        ControllerError: it has not, or does not.
    """
    words = " x ".join(str(size) for size in shape)
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiub" and array.size:
            raise TypeError(f"of type {array.dtype}")
    except (TypeError, ValueError) as error:
        raise ControllerError(f"{name} must be {words} numbers, not {value!r}") from error
    if array.shape != shape:
        raise ControllerError(f"{name} must be {words} numbers, not shape {array.shape}")
    return array
