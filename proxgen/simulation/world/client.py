"""A connection to pybullet that keeps quiet: standard output belongs to the command line."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import TracebackType
from typing import Any, Self

from proxgen.errors import SimulationError


@contextmanager
def silent(*descriptors: int) -> Iterator[None]:
    """Send what C code writes to file descriptors to nowhere; its buffers are flushed before and after."""
    flush = ctypes.CDLL(None).fflush
    sys.stdout.flush()
    sys.stderr.flush()
    flush(None)
    kept, nowhere = [os.dup(descriptor) for descriptor in descriptors], os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in descriptors:
            os.dup2(nowhere, descriptor)
        yield
    finally:
        flush(None)
        for descriptor, copy in zip(descriptors, kept, strict=True):
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(nowhere)


@cache
def _pybullet() -> Any:
    """The module, imported on first use: it takes a while and prints a banner."""
    with silent(1, 2):
        import pybullet
    return pybullet


class Client:
    """One physics client; every call names it, so that several worlds live side by side in one process.

    Attributes:
        bullet: the pybullet module.
        id: its number; -1 after `close`.
    """

    def __init__(self, *, gui: bool = False) -> None:
        """Connect, with pybullet's window if `gui`.

        Raises:
            SimulationError: no connection, such as a window without a display.
        """
        self.bullet = _pybullet()
        try:
            with silent(1):
                self.id: int = self.bullet.connect(self.bullet.GUI if gui else self.bullet.DIRECT)
        except self.bullet.error as error:
            raise SimulationError(f"pybullet cannot open a world: {error}") from error
        if self.id < 0:
            raise SimulationError("pybullet cannot open a world" + (" with a window" if gui else ""))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def keyword(self) -> dict[str, int]:
        """To be passed to every call.

        Raises:
            SimulationError: after `close`; pybullet would have given the number to another client.
        """
        if self.id < 0:
            raise SimulationError("this world is closed")
        return {"physicsClientId": self.id}

    def close(self) -> None:
        """Disconnect; closing twice does nothing."""
        if self.id >= 0:
            with silent(1):
                self.bullet.disconnect(physicsClientId=self.id)
            self.id = -1
