"""Sweeps: many runs of a scenario with varied values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from feeddrive.errors import InputError
from feeddrive.files import find_scenario
from feeddrive.interface.axis import Axis
from feeddrive.interface.shown import Listing, Shown
from feeddrive.metrology.run_metrics import run_metrics
from feeddrive.simulate.sweep.sweep import Sweep as FinishedSweep
from feeddrive.simulate.sweep.sweep import run_sweep
from feeddrive.simulate.sweep.sweep_design import make_design
from feeddrive.simulate.sweep.sweep_table import main_metrics
from feeddrive.simulate.sweep.sweep_values import read_parameters
from feeddrive.simulate.sweep.sweep_workers import in_this_process, processes
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

MOST_METRICS = 4
"""In the table and the figure; `to_pandas` has all."""


@dataclass(frozen=True, repr=False, eq=False)
class Sweep(Shown):
    """A finished sweep.

    Attributes:
        sweep: design and table, one row per run.
    """

    sweep: FinishedSweep

    @property
    def metrics(self) -> tuple[str, ...]:
        """Names of everything that was taken from the runs."""
        return tuple(self.sweep.table.units)

    def listing(self) -> Listing:
        """One row per run: varied values, then the metrics that tell most."""
        found = self.sweep.table
        shown = main_metrics(found, MOST_METRICS)
        headings = [*(one.key for one in found.parameters), *shown, "remark"]
        rows = [
            [*map(str, row.values), *(_cell(row.metrics.get(name), found.units[name]) for name in shown), row.reason]
            for row in found.rows
        ]
        varied = [f"{one.key} [{one.unit}]" if one.unit not in ("", "1") else one.key for one in found.parameters]
        records = [
            {**dict(zip(varied, row.values, strict=True)),
             **{f"{name} [{unit}]": row.metrics.get(name) for name, unit in found.units.items()},
             "failed": row.reason or None}
            for row in found.rows
        ]  # fmt: skip
        return Listing(f"sweep of {self.sweep.design.path.stem}, {len(found.rows)} runs", headings, rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_sweep import sweep_figure

        found = self.sweep.table
        return (sweep_figure(self.sweep.design.path.stem, found, main_metrics(found, MOST_METRICS)),)


def sweep(
    scenario: str | Path,
    *,
    vary: Mapping[str, str | Sequence[str]],
    plant: Axis | str | Path | None = None,
    set: Mapping[str, str] | None = None,
    samples: int | None = None,
    seed: int = 0,
    workers: int = 1,
) -> Sweep:
    """Run a scenario over varied values.

    Args:
        scenario: file, or the name of a shipped one.
        vary: key as of `--set` to "first:last:points unit", "v1,v2,v3 unit", a list of values, or "low~high unit".
        plant: in place of the scenario's; an axis with added effects is saved first.
        set: values for all runs.
        samples: of the random ranges low~high; None where there are none.
        seed: of the random ranges.
        workers: processes of this computer; a script that asks for more than one needs `if __name__ == "__main__":`.

    Raises:
        InputError: a scenario, key or value that cannot be used, or every run failed.

    >>> import feeddrive as fd
    >>> found = fd.sweep("step_position", vary={"controller.position_gain": "40:60:2 1/s"})
    >>> len(found.sweep.table.rows)
    2
    """
    settings = {**_of_plant(plant), **dict(set or {})}
    texts = [f"{key}={one if isinstance(one, str) else ','.join(map(str, one))}" for key, one in vary.items()]
    if workers < 1:
        raise InputError(f"{workers} workers", "workers", "write 1 or more")
    path = find_scenario(str(scenario)).resolve()
    design = make_design(path, settings, read_parameters(texts), samples, seed)
    with TemporaryDirectory() as folder:
        found = run_sweep(design, run_metrics, Path(folder), in_this_process if workers == 1 else processes(workers))
    if not found.table.finished:
        count, reason = len(found.table.rows), found.table.rows[0].reason
        raise InputError(f"all {count} runs failed, the first: {reason}", str(path))
    return Sweep(found)


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
