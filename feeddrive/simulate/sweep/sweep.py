"""Sweeps: many runs of a scenario with varied values, by several workers, resumed where they were stopped."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically
from feeddrive.schema.toml_text import nearest
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.simulate.controlled.controlled import TorqueLoop, resting_state
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.sweep.sweep_design import Design
from feeddrive.simulate.sweep.sweep_store import Cut, read_cut, read_units, unit_path, write_cut
from feeddrive.simulate.sweep.sweep_table import SweepTable, table_of
from feeddrive.simulate.sweep.sweep_unit import Measure, finished_runs, run_unit, unit_task
from feeddrive.simulate.sweep.sweep_workers import Unit, Workers

UNIT_TIME = 0.5
"""Seconds of work in a unit, about: what is lost where a worker is killed."""

_FEWEST_UNITS = 16
"""Fewest units of a sweep that has so many runs, so that workers end together."""

_UNTIMED = 4
"""Runs of a unit where the first run failed, so that its time says nothing."""

Progress = Callable[[int, int], None]
"""Called with the runs that are done, and all."""


@dataclass(frozen=True)
class Sweep:
    """A finished sweep.

    Attributes:
        design: what was run.
        table: what it gave.
        resumed: runs that were there from an earlier start.
    """

    design: Design
    table: SweepTable
    resumed: int


def run_sweep(
    design: Design,
    measure: Measure,
    folder: Path,
    workers: Workers,
    progress: Progress | None = None,
    needed: Sequence[str] = (),
) -> Sweep:
    """All runs of a sweep, or those that an earlier start has left.

    Args:
        design: what is run.
        measure: what is taken from each run.
        folder: for the units; that of an earlier start of the same sweep is gone on with.
        workers: `in_this_process`, `processes(n)` or `on_cluster(address)`; the results are the same, bit for bit.
        progress: called as runs end.
        needed: metrics that must be among those of the first run, if that finishes.

    Raises:
        InputError: a metric that the runs do not give, a folder of another sweep, files that change while the sweep
            runs, workers that cannot be reached or were ended.
    """
    cut, total = read_cut(folder, design), len(design.rows)
    there = {} if cut is None else read_units(folder, design, cut)
    resumed = sum(len(runs) for runs in there.values())
    if progress is not None:
        progress(resumed, total)
    if cut is None or len(there) < cut.units:
        with workers(measure) as work:
            if cut is None:
                cut = _begin(design, measure, folder)
                there = read_units(folder, design, cut)
            _refuse_missing(needed, there.get(0, []))
            left = [unit for unit in range(cut.units) if unit not in there]
            units = [Unit(unit_task(design, *cut.span(unit), measure), unit_path(folder, unit)) for unit in left]
            done = sum(len(runs) for runs in there.values())
            for count in work(units):
                done += count
                if progress is not None:
                    progress(done, total)
    found = read_units(folder, design, cut)
    return Sweep(design, table_of(design, [run for unit in range(cut.units) for run in found[unit]]), resumed)


def _refuse_missing(needed: Sequence[str], runs: Sequence[Mapping[str, Any]]) -> None:
    for run in runs:
        for name in needed:
            if not run["reason"] and name not in run["metrics"]:
                raise InputError(f'no metric "{name}"', "--metric", nearest(name, run["metrics"]))


def _begin(design: Design, measure: Measure, folder: Path) -> Cut:
    """Do the first run here: it makes the compiled machine, which other processes then find, and times a run."""
    scenario = read_scenario(design.path, {**design.overrides(design.rows[0]), "controller.allow_unstable": "true"})
    with suppress(InputError):  # if the first run cannot be begun its row will say so
        loop = TorqueLoop(scenario.cascade.current_lag, scenario.cascade.dead_time)
        resting_state(scenario.plant, cascade_controller(scenario.cascade), loop)
    begun = clock.perf_counter()
    text = run_unit(unit_task(design, 0, 1, measure))
    size = round(UNIT_TIME / (clock.perf_counter() - begun)) if finished_runs(text) else _UNTIMED
    cut = Cut(len(design.rows), max(1, min(size, len(design.rows) // _FEWEST_UNITS)))
    write_cut(folder, design, cut)
    write_text_atomically(unit_path(folder, 0), text)
    return cut
