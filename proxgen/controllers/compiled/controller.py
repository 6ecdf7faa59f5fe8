"""The compiled controller in Python: the Controller protocol over a robot's library.

Needs neither CasADi nor Pinocchio. One cycle costs a few microseconds: arguments are copied into C memory
that is kept, and the diagnostics are copied as one block that is taken apart only if somebody looks at it.
"""

import threading
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.controllers.compiled.library import Library, load_library
from proxgen.controllers.compiled.settable import check_orders, checked
from proxgen.controllers.protocol import Array, Command, Diagnostics, Measurement, Status
from proxgen.errors import ControllerError

_STATUS = {status.value: status for status in Status}
_DIAGNOSTICS = frozenset(field.name for field in fields(Diagnostics))
_ABSENT = {
    field.name: field.default_factory for field in fields(Diagnostics) if callable(field.default_factory)
}
_FLOAT = np.dtype(np.float64)
_BOOL = np.dtype(np.bool_)
_new = object.__new__


@dataclass(frozen=True)
class Counters:
    """What a controller has counted since it was made; `reset` leaves it.

    Attributes:
        cycles: all of them.
        status_count: how many ended with each status that occurred; they add up to `cycles`.
        solves: QPs solved.
        iterations: working-set changes.
        second_chances: QPs solved again because the first answer was not certified.
        certificate_failures: answers that failed the certificate.
        max_iterations_in_cycle: the most working-set changes in one cycle.
    """

    cycles: int
    status_count: dict[Status, int]
    solves: int
    iterations: int
    second_chances: int
    certificate_failures: int
    max_iterations_in_cycle: int


