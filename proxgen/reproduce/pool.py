"""Many tasks over all cores: results as they come, and nothing finished is lost, whatever happens."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager

from proxgen.errors import ProxgenError, ReproduceError
from proxgen.reproduce.store import Store
from proxgen.reproduce.tasks import Task

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def cores() -> int:
    """How many processes may work at a time."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def carry_out_all(
    tasks: Sequence[Task], store: Store, workers: int, on_done: Callable[[Task], None] | None = None
) -> None:
    """Do all tasks, each in some process; with one worker in this one.

    Args:
        tasks: in the order in which they are begun.
        store: where each keeps its result.
        workers: processes.
        on_done: called in this process when a task is done.

    Raises:
        ReproduceError: some tasks failed; all others are done, and kept.
    """
    done = on_done or (lambda task: None)
    failures: dict[str, str] = {}
    try:
        if workers == 1 or len(tasks) < 2:
            for task in tasks:
                _note(task, lambda task=task: task.carry_out(store), failures, done)  # type: ignore[misc]
        else:
            _in_processes(tasks, store, min(workers, len(tasks)), failures, done)
    finally:
        store.tidy()
    if failures:
        kept = f"what is finished is kept in {store.directory}, and the same command continues from there"
        raise ReproduceError(f"{len(failures)} of {len(tasks)} tasks failed; {kept}", failures)


def _in_processes(
    tasks: Sequence[Task],
    store: Store,
    workers: int,
    failures: dict[str, str],
    done: Callable[[Task], None],
) -> None:
    """Hand the tasks to processes of their own; an interruption ends these at once."""
    context = multiprocessing.get_context("spawn")  # pybullet and Pinocchio do not survive a fork unharmed
    with _one_thread_each(), _interrupted_by_sigterm():
        pool = ProcessPoolExecutor(workers, mp_context=context)
        try:
            with _deaf_to_interrupts():  # what is started now stays so
                futures: dict[Future[None], Task] = {pool.submit(_carry_out, t, store): t for t in tasks}
            for future in as_completed(futures):
                _note(futures[future], future.result, failures, done)
            pool.shutdown()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                process.terminate()
                process.join()
            raise


def _note(
    task: Task, result: Callable[[], None], failures: dict[str, str], done: Callable[[Task], None]
) -> None:
    """Take the result of a task: done, or why not."""
    try:
        result()
    except BrokenProcessPool:
        failures[task.name] = "its process, or one beside it, ended unexpectedly (out of memory?)"
    except (ProxgenError, OSError) as error:
        failures[task.name] = str(error)
    else:
        done(task)


def _carry_out(task: Task, store: Store) -> None:
    """In a process of the pool."""
    task.carry_out(store)


@contextmanager
def _interrupted_by_sigterm() -> Iterator[None]:
    """SIGTERM is an interruption like Ctrl-C: it ends all processes that were started, too."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Ctrl-C reaches every process of a terminal; those that are started meanwhile leave it to the parent."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes that are started meanwhile do linear algebra in one thread: there is one for each core."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
