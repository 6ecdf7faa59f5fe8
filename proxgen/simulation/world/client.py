"""A connection to pybullet that keeps quiet: standard output belongs to the command line."""

import ctypes
import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
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


def _require_display() -> None:
    """Refuse a window where there is no display: pybullet would end the whole process.

    Raises:
        SimulationError: on Linux, no X display can be opened.
    """
    if not sys.platform.startswith("linux"):
        return
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError as error:
        raise SimulationError("pybullet's window needs an X display, and there is no libX11") from error
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if not display:
        shown = os.environ.get("DISPLAY", "")
        raise SimulationError(
            f"pybullet's window needs an X display, but none can be opened (DISPLAY='{shown}')"
        )
    x11.XCloseDisplay(ctypes.c_void_p(display))


class Closing(ABC):
    """Something that is closed where its `with` block ends."""

    @abstractmethod
    def close(self) -> None:
        """Give back what it holds; closing twice does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()


class Client(Closing):
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
        self.id = -1
        self.bullet = _pybullet()
        if gui:
            _require_display()
        try:
            with silent(1):
                self.id = self.bullet.connect(self.bullet.GUI if gui else self.bullet.DIRECT)
        except self.bullet.error as error:
            raise SimulationError(f"pybullet cannot open a world: {error}") from error
        if self.id < 0:
            raise SimulationError("pybullet cannot open a world" + (" with a window" if gui else ""))

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
