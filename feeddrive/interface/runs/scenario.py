"""Runs of scenarios: an axis under its controller."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.files import find_scenario
from feeddrive.interface.axis import Axis, load
from feeddrive.interface.machine.check import UsedLife
from feeddrive.interface.servo import Servo, controller_entries
from feeddrive.interface.shown import Listing, Shown, finite, needed_pandas, write_figures, write_json
from feeddrive.metrology.evaluate import Evaluated, as_json, evaluate
from feeddrive.metrology.following import following
from feeddrive.metrology.run_metrics import run_metrics
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.recording import Recording
from feeddrive.servo.cascade import KV_UNIT
from feeddrive.servo.linear_loop import worst_eigenvalue
from feeddrive.simulate.driven import used_life
from feeddrive.simulate.scenario.scenario import SERIES, ScenarioResult
from feeddrive.simulate.scenario.scenario_file import GivenPlant, read_scenario
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
        path: of the scenario file.
    """

    result: ScenarioResult
    evaluated: tuple[Evaluated, ...]
    path: Path

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

    def life(self) -> UsedLife:
        """What the run takes of the life of each nut of the ball screw, and how often 90 % survive it.

        Raises:
            SimulationError: a motion that cannot be followed.
        """
        series, plant = self.result.series, self.result.scenario.plant
        used = used_life(plant, self.result.time, series["motor_angle"], series["cutting_force"])
        return UsedLife(self.result.scenario.name, self.result.time, used)

    def listing(self) -> Listing:
        """One row per number: following error, torque, and the figures that the scenario asks for."""
        found = run_metrics(self.result)
        rows = [
            [name, format_quantity(one.value, one.unit) if math.isfinite(one.value) else "never"]
            for name, one in found.items()
        ]
        records = [{"figure": name, "value": one.value, "unit": one.unit} for name, one in found.items()]
        life = self.life()
        if life.used is not None:
            rows += [[f"life, {nut}", text] for nut, text in life.listing().rows]
            records += life.listing().records
        title = f"{self.result.scenario.name}, {self.result.scenario.plant.name}"
        return Listing(title, ("figure", "value"), rows, records)

    def to_pandas(self) -> pandas.DataFrame:
        """The exact series as a DataFrame over the time [s]; columns SI, their unit in brackets.

        Raises:
            InputError: pandas is not installed.
        """
        columns = {f"{name} [{SERIES[name]}]": values for name, values in self.result.series.items()}
        pandas = needed_pandas()
        return pandas.DataFrame(columns, index=pandas.Index(self.result.time, name="time [s]"))

    def record(self) -> dict[str, Any]:
        """Everything that was found, plain values, SI."""
        result, scenario, cascade = self.result, self.result.scenario, self.result.scenario.cascade
        whole = following(result.series["setpoint"], result.series["table_position"])
        value, growth, frequency = worst_eigenvalue(scenario.plant, cascade, position=scenario.plant.middle)
        torque = result.series["motor_torque"]
        rate = 1 / cascade.sample_time
        return {
            "format": "feeddrive-run/1",
            "version": __version__,
            "scenario": str(self.path),
            "name": scenario.name,
            "plant": scenario.plant.name,
            "digest": scenario.digest,
            "duration": scenario.duration,
            "sample_time": scenario.sample_time,
            "samples": len(result.time),
            "controller": {
                "position_gain": {"1/s": cascade.position_gain, "(m/min)/mm": cascade.position_gain / KV_UNIT},
                "velocity_gain": {"N m s/rad": cascade.velocity_gain},
                "reset_time": {"s": finite(cascade.reset_time)},
                "rates": {"velocity Hz": rate, "position Hz": 1 / (cascade.sample_time * cascade.position_divider)},
                "slowest_eigenvalue": {"magnitude": abs(value), "growth 1/s": growth, "frequency Hz": frequency},
            },
            "following_error": {"rms": whole.rms, "maximum": whole.maximum, "mean": whole.mean},
            "motor_torque": {"rms": float((torque**2).mean() ** 0.5), "maximum": float(abs(torque).max())},
            "evaluations": self.figures,
        }

    def tables(self) -> tuple[Listing, ...]:
        """Following error and torque, then one table for each figure that the scenario asks for."""
        found = self.record()
        gain, error, torque = found["controller"]["position_gain"], found["following_error"], found["motor_torque"]
        closed = f"{gain['(m/min)/mm']:.4g} (m/min)/mm = {gain['1/s']:.4g} 1/s"
        rows = [
            ["duration", format_quantity(found["duration"], "s")],
            ["position gain K_v", closed if gain["1/s"] else "position loop open"],
            ["following error rms", format_quantity(error["rms"], "m")],
            ["following error maximum", format_quantity(error["maximum"], "m")],
            ["motor torque rms", format_quantity(torque["rms"], "N m")],
            ["motor torque maximum", format_quantity(torque["maximum"], "N m")],
        ]
        whole = Listing(f"{found['name']}, {found['plant']}", ("figure", "value"), rows)
        return (whole, *(figure_listing(one) for one in self.figures))

    def save(self, path: str | Path) -> Path:
        """Write the recording as CSV, or CSV.gz; into a folder also `metrics.json` and the figures.

        Raises:
            InputError: the file or folder cannot be written.
        """
        place = Path(path)
        if place.name.endswith((".csv", ".csv.gz")):
            write_recording(self.recording, place)
            return place
        write_recording(self.recording, place / "recording.csv")
        write_figures(self._figures(), place)
        write_json(self.record(), place / "metrics.json")
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_scenario import scenario_figures

        return list(scenario_figures(self.result, self.evaluated))


