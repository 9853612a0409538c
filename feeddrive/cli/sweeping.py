"""What `feeddrive sweep` does: read, run with a progress bar on a terminal, write, tell."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from feeddrive.cli.output import deliver, table, tell_written
from feeddrive.errors import InputError
from feeddrive.files import find_scenario, write_bytes_atomically, write_text_atomically
from feeddrive.metrology.run_metrics import run_metrics
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.file.entries import nearest
from feeddrive.simulate.scenario.scenario_overrides import parse_overrides
from feeddrive.simulate.sweep.sweep import Sweep, Told, run_sweep
from feeddrive.simulate.sweep.sweep_dask import on_cluster
from feeddrive.simulate.sweep.sweep_design import Design, make_design
from feeddrive.simulate.sweep.sweep_table import SweepRow, SweepTable, as_csv, as_json, as_text, main_metrics
from feeddrive.simulate.sweep.sweep_values import Parameter, Value, read_parameters
from feeddrive.simulate.sweep.sweep_workers import Workers, in_this_process, processes, usable_processors
from feeddrive.units.quantity import format_quantity

MOST_METRICS = 4
"""In the figure."""

MOST_WORKERS = 256
"""Processes of one computer, all of which are started at once; more is a slip of the hand."""


@dataclass(frozen=True)
class Wanted:
    """What was typed."""

    scenario: str
    vary: list[str]
    settings: list[str]
    samples: int | None
    seed: int
    workers: int | None
    scheduler: str
    metrics: list[str]
    as_json: bool
    out: Path | None


def sweep_and_tell(wanted: Wanted) -> None:
    """Run a sweep and show or write what it gives.

    Raises:
        InputError: unusable scenario, values, workers, metrics or folder, or a sweep of which every run failed.
    """
    if len(wanted.metrics) > MOST_METRICS:
        raise InputError(f"{len(wanted.metrics)} metrics", "--metric", f"choose up to {MOST_METRICS}")
    workers = _workers(wanted)
    refuse_unusable(wanted.out)
    parameters = read_parameters(wanted.vary)
    path = find_scenario(wanted.scenario).resolve()
    design = make_design(path, parse_overrides(wanted.settings), parameters, wanted.samples, wanted.seed)
    with TemporaryDirectory() as passing, _progress(path.stem) as told:
        sweep = _run(design, wanted, wanted.out or Path(passing), workers, told)
    _finish(sweep, wanted)


def _run(design: Design, wanted: Wanted, folder: Path, workers: Workers, told: Told | None) -> Sweep:
    try:
        return run_sweep(design, run_metrics, folder, workers, told, wanted.metrics)
    except KeyboardInterrupt:
        typer.echo("stopped; started again with the same --out it goes on", err=True)
        raise


def _workers(wanted: Wanted) -> Workers:
    if wanted.scheduler:
        if wanted.workers is not None:
            raise InputError("--workers and --scheduler are both given", "", "leave one of them out")
        return on_cluster(wanted.scheduler)
    count = usable_processors() if wanted.workers is None else wanted.workers
    if not 1 <= count <= MOST_WORKERS:
        raise InputError(
            f"{count} workers", "--workers", f"write 1 to {MOST_WORKERS}; a cluster is named by --scheduler"
        )
    return in_this_process if count == 1 else processes(count)


@contextmanager
def _progress(name: str) -> Iterator[Told | None]:
    """A bar on a terminal, nothing in a pipe."""
    if not sys.stderr.isatty():
        yield None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _finish(sweep: Sweep, wanted: Wanted) -> None:
    found, out = sweep.table, wanted.out
    shown = _metrics(found, wanted.metrics) if found.finished else []
    if out is not None:
        with output_folder(out) as folder:
            write_text_atomically(folder / "table.csv", as_csv(found))
            write_text_atomically(folder / "results.json", as_text(as_json(sweep.design, found)))
            if found.finished:
                _draw(sweep, shown, folder)
    if not found.finished:
        raise InputError(
            f"all {len(found.rows)} runs failed, the first: {found.rows[0].reason}", str(sweep.design.path)
        )
    tables = [] if wanted.as_json else _tables(sweep, shown)
    deliver(as_json(sweep.design, found), tables, wanted.as_json, None)
    tell_written(out, wanted.as_json)


def _metrics(found: SweepTable, names: list[str]) -> list[str]:
    for name in names:
        if name not in found.units:
            raise InputError(f'no metric "{name}"', "--metric", nearest(name, found.units))
    return list(dict.fromkeys(names)) or main_metrics(found, MOST_METRICS)


def _draw(sweep: Sweep, shown: list[str], out: Path) -> None:
    from feeddrive.report.figures.drawing import render
    from feeddrive.report.figures.figure_sweep import sweep_figure

    write_bytes_atomically(out / "sweep.png", render(sweep_figure(sweep.design.path.stem, sweep.table, shown)).png)


def _tables(sweep: Sweep, shown: list[str]) -> list[Table]:
    found = sweep.table
    failed = len(found.rows) - len(found.finished)
    rows = [["runs", str(len(found.rows))]]
    rows += [["of these from an earlier start", str(sweep.resumed)]] if sweep.resumed else []
    rows += [["failed", f"{failed}, the first: {_first_reason(found)}"]] if failed else []
    rows += [[one.key, _range(one, found, place)] for place, one in enumerate(found.parameters)]
    extremes = [_extremes(found, name) for name in shown]
    headings = ("metric", "smallest", "at", "largest", "at")
    return [table(f"sweep of {sweep.design.path.stem}", ("", ""), rows), table("extremes", headings, extremes)]


def _first_reason(found: SweepTable) -> str:
    return next(row.reason for row in found.rows if row.reason)


def _range(one: Parameter, found: SweepTable, place: int) -> str:
    values = list(dict.fromkeys(row.values[place] for row in found.rows))
    if one.random or len(values) > 6:
        spread = f"{_with_unit(one, one.values[0])} to {_with_unit(one, one.values[-1])}"
        return f"{spread}, {len(values)} {'random ' if one.random else ''}values"
    return ", ".join(_with_unit(one, value) for value in values)


def _with_unit(one: Parameter, value: Value) -> str:
    shown = value if isinstance(value, str) else f"{value:.6g}"
    return f"{shown} {one.unit}" if one.unit not in ("", "1") else shown


def _extremes(found: SweepTable, name: str) -> list[str]:
    """Smallest and largest value of a metric, and where; a time that never comes is the largest."""
    known = [(row, row.metrics.get(name)) for row in found.finished]
    numbers = [(value, row) for row, value in known if value is not None]
    never = [row for row, value in known if value is None]
    unit, cells = found.units[name], [name]
    if not numbers:
        return [name, "never", "", "never", ""]
    smallest, largest = (pick(numbers, key=lambda pair: pair[0]) for pick in (min, max))
    cells += [format_quantity(smallest[0], unit), _place(found, smallest[1])]
    if never:
        return [*cells, f"never, {len(never)} runs", _place(found, never[0])]
    return [*cells, format_quantity(largest[0], unit), _place(found, largest[1])]


def _place(found: SweepTable, row: SweepRow) -> str:
    return ", ".join(_with_unit(one, value) for one, value in zip(found.parameters, row.values, strict=True))
