"""Runs of scenarios: an axis under its controller."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.errors import InputError
from feeddrive.files import find_scenario
from feeddrive.interface.axis import Axis, load
from feeddrive.interface.servo import Servo, controller_entries
from feeddrive.interface.shown import Listing, Shown, needed_pandas
from feeddrive.metrology.evaluate import Evaluated, as_json, evaluate
from feeddrive.metrology.run_metrics import run_metrics
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.recording import Recording
from feeddrive.simulate.scenario.scenario_file import GivenPlant, read_scenario
from feeddrive.simulate.scenario.scenario_result import SERIES, ScenarioResult
from feeddrive.simulate.scenario.scenario_run import run_scenario
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    import pandas

    from feeddrive.report.figures.drawing import ReportFigure

_PLANT = "plant."


@dataclass(frozen=True, repr=False, eq=False)
class Run(Shown):
    """A finished run of a scenario.

    Attributes:
        result: the run: scenario, recording, exact series.
        evaluated: the figures that the scenario asks for.
    """

    result: ScenarioResult
    evaluated: tuple[Evaluated, ...]

    @property
    def recording(self) -> Recording:
        """Channels as sensors would write them; `diagnose` takes it."""
        return self.result.recording

    def __getitem__(self, name: str) -> np.ndarray:
        """Exact samples of a series, shape (n,), SI: "time", "table_position", "motor_torque", ...

        Raises:
            InputError: no such series; names those there are.
        """
        if name == "time":
            return self.result.time
        if name not in self.result.series:
            raise InputError(
                f'no series "{name}"', self.result.scenario.name, f"it has {', '.join(self.result.series)}"
            )
        return self.result.series[name]

    @property
    def figures(self) -> list[dict[str, Any]]:
        """What the scenario asks for (settling, circular deviation, ...), plain values, SI."""
        return [as_json(one) for one in self.evaluated]

    @property
    def metrics(self) -> dict[str, float]:
        """Every single number of the run by its name, SI; infinite for a time that never comes."""
        return {name: one.value for name, one in run_metrics(self.result).items()}

    def listing(self) -> Listing:
        """One row per number: following error, torque, and the figures that the scenario asks for."""
        found = run_metrics(self.result)
        rows = [
            [name, format_quantity(one.value, one.unit) if math.isfinite(one.value) else "never"]
            for name, one in found.items()
        ]
        records = [{"figure": name, "value": one.value, "unit": one.unit} for name, one in found.items()]
        title = f"{self.result.scenario.name}, {self.result.scenario.plant.name}"
        return Listing(title, ("figure", "quantity"), rows, records)

    def to_pandas(self) -> pandas.DataFrame:
        """The exact series as a DataFrame over the time [s]; columns SI, their unit in brackets.

        Raises:
            InputError: pandas is not installed.
        """
        columns = {f"{name} [{SERIES[name]}]": values for name, values in self.result.series.items()}
        pandas = needed_pandas()
        return pandas.DataFrame(columns, index=pandas.Index(self.result.time, name="time [s]"))

    def save(self, path: str | Path) -> Path:
        """Write the recording as CSV, or CSV.gz.

        Raises:
            InputError: the file cannot be written.
        """
        write_recording(self.recording, Path(path))
        return Path(path)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_scenario import scenario_figures

        return list(scenario_figures(self.result, self.evaluated))


def run(
    scenario: str | Path,
    *,
    plant: Axis | str | Path | None = None,
    controller: Servo | str | Path | None = None,
    set: Mapping[str, str] | None = None,
) -> Run:
    """Run a scenario.

    Args:
        scenario: file, or the name of a shipped one, see `list_scenarios`.
        plant: in place of the scenario's.
        controller: in place of the scenario's: of `tune`, or a controller file.
        set: key as of `--set` to a value with its unit.

    Raises:
        InputError: a scenario, plant, controller or value that cannot be used, or a loop that is unstable.

    >>> import feeddrive as fd
    >>> moved = fd.run("step_position", set={"trajectory.duration": "0.3 s"})
    >>> bool(moved["table_position"][-1] > 0)
    True
    """
    wanted = dict(set or {})
    given = None
    if plant is not None:
        axis = plant if isinstance(plant, Axis) else load(plant)
        of_plant = {key.removeprefix(_PLANT): wanted.pop(key) for key in list(wanted) if key.startswith(_PLANT)}
        axis = axis.with_values(of_plant) if of_plant else axis
        given = GivenPlant(axis.plant, repr((axis.text, axis.values, axis.added)).encode())
    entries = None if controller is None else controller_entries(controller)
    read = read_scenario(find_scenario(str(scenario)), wanted, given, entries)
    result = run_scenario(read)
    return Run(result, evaluate(result))
