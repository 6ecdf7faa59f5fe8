"""proxgen: from one YAML file to a compiled, certified collision-avoidance controller for any serial arm.

    config = proxgen.load("examples/iiwa7/iiwa7.yaml")
    controller = proxgen.build(config)
    command = controller.step(q, xdot, measurement)

Names are imported on first use, so that commands that need no solver or model start quickly.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from proxgen.builder.api import build as build
    from proxgen.builder.api import generate as generate
    from proxgen.config import load as load
    from proxgen.config.schema import Config as Config
    from proxgen.controllers.protocol import Command as Command
    from proxgen.controllers.protocol import Measurement as Measurement
    from proxgen.controllers.protocol import Status as Status
    from proxgen.controllers.reference import ReferenceController as ReferenceController
    from proxgen.errors import ProxgenError as ProxgenError

_HOMES = {
    "build": "proxgen.builder.api",
    "generate": "proxgen.builder.api",
    "load": "proxgen.config",
    "Config": "proxgen.config.schema",
    "Command": "proxgen.controllers.protocol",
    "Measurement": "proxgen.controllers.protocol",
    "Status": "proxgen.controllers.protocol",
    "ReferenceController": "proxgen.controllers.reference",
    "ProxgenError": "proxgen.errors",
}

__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> Any:
    """Import a public name from its room when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module 'proxgen' has no attribute '{name}'")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value
