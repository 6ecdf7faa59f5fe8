"""Work over processes: what is finished is kept whatever happens, and only what still fits is used again."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import made_up_tasks
import pytest
from made_up import make_log
from made_up_tasks import Chore

from proxgen.errors import ReproduceError, SimulationError
from proxgen.reproduce.pool import carry_out_all, cores
from proxgen.reproduce.store import Store, write_json


@pytest.fixture
def store(tmp_path: Path) -> Store:
    """An empty one."""
    return Store(tmp_path / "runs")


@pytest.mark.parametrize("workers", [1, 2])
def test_a_failure_is_named_and_the_rest_is_done(workers: int, store: Store) -> None:
    chores = [Chore("good", 1), Chore("bad", harm="error"), Chore("late", 2)]
    done: list[str] = []
    with pytest.raises(ReproduceError, match="1 of 3 tasks failed; what is finished is kept in") as caught:
        carry_out_all(chores, store, workers, lambda task: done.append(task.name))
    assert caught.value.failures == {"bad": "the world is closed"}
    assert str(caught.value).endswith("  bad: the world is closed")
    assert sorted(done) == ["good", "late"]
    assert [store.find(name, number) for name, number in (("good", "1"), ("late", "2"))] == [
        {"number": 1}, {"number": 2},
    ]  # fmt: skip


def test_a_process_that_dies_is_a_clear_error(store: Store) -> None:
    chores = [Chore("good", 1), Chore("dead", seconds=1.0, harm="death"), Chore("late", 2, seconds=3.0)]
    with pytest.raises(ReproduceError, match=r"dead: its process, or one beside it, ended unexpectedly"):
        carry_out_all(chores, store, 2)
    assert store.find("good", "1") == {"number": 1}


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_ends_all_processes_and_keeps_what_is_finished(
    ending: signal.Signals, tmp_path: Path
) -> None:
    program = [sys.executable, made_up_tasks.__file__, str(tmp_path)]
    paths = os.pathsep.join([str(Path(__file__).parents[2]), str(Path(made_up_tasks.__file__).parent)])
    process = subprocess.Popen(
        program,
        env=os.environ | {"PYTHONPATH": paths},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "first\n"
    if ending is signal.SIGINT:
        os.killpg(process.pid, ending)  # as a terminal does: to every process
    else:
        process.send_signal(ending)
    said = process.communicate(timeout=60)[1]
    assert process.returncode != 0
    assert said.count("KeyboardInterrupt") == 1  # the parent's alone
    _wait_until_gone(process.pid)
    assert [path.name for path in tmp_path.iterdir()] == ["first.json"]


def _wait_until_gone(group: int) -> None:
    """Return when no process of a group is left: Python's own helper ends a little after its parent."""
    for _ in range(600):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    raise AssertionError("a process is still there")


def test_what_does_not_fit_any_more_is_not_found(store: Store) -> None:
    store.save("run", "now", {"x": 1.0}, make_log())
    assert store.find("run", "now") == {"x": 1.0}
    assert store.log("run").cycles == make_log().cycles
    assert store.find("run", "before") is None
    assert store.find("other", "now") is None
    store.log_path("run").unlink()
    assert store.find("run", "now") is None


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"fingerprint": "now"}'])
def test_a_damaged_record_is_none(text: str, store: Store) -> None:
    store.save("run", "now", {"x": 1.0})
    (store.directory / "run.json").write_text(text)
    assert store.find("run", "now") is None


def test_nothing_half_written_is_left(store: Store, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        store.save("run", "now", {"x": float("nan")})
    assert list(store.directory.iterdir()) == []
    (store.directory / "run8.part").write_text("half")
    store.tidy()
    assert list(store.directory.iterdir()) == []
    write_json(tmp_path / "a" / "b.json", {"x": 1})
    assert json.loads((tmp_path / "a" / "b.json").read_text()) == {"x": 1}
    with pytest.raises(SimulationError, match="cannot write"):
        write_json(tmp_path / "a" / "b.json" / "c.json", {})
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["b.json"]


def test_all_cores_work() -> None:
    assert 1 <= cores() <= (os.cpu_count() or 1)
