"""Who does the units of a sweep: this process, several processes, or a Dask cluster. All give the same.

Processes come from a server that has imported what they need and has no threads, so that none is copied half-way; each
has one thread of linear algebra. A worker writes its unit itself: where the main process is killed, workers finish the
unit in hand, write it and end.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait
from pathlib import Path

from feeddrive.blas_threads import VARIABLES, one_thread_from_now_on
from feeddrive.errors import InputError
from feeddrive.simulate.sweep.sweep_unit import Measure, UnitTask, write_unit


@dataclass(frozen=True)
class Unit:
    """What a worker is to do, and the file for what it gives."""

    task: UnitTask
    path: Path


Work = Callable[[Sequence[Unit]], Iterator[int]]
"""Does units, in any order; tells the number of runs of each as it is finished and written."""

Workers = Callable[[Measure], AbstractContextManager[Work]]
"""Opens workers for a measure; on leaving they are let go."""


@contextmanager
def in_this_process(_: Measure) -> Iterator[Work]:
    """One unit after the other."""

    def work(units: Sequence[Unit]) -> Iterator[int]:
        for unit in units:
            write_unit(unit.task, unit.path)
            yield len(unit.task.overrides)

    yield work


def usable_processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def processes(count: int) -> Workers:
    """Several processes of this computer.

    Args:
        count: how many.
    """

    @contextmanager
    def opened(measure: Measure) -> Iterator[Work]:
        with _one_thread_each():
            executor = ProcessPoolExecutor(count, _context(measure), _begin)
            for _ in range(count):  # they start while the main process still prepares
                executor.submit(os.getpid)
        try:
            yield lambda units: _as_finished(executor, units)
        finally:
            executor.shutdown(wait=True, cancel_futures=True)

    return opened


def _as_finished(executor: ProcessPoolExecutor, units: Sequence[Unit]) -> Iterator[int]:
    try:
        pending: dict[Future[None], int] = {executor.submit(_write, unit): len(unit.task.overrides) for unit in units}
        for done in as_completed(list(pending)):
            done.result()
            yield pending.pop(done)
    except BrokenProcessPool:
        mend = "start again with the same --out, perhaps with fewer --workers; what is finished is kept"
        raise InputError("a worker process was ended, perhaps for want of memory", "sweep", mend) from None


def _context(measure: Measure) -> multiprocessing.context.BaseContext:
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__, measure.__module__])
    return context


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """The environment that new processes inherit."""
    before = {name: os.environ.get(name) for name in VARIABLES}
    one_thread_from_now_on()
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


_IDLE = threading.Lock()
"""Held by a worker while it does a unit."""


def _write(unit: Unit) -> None:
    with _IDLE:
        write_unit(unit.task, unit.path)


def _begin() -> None:
    """In a new worker: Ctrl-C is the main process's business; end when that has ended, after the unit in hand."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        with _IDLE:
            os._exit(0)