def run(
    scenario: str | Path,
    *,
    plant: Axis | str | Path | None = None,
    controller: Servo | str | Path | None = None,
    set: Mapping[str, str] | None = None,
    checkpoint: str | Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Run a scenario.

    Args:
        scenario: file, or the name of a shipped one, see `list_scenarios`.
        plant: in place of the scenario's.
        controller: in place of the scenario's: of `tune`, or a controller file.
        set: key as of `--set` to a value with its unit.
        checkpoint: file from which a stopped run goes on, and in which this one is kept while it runs.
        progress: called with the share that is done.

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
    path = find_scenario(str(scenario))
    read = read_scenario(path, wanted, given, entries)
    result = run_scenario(read, None if checkpoint is None else Path(checkpoint), progress)
    return Run(result, evaluate(result), path)


_LISTS = ("frequency", "magnitude", "phase", "coherence")
_SHOWN_POINTS = 12

_UNITS = {
    "m": "target overshoot deviation width displacement window rms maximum mean glitch radial_maximum radial_minimum "
    "stroke reversal",
    "s": "time rise settling average start end period at skip segment",
    "N m": "torque spread friction offset",
    "m/s": "velocity",
    "N": "force",
    "N/m": "stiffness",
    "J": "work",
    "rad": "lag",
}
"""SI unit to the keys that have it; others have none."""

_UNIT_OF = {key: unit for unit, keys in _UNITS.items() for key in keys.split()}


def figure_listing(one: dict[str, Any]) -> Listing:
    """The table of a figure.

    Args:
        one: plain values, as `feeddrive.metrology.evaluate.as_json` gives them.
    """
    title = one["kind"].replace("_", " ")
    if one["kind"] == "positioning":
        lengths = {key: value for key, value in one.items() if isinstance(value, float) and key != "average"}
        rows = [[key.replace("_", " "), format_quantity(value, "m")] for key, value in lengths.items()]
        return Listing(f"{title}, {one['standard']}", ("figure", "value"), rows)
    if "points" in one:
        keys = list(one["points"][0])
        rows = [[_shown(key, point[key]) for key in keys] for point in one["points"]]
        more = [["…"] + [""] * (len(keys) - 1)] if len(rows) > _SHOWN_POINTS else []
        return Listing(title, keys, rows[:_SHOWN_POINTS] + more)
    shown = {key: value for key, value in one.items() if key not in ("kind", *_LISTS)}
    rows = [[key.replace("_", " "), _shown(key, value, one)] for key, value in shown.items()]
    return Listing(title, ("figure", "value"), rows)


def _shown(key: str, value: Any, one: dict[str, Any] | None = None) -> str:
    if value is None:
        return {"time": "never", "settling": "not settled"}.get(key, "–")
    if isinstance(value, list):
        return ", ".join(_shown(key, item, one) for item in value)
    if isinstance(value, float):
        unit = SERIES[one["channel"]] if one is not None and key == "final" else _UNIT_OF.get(key, "1")
        if one is not None and one["kind"] == "step" and key == "overshoot":
            return f"{100 * value:.3g} %"
        return format_quantity(value, unit) if unit != "1" else f"{value:.5g}"
    return f"{value:+d}" if key == "direction" else str(value)
