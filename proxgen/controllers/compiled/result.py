"""What a cycle left, in Python: made at the least cost, for few look at the diagnostics of each."""

from dataclasses import fields
from typing import Any

import numpy as np

from proxgen.controllers.protocol import Array, Command, Diagnostics, Status

_DIAGNOSTICS = frozenset(field.name for field in fields(Diagnostics))
_ABSENT = {
    field.name: field.default_factory for field in fields(Diagnostics) if callable(field.default_factory)
}


class LazyDiagnostics(Diagnostics):
    """Diagnostics that are taken out of a copy of C's when one of them is first asked for."""

    __slots__ = ("_copied",)  # (bytes, layout)

    def __getattr__(self, name: str) -> Any:
        """Take all of them apart."""
        if name not in _DIAGNOSTICS:
            raise AttributeError(f"'Diagnostics' object has no attribute '{name}'")
        copied: tuple[bytes, np.dtype[np.void]] = self._copied
        record = np.frombuffer(*copied)[0]
        n = len(record["g"])
        known = _DIAGNOSTICS.intersection(record.dtype.names or ())
        values = {key: number_or_array(record[key]) for key in known}
        values |= {key: make() for key, make in _ABSENT.items() if key not in known}
        values["H"] = record["H"].reshape(n, n).copy()
        values["A"] = record["A"].reshape(-1, n).copy()
        values["nearest_point"] = record["nearest_point"].reshape(-1, 3).copy()
        values["row_on"] = record["row_on"].astype(bool)
        values["circulating"] = bool(values["circulating"])
        self.__dict__.update(values)
        return values[name]

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are plain diagnostics."""
        return Diagnostics, tuple(getattr(self, field.name) for field in fields(Diagnostics))

    def __repr__(self) -> str:
        """As any Diagnostics."""
        return f"Diagnostics({', '.join(f'{f.name}={getattr(self, f.name)!r}' for f in fields(Diagnostics))})"


# To set the slots of a frozen class so takes a third of the time of its own constructor.
_new = object.__new__
_set_copied = LazyDiagnostics.__dict__["_copied"].__set__
_set_qdot = Command.__dict__["qdot"].__set__
_set_status = Command.__dict__["status"].__set__
_set_diagnostics = Command.__dict__["diagnostics"].__set__


def make_command(qdot: Array, status: Status, copied: bytes, layout: "np.dtype[np.void]") -> Command:
    """A command whose diagnostics are a copy of C's.

    Args:
        qdot: (n,) joint velocity, the caller's own [rad/s].
        status: of the cycle.
        copied: the bytes of C's diagnostics.
        layout: what they are.
    """
    diagnostics = _new(LazyDiagnostics)
    _set_copied(diagnostics, (copied, layout))
    command = _new(Command)
    _set_qdot(command, qdot)
    _set_status(command, status)
    _set_diagnostics(command, diagnostics)
    return command


def number_or_array(value: Any) -> Any:
    """A plain number, or an array of one's own."""
    return value.copy() if value.shape else value.item()
