"""What `feeddrive run` does: read, run with a progress bar on a terminal, write, tell."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from feeddrive import __version__
from feeddrive.cli.output import deliver, table, tell_written, warnings_as_lines
from feeddrive.files import find_scenario, write_bytes_atomically, write_text_atomically
from feeddrive.metrology.evaluate import Evaluated, as_json, evaluate
from feeddrive.metrology.following import following
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.recording.files.writing import write_recording
from feeddrive.servo.cascade import KV_UNIT
from feeddrive.servo.linear_loop import worst_eigenvalue
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_overrides import parse_overrides
from feeddrive.simulate.scenario.scenario_result import SERIES, ScenarioResult
from feeddrive.simulate.scenario.scenario_run import Progress as Told
from feeddrive.simulate.scenario.scenario_run import run_scenario
from feeddrive.units.quantity import format_quantity

FORMAT = "feeddrive-run/1"
CHECKPOINT = "checkpoint.npz"
_LISTS = ("frequency", "magnitude", "phase", "coherence")
_SHOWN_POINTS = 12


def run_and_tell(name: str, settings: list[str], json_wanted: bool, out: Path | None) -> None:
    """Run a scenario and show or write what it gives.

    Args:
        name: scenario file or shipped name.
        settings: texts key=value.
        json_wanted: whether the metrics are printed as JSON.
        out: folder for the files; nothing is written if None.

    Raises:
        InputError: an unusable scenario, or a folder that cannot be written.
    """
    refuse_unusable(out)
    path = find_scenario(name)
    with warnings_as_lines():
        scenario = read_scenario(path, parse_overrides(settings))
        with _progress(scenario.name) as told:
            result = run_scenario(scenario, out / CHECKPOINT if out is not None else None, told)
        evaluated = evaluate(result)
    content = metrics(result, evaluated, path)
    if out is not None:
        with output_folder(out) as folder:
            _write(result, evaluated, content, folder)
    deliver(content, [] if json_wanted else _tables(content), json_wanted, None)
    tell_written(out, json_wanted)


def metrics(result: ScenarioResult, evaluated: tuple[Evaluated, ...], path: Path) -> dict[str, Any]:
    """Everything that was found, SI units, ready for JSON."""
    scenario, cascade = result.scenario, result.scenario.cascade
    whole = following(result.series["setpoint"], result.series["table_position"])
    value, growth, frequency = worst_eigenvalue(scenario.plant, cascade, position=scenario.plant.middle)
    return {
        "format": FORMAT,
        "version": __version__,
        "scenario": str(path),
        "name": scenario.name,
        "plant": scenario.plant.name,
        "digest": scenario.digest,
        "duration": scenario.duration,
        "sample_time": result.scenario.sample_time,
        "samples": len(result.time),
        "controller": {
            "position_gain": {"1/s": cascade.position_gain, "(m/min)/mm": cascade.position_gain / KV_UNIT},
            "velocity_gain": {"N m s/rad": cascade.velocity_gain},
            "reset_time": {"s": cascade.reset_time if math.isfinite(cascade.reset_time) else None},
            "rates": {"velocity Hz": 1 / cascade.sample_time,
                      "position Hz": 1 / (cascade.sample_time * cascade.position_divider)},
            "slowest_eigenvalue": {"magnitude": abs(value), "growth 1/s": growth, "frequency Hz": frequency},
        },
        "following_error": {"rms": whole.rms, "maximum": whole.maximum, "mean": whole.mean},
        "motor_torque": {"rms": _rms(result), "maximum": float(abs(result.series["motor_torque"]).max())},
        "evaluations": [as_json(one) for one in evaluated],
    }  # fmt: skip


def _rms(result: ScenarioResult) -> float:
    return float((result.series["motor_torque"] ** 2).mean() ** 0.5)


def _write(result: ScenarioResult, evaluated: tuple[Evaluated, ...], content: dict[str, Any], out: Path) -> None:
    from feeddrive.report.figures.drawing import render
    from feeddrive.report.figures.figure_scenario import scenario_figures

    write_recording(result.recording, out / "recording.csv")
    for figure in scenario_figures(result, evaluated):
        drawn = render(figure)
        write_bytes_atomically(out / f"{drawn.stem}.png", drawn.png)
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    write_text_atomically(out / "metrics.json", text)


@contextmanager
def _progress(name: str) -> Iterator[Told | None]:
    """A bar on a terminal, nothing in a pipe."""
    if not sys.stderr.isatty():
        yield None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=1.0)
        yield lambda share: bar.update(task, completed=share)


def _tables(content: dict[str, Any]) -> list[Table]:
    gains, error = content["controller"], content["following_error"]
    rows = [
        ["duration", format_quantity(content["duration"], "s")],
        ["position gain K_v", _gain(gains["position_gain"])],
        ["following error rms", format_quantity(error["rms"], "m")],
        ["following error maximum", format_quantity(error["maximum"], "m")],
        ["motor torque rms", format_quantity(content["motor_torque"]["rms"], "N m")],
        ["motor torque maximum", format_quantity(content["motor_torque"]["maximum"], "N m")],
    ]
    found = [table(f"{content['name']}, {content['plant']}", ("figure", "quantity"), rows)]
    found += [_evaluation_table(one) for one in content["evaluations"]]
    return found


def _gain(gain: dict[str, float]) -> str:
    return f"{gain['(m/min)/mm']:.4g} (m/min)/mm = {gain['1/s']:.4g} 1/s" if gain["1/s"] else "position loop open"


_UNITS = {
    "target": "m", "time": "s", "overshoot": "m", "deviation": "m", "velocity": "m/s", "torque": "N m",
    "spread": "N m", "force": "N", "stiffness": "N/m", "width": "m", "work": "J", "displacement": "m", "lag": "rad",
    "rise": "s", "settling": "s", "window": "m", "average": "s", "start": "s", "end": "s", "period": "s", "at": "s",
    "skip": "s", "segment": "s", "rms": "m", "maximum": "m", "mean": "m", "glitch": "m", "radial_maximum": "m",
    "radial_minimum": "m", "friction": "N m", "offset": "N m", "stroke": "m", "reversal": "m",
}  # fmt: skip


def _evaluation_table(one: dict[str, Any]) -> Table:
    title = one["kind"].replace("_", " ")
    if one["kind"] == "positioning":
        lengths = {key: value for key, value in one.items() if isinstance(value, float) and key != "average"}
        shown = [[key.replace("_", " "), format_quantity(value, "m")] for key, value in lengths.items()]
        return table(f"{title}, {one['standard']}", ("figure", "quantity"), shown)
    if "points" in one:
        keys = list(one["points"][0])
        rows = [[_shown(key, point[key]) for key in keys] for point in one["points"]]
        more = [["…"] + [""] * (len(keys) - 1)] if len(rows) > _SHOWN_POINTS else []
        return table(title, keys, rows[:_SHOWN_POINTS] + more)
    return table(title, ("figure", "quantity"), [
        [key.replace("_", " "), _shown(key, value, one)]
        for key, value in one.items() if key not in ("kind", *_LISTS)
    ])  # fmt: skip


def _shown(key: str, value: Any, one: dict[str, Any] | None = None) -> str:
    if value is None:
        return {"time": "never", "settling": "not settled"}.get(key, "–")
    if isinstance(value, list):
        return ", ".join(_shown(key, item, one) for item in value)
    if isinstance(value, float):
        unit = SERIES[one["channel"]] if one is not None and key == "final" else _UNITS.get(key, "1")
        if one is not None and one["kind"] == "step" and key == "overshoot":
            return f"{100 * value:.3g} %"
        return format_quantity(value, unit) if unit != "1" else f"{value:.5g}"
    return f"{value:+d}" if key == "direction" else str(value)
