"""Tasks that do nothing much, for processes of their own; run as a program, many slow ones."""

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from proxgen.errors import SimulationError
from proxgen.reproduce.pool import carry_out_all
from proxgen.reproduce.store import Store


@dataclass(frozen=True)
class Chore:
    """Keeps a number, after a while; or fails, or ends its process.

    Attributes:
        name: of its record.
        number: to be kept.
        seconds: how long it takes.
        harm: `error` or `death`.
    """

    name: str
    number: int = 0
    seconds: float = 0.0
    harm: str = ""

    @property
    def cost(self) -> float:
        """Like any other."""
        return 1.0

    def fingerprint(self) -> str:
        """Another number is another task."""
        return str(self.number)

    def carry_out(self, store: Store) -> None:
        """Do it."""
        time.sleep(self.seconds)
        if self.harm == "error":
            raise SimulationError("the world is closed")
        if self.harm == "death":
            os._exit(1)
        store.save(self.name, self.fingerprint(), {"number": self.number})


if __name__ == "__main__":
    chores = [Chore("first"), *(Chore(f"slow_{index}", seconds=60.0) for index in range(4))]
    carry_out_all(chores, Store(Path(sys.argv[1])), 2, lambda task: print(task.name, flush=True))