class CompiledController:
    """A robot's compiled controller.

    May be used from any thread; calls of one controller follow one another, and the GIL is free during a
    cycle, so that several controllers run side by side.

    Attributes:
        robot: its name.
        backend: the QP solver.
        manifest: what was generated: dimensions, names, parameters, tables (`manifest.json`).
    """

    def __init__(self, library: Library) -> None:
        """Make a controller at rest, with the parameters of the configuration."""
        self.robot = library.robot
        self.backend = library.backend
        self.manifest = library.manifest
        self._library = library
        self._lock = threading.Lock()
        self._settable = {entry["name"]: entry for entry in library.manifest["parameters"]}
        self._handle = self._create()
        self._step = library.function("step")
        self._aged_kinds = [False, False]  # whether C looks at ages of range sensors, of switches
        self._make_buffers()

    @classmethod
    def load(cls, library_dir: str | Path) -> "CompiledController":
        """A new controller from a folder that `proxgen build` made.

        Raises:
            ControllerError: there is no library in it, or it cannot be used.
        """
        return cls(load_library(library_dir))

    @property
    def parameters(self) -> Mapping[str, float | Array]:
        """Copies of all run-time parameters by name."""
        record = self._read("get_parameters", "parameters")
        return {name: _number_or_array(record[name]) for name in self._settable}

    @property
    def counters(self) -> Counters:
        """What was counted so far."""
        record = self._read("counters", "counters")
        counts = record["status_count"]
        return Counters(
            cycles=int(record["cycles"]),
            status_count={status: int(counts[status]) for status in Status if counts[status]},
            solves=int(record["solves"]),
            iterations=int(record["iterations"]),
            second_chances=int(record["second_chances"]),
            certificate_failures=int(record["certificate_failures"]),
            max_iterations_in_cycle=int(record["max_iterations_in_cycle"]),
        )

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by name; all or, if one is not accepted, none.

        Args:
            values: numbers, and one number per joint for the vectors; see the table in docs/method.md.

        Raises:
            ControllerError: an unknown name, a wrong shape, a value out of its range or out of order.
        """
        arrays = {name: checked(name, value, self._settable) for name, value in values.items()}
        with self._lock:
            block = self._library.new("parameters")
            self._call("get_parameters", block)
            record = self._record(block, "parameters")
            for name, array in arrays.items():
                record[name] = array
            check_orders({name: record[name].tolist() for name in self._settable}, self._settable)
            self._call("set_parameters", block)

    def reset(self) -> None:
        """Forget the previous velocity, the previous time and the warm start."""
        with self._lock:
            self._call("reset")

    def step(self, q: Array, xdot: Array, measurement: Measurement) -> Command:
        """One control cycle.

        Args:
            q: (n,) joint positions [rad or m].
            xdot: (m,) task velocity [m/s, rad/s].
            measurement: what the sensors saw.

        Returns:
            The joint velocity, how it was found, and the QP behind it.

        Raises:
            ControllerError: an array of the wrong size or type.
        """
        with self._lock:
            self._take(q, xdot, measurement)
            status = self._step(self._handle, self._q_data, self._xdot_data, self._seen, self._qdot_data)
            if status < 0:
                raise ControllerError(f"the controller refused the call: {self._status_name(status)}")
            qdot = self._qdot.copy()
            snapshot = self._diagnostics_memory[:]
        diagnostics = _LazyDiagnostics(snapshot, self._diagnostics_layout)
        command = _new(Command)  # three times as fast as the frozen dataclass sets its fields itself
        command.__dict__.update(qdot=qdot, status=_STATUS[status], diagnostics=diagnostics)
        return command

    def _take(self, q: Array, xdot: Array, measurement: Measurement) -> None:
        """Copy the input of a cycle into C memory."""
        tof_range, capacitive = measurement.tof_range, measurement.capacitive
        if (
            type(q) is type(xdot) is type(tof_range) is np.ndarray
            and type(capacitive) is np.ndarray
            and q.dtype is xdot.dtype is tof_range.dtype is _FLOAT
            and capacitive.dtype is _BOOL
            and (q.shape, xdot.shape, tof_range.shape, capacitive.shape) == self._shapes
        ):
            self._q[...] = q
            self._xdot[...] = xdot
            self._tof_range[...] = tof_range
            self._capacitive[...] = capacitive
        else:
            _fill(self._q, q, "q")
            _fill(self._xdot, xdot, "xdot")
            _fill(self._tof_range, tof_range, "measurement.tof_range")
            _fill(self._capacitive, capacitive, "measurement.capacitive")
        try:
            self._seen.time = measurement.time
        except TypeError as error:
            raise ControllerError(f"measurement.time must be a number, not {measurement.time!r}") from error
        if measurement.tof_age is not None or measurement.capacitive_age is not None or self._aged:
            self._take_ages(measurement)
        count = len(measurement.points)
        self._seen.point_count = count
        if count:
            self._take_points(measurement.points, count)

    def _take_ages(self, measurement: Measurement) -> None:
        """Copy the ages of the readings, or say that there are none."""
        tof_age, capacitive_age = measurement.tof_age, measurement.capacitive_age
        if tof_age is not None:
            _copy(self._tof_age, tof_age, "measurement.tof_age")
        if capacitive_age is not None:
            _copy(self._capacitive_age, capacitive_age, "measurement.capacitive_age")
        aged = [tof_age is not None, capacitive_age is not None]
        if aged != self._aged_kinds:
            null = self._library.ffi.NULL
            self._seen.tof_age = self._tof_age_data if aged[0] else null
            self._seen.capacitive_age = self._capacitive_age_data if aged[1] else null
            self._aged_kinds = aged
            self._aged = any(aged)

    def _take_points(self, points: Array, count: int) -> None:
        """Copy the further obstacle points."""
        if count > len(self._points):
            raise ControllerError(
                f"measurement.points holds {count} points; skin.max_points allows {len(self._points)}"
            )
        if np.shape(points) != (count, 3):
            raise ControllerError(f"measurement.points must have the shape (P, 3), not {np.shape(points)}")
        _fill(self._points[:count], points, "measurement.points")

    def _create(self) -> Any:
        """A new controller in C, destroyed with this object."""
        library = self._library
        pointer = library.ffi.new(f"{library.robot}_controller_t **")
        status = library.function("create")(pointer)
        if status != 0:
            raise ControllerError(f"no controller could be made: {self._status_name(status)}")
        return library.ffi.gc(pointer[0], library.function("destroy"))

    def _make_buffers(self) -> None:
        """C memory for everything that passes in and out of a cycle, and NumPy's views of it."""
        sizes = self.manifest["dimensions"]
        self._q_data, self._q = self._buffer("double", sizes["joints"])
        self._xdot_data, self._xdot = self._buffer("double", sizes["task_rows"])
        self._qdot_data, self._qdot = self._buffer("double", sizes["joints"])
        self._tof_range_data, self._tof_range = self._buffer("double", sizes["tof"])
        self._tof_age_data, self._tof_age = self._buffer("double", sizes["tof"])
        self._capacitive_data, self._capacitive = self._buffer("unsigned char", sizes["capacitive"])
        self._capacitive_age_data, self._capacitive_age = self._buffer("double", sizes["capacitive"])
        self._points_data, points = self._buffer("double", 3 * sizes["max_points"])
        self._points = points.reshape(-1, 3)
        self._shapes = (self._q.shape, self._xdot.shape, self._tof_range.shape, self._capacitive.shape)
        self._aged = False  # whether C looks at ages now
        self._seen: Any = self._library.new("measurement")
        self._seen.tof_range = self._tof_range_data
        self._seen.capacitive = self._capacitive_data
        self._seen.points = self._points_data
        pointer = self._library.ffi.new(f"const {self.robot}_diagnostics_t **")
        self._call("diagnostics", pointer)
        self._diagnostics_memory = self._library.ffi.buffer(pointer[0])
        self._diagnostics_layout = self._library.layout("diagnostics")

    def _buffer(self, ctype: str, size: int) -> tuple[Any, np.ndarray]:
        """An array in C that is kept, and NumPy's view of it."""
        data = self._library.ffi.new(f"{ctype}[]", max(size, 1))
        dtype = _FLOAT if ctype == "double" else _BOOL
        return data, np.frombuffer(self._library.ffi.buffer(data), dtype)[:size]

    def _call(self, name: str, *arguments: Any) -> None:
        """Call a function on the controller.

        Raises:
            ControllerError: it returns an error.
        """
        status = self._library.function(name)(self._handle, *arguments)
        if status != 0:
            raise ControllerError(f"{self.robot}_{name} failed: {self._status_name(status)}")

    def _read(self, function: str, struct: str) -> Any:
        """What a function writes into a struct, as a NumPy record of its own."""
        block = self._library.new(struct)
        with self._lock:
            self._call(function, block)
        return self._record(block, struct)

    def _record(self, block: Any, struct: str) -> Any:
        """NumPy's view of a C struct."""
        return np.frombuffer(self._library.ffi.buffer(block), self._library.layout(struct))[0]

    def _status_name(self, status: int) -> str:
        """A status in words."""
        name: bytes = self._library.ffi.string(self._library.function("status_name")(status))
        return name.decode()


