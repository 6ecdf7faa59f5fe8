"""From a URDF to a first configuration that works: `proxgen init`."""

from proxgen.scaffold.initialise import scaffold

__all__ = ["scaffold"]
