"""Sweeps: many runs of a scenario with varied values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from feeddrive.errors import InputError
from feeddrive.files import find_scenario, write_text_atomically
from feeddrive.interface.axis import Axis
from feeddrive.interface.shown import Listing, Shown, write_figures
from feeddrive.metrology.run_metrics import run_metrics
from feeddrive.output_folder import output_folder
from feeddrive.schema.toml_text import nearest
from feeddrive.simulate.sweep.sweep import Sweep as FinishedSweep
from feeddrive.simulate.sweep.sweep import run_sweep
from feeddrive.simulate.sweep.sweep_dask import on_cluster
from feeddrive.simulate.sweep.sweep_design import make_design
from feeddrive.simulate.sweep.sweep_table import SweepRow, SweepTable, as_csv, as_json, as_text, main_metrics
from feeddrive.simulate.sweep.sweep_values import Parameter, Value, read_parameters
from feeddrive.simulate.sweep.sweep_workers import Workers, in_this_process, processes, usable_processors
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

MOST_METRICS = 4
"""In the table and the figure; `to_pandas` has all."""

MOST_WORKERS = 256
"""Processes of one computer, all of which are started at once; more is a slip of the hand."""


@dataclass(frozen=True, repr=False, eq=False)
class Sweep(Shown):
    """A finished sweep.

    Attributes:
        sweep: design and table, one row per run.
        shown: metrics in the table and the figure.
    """

    sweep: FinishedSweep
    shown: tuple[str, ...]

    @property
    def metrics(self) -> tuple[str, ...]:
        """Names of everything that was taken from the runs."""
        return tuple(self.sweep.table.units)

    def listing(self) -> Listing:
        """One row per run: varied values, then the metrics that are shown."""
        found = self.sweep.table
        headings = [*(one.key for one in found.parameters), *self.shown, "remark"]
        rows = [
            [*map(str, row.values), *(_cell(row.metrics.get(one), found.units[one]) for one in self.shown), row.reason]
            for row in found.rows
        ]
        varied = [f"{one.key} [{one.unit}]" if one.unit not in ("", "1") else one.key for one in found.parameters]
        records = [
            {
                **dict(zip(varied, row.values, strict=True)),
                **{f"{name} [{unit}]": row.metrics.get(name) for name, unit in found.units.items()},
                "failed": row.reason or None,
            }
            for row in found.rows
        ]
        return Listing(f"sweep of {self._name}, {len(found.rows)} runs", headings, rows, records)

    def tables(self) -> tuple[Listing, ...]:
        """What was varied, and the extremes of the metrics that are shown."""
        found = self.sweep.table
        failed = [row.reason for row in found.rows if row.reason]
        rows = [["runs", str(len(found.rows))]]
        rows += [["of these from an earlier start", str(self.sweep.resumed)]] if self.sweep.resumed else []
        rows += [["failed", f"{len(failed)}, the first: {failed[0]}"]] if failed else []
        rows += [[one.key, _range(one, found, place)] for place, one in enumerate(found.parameters)]
        headings = ("metric", "smallest", "at", "largest", "at")
        extremes = [_extremes(found, name) for name in self.shown]
        return Listing(f"sweep of {self._name}", ("", ""), rows), Listing("extremes", headings, extremes)

    def record(self) -> dict[str, Any]:
        """Design and table as plain values."""
        return as_json(self.sweep.design, self.sweep.table)

    def save(self, folder: str | Path) -> Path:
        """Write `table.csv`, `results.json` and the figure.

        Raises:
            InputError: the folder cannot be written.
        """
        place = Path(folder)
        _write_table(self.sweep, place)
        write_figures(self._figures(), place)
        return place

    @property
    def _name(self) -> str:
        return self.sweep.design.path.stem

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_sweep import sweep_figure

        return (sweep_figure(self._name, self.sweep.table, self.shown),)


def sweep(
    scenario: str | Path,
    *,
    vary: Mapping[str, str | Sequence[str]] | Sequence[str],
    plant: Axis | str | Path | None = None,
    set: Mapping[str, str] | None = None,
    samples: int | None = None,
    seed: int = 0,
    workers: int | None = 1,
    scheduler: str = "",
    metrics: Sequence[str] = (),
    folder: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sweep:
    """Run a scenario over varied values.

    Args:
        scenario: file, or the name of a shipped one.
        vary: key as of `--set` to "first:last:points unit", "v1,v2,v3 unit", a list of values, or "low~high unit"; or
            texts "key=values".
        plant: in place of the scenario's; an axis with added effects is saved first.
        set: values for all runs.
        samples: of the random ranges low~high; None where there are none.
        seed: of the random ranges.
        workers: processes of this computer, all processors for None; a script that asks for more than one needs
            `if __name__ == "__main__":`.
        scheduler: address of a Dask scheduler, "tcp://host:8786", in place of workers.
        metrics: shown in the table and the figure, up to four; those that vary most if left out.
        folder: where finished runs are kept, so that a stopped sweep goes on.
        progress: called with the number of runs that are done, and of all.

    Raises:
        InputError: a scenario, key or value that cannot be used, or every run failed.

    >>> import feeddrive as fd
    >>> found = fd.sweep("step_position", vary={"controller.position_gain": "40:60:2 1/s"})
    >>> len(found.sweep.table.rows)
    2
    """
    if len(metrics) > MOST_METRICS:
        raise InputError(f"{len(metrics)} metrics", "metrics", f"choose up to {MOST_METRICS}")
    settings = {**_of_plant(plant), **dict(set or {})}
    texts = _texts(vary) if isinstance(vary, Mapping) else list(vary)
    at_work = _workers(workers, scheduler)
    parameters = read_parameters(texts)
    path = find_scenario(str(scenario)).resolve()
    design = make_design(path, settings, parameters, samples, seed)
    with TemporaryDirectory() as passing:
        found = run_sweep(design, run_metrics, Path(folder or passing), at_work, progress, list(metrics))
    table = found.table
    if not table.finished:
        if folder is not None:
            with output_folder(Path(folder)) as place:
                _write_table(found, place)
        raise InputError(f"all {len(table.rows)} runs failed, the first: {table.rows[0].reason}", str(path))
    for name in metrics:
        if name not in table.units:
            raise InputError(f'no metric "{name}"', "metrics", nearest(name, table.units))
    return Sweep(found, tuple(dict.fromkeys(metrics)) or tuple(main_metrics(table, MOST_METRICS)))


def _texts(vary: Mapping[str, str | Sequence[str]]) -> list[str]:
    return [f"{key}={one if isinstance(one, str) else ','.join(map(str, one))}" for key, one in vary.items()]


def _workers(workers: int | None, scheduler: str) -> Workers:
    if scheduler:
        if workers not in (None, 1):
            raise InputError("workers and a scheduler are both given", "workers", "leave one of them out")
        return on_cluster(scheduler)
    count = usable_processors() if workers is None else workers
    if not 1 <= count <= MOST_WORKERS:
        mend = f"write 1 to {MOST_WORKERS}; a cluster is named by its scheduler"
        raise InputError(f"{count} workers", "workers", mend)
    return in_this_process if count == 1 else processes(count)


def _write_table(found: FinishedSweep, place: Path) -> None:
    write_text_atomically(place / "table.csv", as_csv(found.table))
    write_text_atomically(place / "results.json", as_text(as_json(found.design, found.table)))


def _of_plant(plant: Axis | str | Path | None) -> dict[str, str]:
    """The plant as settings, which every process of the sweep reads by itself."""
    if plant is None:
        return {}
    if not isinstance(plant, Axis):
        return {"plant": str(plant)}
    if plant.added:
        names = ", ".join(one.name for one in plant.added)
        raise InputError(f"{names} were added to the axis", "plant", "give the path that axis.save(...) returns")
    return {"plant": str(plant.path.resolve()), **{f"plant.{key}": value for key, value in plant.values}}


def _cell(value: float | None, unit: str) -> str:
    return "never" if value is None else format_quantity(value, unit)


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
    if not numbers:
        return [name, "never", "", "never", ""]
    (least, at_least), (most, at_most) = (pick(numbers, key=lambda pair: pair[0]) for pick in (min, max))
    cells = [name, format_quantity(least, found.units[name]), _place(found, at_least)]
    if never:
        return [*cells, f"never, {len(never)} runs", _place(found, never[0])]
    return [*cells, format_quantity(most, found.units[name]), _place(found, at_most)]


def _place(found: SweepTable, row: SweepRow) -> str:
    return ", ".join(_with_unit(one, value) for one, value in zip(found.parameters, row.values, strict=True))