class _LazyDiagnostics(Diagnostics):
    """Diagnostics that are taken out of a copy of C's when one of them is first asked for."""

    def __init__(self, snapshot: bytes, layout: "np.dtype[np.void]") -> None:
        """Keep the copy."""
        state = self.__dict__
        state["_snapshot"] = snapshot
        state["_layout"] = layout

    def __getattr__(self, name: str) -> Any:
        """Take all of them apart."""
        if name not in _DIAGNOSTICS:
            raise AttributeError(f"'Diagnostics' object has no attribute '{name}'")
        state = self.__dict__
        record = np.frombuffer(state["_snapshot"], state["_layout"])[0]
        n = len(record["g"])
        known = _DIAGNOSTICS.intersection(record.dtype.names or ())
        values = {key: _number_or_array(record[key]) for key in known}
        values |= {key: make() for key, make in _ABSENT.items() if key not in known}
        values["H"] = record["H"].reshape(n, n).copy()
        values["A"] = record["A"].reshape(-1, n).copy()
        values["nearest_point"] = record["nearest_point"].reshape(-1, 3).copy()
        values["row_on"] = record["row_on"].astype(bool)
        values["circulating"] = bool(values["circulating"])
        state.update(values)
        return values[name]

    def __repr__(self) -> str:
        """As any Diagnostics."""
        return f"Diagnostics({', '.join(f'{f.name}={getattr(self, f.name)!r}' for f in fields(Diagnostics))})"


def _number_or_array(value: Any) -> Any:
    """A plain number, or an array of one's own."""
    return value.copy() if value.shape else value.item()


def _copy(buffer: Array, value: Any, name: str) -> None:
    """As `_fill`, without a second look at what is already an array of the right kind."""
    if type(value) is np.ndarray and value.dtype is _FLOAT and value.shape == buffer.shape:
        buffer[...] = value
    else:
        _fill(buffer, value, name)


def _fill(buffer: np.ndarray, value: Any, name: str) -> None:
    """Copy an argument into C memory, if it has the right size and consists of real numbers.

    Raises:
        ControllerError: it has not, or does not.
    """
    words = " x ".join(str(size) for size in buffer.shape)
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiub" and array.size:
            raise TypeError(f"of type {array.dtype}")
    except (TypeError, ValueError) as error:
        raise ControllerError(f"{name} must be {words} numbers, not {value!r}") from error
    if array.shape != buffer.shape:
        raise ControllerError(f"{name} must be {words} numbers, not shape {array.shape}")
    buffer[...] = array
