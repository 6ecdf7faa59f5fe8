"""Films of some runs for the page: a task each, as everything else, whose record holds the film itself."""

from base64 import b64decode, b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from proxgen.builder.sources import digest, digest_files
from proxgen.config import load
from proxgen.reproduce.plan import Plan
from proxgen.reproduce.store import Numbers, Store
from proxgen.reproduce.tasks import PACKAGE, Rollout, Task

END = 18.0
"""What follows looks like what was before [s]."""

PICTURES = 60
SIZE = (480, 360)
"""Width and height [pixels]."""


@dataclass(frozen=True)
class Filming:
    """The film of a run that is done.

    Attributes:
        run: whose log is rendered.
    """

    run: Rollout

    @property
    def name(self) -> str:
        """Of its record."""
        return f"film-{self.run.experiment.name}"

    @property
    def cost(self) -> float:
        """About how long it takes, in simulated seconds."""
        return 250.0

    def fingerprint(self) -> str:
        """Digest of everything that the film depends on."""
        return digest([self.run.fingerprint(), _renderer(), [END, PICTURES, *SIZE]])

    def carry_out(self, store: Store) -> None:
        """Render it, and keep it."""
        from proxgen.model import build_model
        from proxgen.report.film import write_film

        model = build_model(load(self.run.configuration))
        with TemporaryDirectory() as folder:
            path = Path(folder) / "film.webp"
            write_film(path, store.log(self.run.name), model, end=END, pictures=PICTURES, size=SIZE)
            film = b64encode(path.read_bytes()).decode("ascii")
        store.save(self.name, self.fingerprint(), {"experiment": self.run.experiment.name, "webp": film})


def films_of(plan: Plan, tasks: Sequence[Task]) -> list[Filming]:
    """The films of a plan: the first start of each experiment that it names."""
    runs = {task.name: task for task in tasks if isinstance(task, Rollout)}
    return [Filming(runs[f"{name}-{plan.starts[0]}"]) for name in plan.films]


def film_in(record: Numbers) -> bytes:
    """The film that a record holds, a WebP."""
    return b64decode(record["webp"])


@cache
def _renderer() -> str:
    """Digest of what renders."""
    return digest_files(sorted((PACKAGE / "report").glob("*.py")))
