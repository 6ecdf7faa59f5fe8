"""Two controllers, the same states and readings: do they decide the same, to rounding error?

`compare` does it in the closed loop of a scene, where the compiled controller moves the arm and the reference
sees what it sees; `compare_controllers_on` on any list of states, such as `random_states` makes.
"""

from proxgen.compare.closed_loop import compare
from proxgen.compare.comparison import Comparison, SceneComparison
from proxgen.compare.judge import Judge, Tolerances
from proxgen.compare.open_loop import compare_controllers_on
from proxgen.compare.state import State
from proxgen.compare.states import random_states

__all__ = [
    "Comparison",
    "Judge",
    "SceneComparison",
    "State",
    "Tolerances",
    "compare",
    "compare_controllers_on",
    "random_states",
]
