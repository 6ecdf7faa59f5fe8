"""Films of runs as tasks: which, when they are made anew, and that a record holds a film."""

from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from made_up import BOX, make_log
from PIL import Image

from proxgen.reproduce import films
from proxgen.reproduce.films import Filming, film_in, films_of
from proxgen.reproduce.plan import FILMED, Plan, Setup, full_plan
from proxgen.reproduce.store import Store
from proxgen.reproduce.tasks import tasks_of


@pytest.fixture
def plan() -> Plan:
    """A plan whose second start is its first."""
    return replace(full_plan(), starts=(2, 1))


def filming(plan: Plan) -> list[Filming]:
    """Its films; where controllers are built does not matter here."""
    return films_of(plan, tasks_of(plan, dict.fromkeys([*plan.setups, Setup()], Path("build"))))


def test_a_film_is_of_the_first_start(plan: Plan) -> None:
    assert [film.name for film in filming(plan)] == [f"film-{name}" for name in FILMED]
    assert [film.run.name for film in filming(plan)] == [f"{name}-2" for name in FILMED]
    assert filming(replace(plan, films=())) == []


def test_a_film_is_made_anew_with_its_run(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    first, *others = (film.fingerprint() for film in filming(plan))
    assert first not in others
    assert first == filming(plan)[0].fingerprint()
    assert first != filming(replace(plan, duration=59.0))[0].fingerprint()
    monkeypatch.setattr(films, "PICTURES", 61)
    assert first != filming(plan)[0].fingerprint()


def test_the_record_holds_the_film(plan: Plan, tmp_path: Path) -> None:
    film, store = filming(plan)[0], Store(tmp_path)
    log = make_log(7, 3, 20, obstacles=[BOX])
    log = replace(log, tof_range=np.ones((20, 32)), capacitive=np.zeros((20, 32), dtype=bool))
    store.save(film.run.name, "now", {}, log)
    film.carry_out(store)
    record = store.find(film.name, film.fingerprint())
    assert record is not None
    with Image.open(BytesIO(film_in(record))) as picture:
        assert (picture.format, picture.size) == ("WEBP", films.SIZE)
    assert store.find(film.name, "another") is None
