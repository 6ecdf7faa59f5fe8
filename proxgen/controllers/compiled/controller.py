"""The compiled controller in Python: the Controller protocol over a robot's library.

Needs neither CasADi nor Pinocchio. One cycle costs a few microseconds: all arguments pass as one block of
bytes, and the diagnostics come back as one, which is taken apart only if somebody looks at it.
"""

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxgen.controllers.compiled.library import Library, load_library
from proxgen.controllers.compiled.packing import Packer
from proxgen.controllers.compiled.result import make_command, number_or_array
from proxgen.controllers.compiled.settable import check_orders, checked
from proxgen.controllers.protocol import Array, Command, Measurement, Status
from proxgen.errors import ControllerError

_STATUS = {status.value: status for status in Status}


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
        self._step = library.function("step_packed")
        self._pack = Packer(library.manifest["dimensions"]).pack
        self._make_buffers()

    def __repr__(self) -> str:
        """Robot, solver, sizes, and how many cycles it has done."""
        size = self.manifest["dimensions"]
        parts = ("joints", "task_rows", "capsules", "tof", "capacitive")
        sizes = ", ".join(f"{part}={size[part]}" for part in parts)
        cycles = self.counters.cycles
        return f"CompiledController(robot={self.robot!r}, backend={self.backend!r}, {sizes}, cycles={cycles})"

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
        return {name: number_or_array(record[name]) for name in self._settable}

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
        """Forget the previous velocity, the previous time, the warm start, and what additions remember."""
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
        packed, count = self._pack(q, xdot, measurement)
        with self._lock:
            try:
                status = self._step(self._handle, measurement.time, packed, count, self._qdot_data)
            except TypeError as error:
                message = f"measurement.time must be a number, not {measurement.time!r}"
                raise ControllerError(message) from error
            if status < 0:
                raise ControllerError(f"the controller refused the call: {self._status_name(status)}")
            qdot, copied = self._qdot.copy(), self._diagnostics_memory[:]
        return make_command(qdot, _STATUS[status], copied, self._diagnostics_layout)

    def _create(self) -> Any:
        """A new controller in C, destroyed with this object."""
        library = self._library
        pointer = library.ffi.new(f"{library.robot}_controller_t **")
        status = library.function("create")(pointer)
        if status != 0:
            raise ControllerError(f"no controller could be made: {self._status_name(status)}")
        return library.ffi.gc(pointer[0], library.function("destroy"))

    def _make_buffers(self) -> None:
        """What a cycle leaves: C memory that is kept, and Python's views of it."""
        ffi = self._library.ffi
        self._qdot_data = ffi.new("double[]", self.manifest["dimensions"]["joints"])
        self._qdot = np.frombuffer(ffi.buffer(self._qdot_data))
        pointer = ffi.new(f"const {self.robot}_diagnostics_t **")
        self._call("diagnostics", pointer)
        self._diagnostics_memory = ffi.buffer(pointer[0])
        self._diagnostics_layout = self._library.layout("diagnostics")

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
