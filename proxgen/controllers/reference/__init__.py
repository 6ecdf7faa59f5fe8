"""The reference: docs/method.md in plain NumPy and numeric Pinocchio, one function per equation.

It shares no code with the generated side (symbolic, program, emit, runtime) and uses another QP solver, so
that two errors would have to be the same to go unnoticed by `proxgen compare`. To be read beside the paper:
`kinematics` (1)(2), `avoidance` (4)-(7), (12), (13), `objective` (3), (9), (11), (14), (15), `relaxation` the
section IV.C, `qp` and `feasibility` the solver of (8); `faults` and `parameters` are what surrounds it.
"""

from proxgen.controllers.reference.controller import ReferenceController

__all__ = ["ReferenceController"]
