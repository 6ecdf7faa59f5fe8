"""The compiled controller: a robot's library, loaded with cffi."""

from proxgen.controllers.compiled.controller import CompiledController, Counters

__all__ = ["CompiledController", "Counters"]
