"""The comparison on a list of states, without a simulation."""

from collections.abc import Iterable

from proxgen.compare.closed_loop import tell
from proxgen.compare.comparison import Comparison, Record
from proxgen.compare.judge import Judge, Tolerances
from proxgen.compare.state import State
from proxgen.config.schema import Config
from proxgen.controllers.protocol import Controller


def compare_controllers_on(
    config: Config,
    states: Iterable[State],
    candidate: Controller,
    reference: Controller,
    *,
    name: str = "states",
    tolerances: Tolerances | None = None,
) -> Comparison:
    """Give two controllers the same states, one after the other, and judge every decision.

    Each state is met at the velocity that the candidate's command before has led to (see `Companion`).

    Args:
        config: of both controllers.
        states: see `states.random_states`.
        candidate: the controller under test.
        reference: what it is measured by.
        name: of the states, for the findings.
        tolerances: the acceptance's by default.

    Returns:
        A comparison with one entry.
    """
    judge, record = Judge(config, reference, tolerances), Record(name)
    candidate.reset()
    reference.reset()
    for state in states:
        if state.reset:
            candidate.reset()
            reference.reset()
        command = candidate.step(state.q, state.xdot, state.measurement)
        judgement = judge.judge(command, reference.step(state.q, state.xdot, state.measurement))
        tell(reference, command)
        record.add(state.measurement.time, judgement)
    return Comparison((record.comparison(),), judge.tolerances)
