"""A unit of a sweep: some of its runs, one after the other, as a worker does them.

A run that fails, for instance since its loop is unstable, gives a row with the reason. What a unit gives is text, the
same from every worker: numbers are written so that they are read back bit for bit.
"""

from __future__ import annotations

import json
import math
import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.files import write_text_atomically
from feeddrive.simulate.scenario.scenario import ScenarioResult
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_run import run_scenario
from feeddrive.simulate.sweep.sweep_design import Design, scenario_digest

UNIT_FORMAT = "feeddrive-sweep-unit/1"


@dataclass(frozen=True)
class Metric:
    """A number that a run gives, and its SI unit; infinite where it never comes about."""

    value: float
    unit: str


Measure = Callable[[ScenarioResult], Mapping[str, Metric]]
"""What is taken from a finished run: name to metric. A function of a module, so that other processes find it."""


@dataclass(frozen=True)
class UnitTask:
    """Runs for a worker.

    Attributes:
        path: of the scenario, which the worker must see as the sweep does.
        base: overrides of the sweep's first run.
        base_digest: checksum of its scenario.
        digest: of the sweep.
        first: number of the first run.
        overrides: of each run.
        measure: what is taken from each.
    """

    path: Path
    base: Mapping[str, str]
    base_digest: str
    digest: str
    first: int
    overrides: tuple[Mapping[str, str], ...]
    measure: Measure


_ONE_AT_A_TIME = threading.Lock()
"""Neither CasADi's expressions nor the record of warnings may be shared by threads; some workers have several."""


def unit_task(design: Design, first: int, end: int, measure: Measure) -> UnitTask:
    """The runs from `first` on, before `end`."""
    overrides = tuple(design.overrides(row) for row in design.rows[first:end])
    base = design.overrides(design.rows[0])
    return UnitTask(design.path, base, design.base_digest, design.digest, first, overrides, measure)


def run_unit(task: UnitTask) -> str:
    """Run a unit.

    Returns:
        JSON with the sweep's digest and one entry per run: number, reason of a failure, warnings, metrics.

    Raises:
        InputError: this worker sees other files, or has another version, than the sweep was begun with.
    """
    with _ONE_AT_A_TIME:
        _refuse_other_files(task)
        runs = [_run(task, task.first + place, overrides) for place, overrides in enumerate(task.overrides)]
    return json.dumps({"format": UNIT_FORMAT, "digest": task.digest, "runs": runs}, allow_nan=False)


def write_unit(task: UnitTask, path: Path) -> None:
    """Run a unit and write what it gives, whole or not at all."""
    write_text_atomically(path, run_unit(task))


def is_list_of_runs(content: Any, numbers: Sequence[int]) -> bool:
    """Whether something read from a file is what `run_unit` writes of the runs of these numbers."""
    if not isinstance(content, list) or not all(isinstance(run, dict) for run in content):
        return False
    return [run.get("run") for run in content] == [*numbers] and all(map(_is_run, content))


def _is_run(run: Mapping[str, Any]) -> bool:
    """Whether reason, warnings and metrics are what `_run` makes."""
    messages, metrics = run.get("warnings"), run.get("metrics")
    return (
        isinstance(run.get("reason"), str)
        and isinstance(messages, list)
        and all(isinstance(line, str) for line in messages)
        and isinstance(metrics, dict)
        and all(map(_is_metric, metrics.values()))
        and bool(metrics) != bool(run["reason"])
    )


def _is_metric(pair: Any) -> bool:
    if not isinstance(pair, list) or len(pair) != 2 or not isinstance(pair[1], str):
        return False
    return pair[0] is None or (isinstance(pair[0], float | int) and not isinstance(pair[0], bool))


def finished_runs(text: str) -> int:
    """How many runs of a unit did not fail."""
    return sum(not run["reason"] for run in json.loads(text)["runs"])


def _refuse_other_files(task: UnitTask) -> None:
    mend = "let every worker see the same files, by the same version of feeddrive, and leave them while a sweep runs"
    try:
        same = scenario_digest(task.path, task.base, "worker") == task.base_digest
    except InputError as error:
        raise InputError(f"a worker cannot read the scenario ({error})", str(task.path), mend) from None
    if not same:
        raise InputError("a worker sees another scenario than the sweep was begun with", str(task.path), mend)


def _run(task: UnitTask, number: int, overrides: Mapping[str, str]) -> dict[str, Any]:
    """One run as plain values; metrics as pairs of number and unit."""
    reason, metrics = "", {}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ValidityWarning)
        try:
            metrics = dict(task.measure(run_scenario(read_scenario(task.path, overrides))))
        except InputError as error:
            reason = error.what
        except Exception as error:  # one run must not take the others with it; the row says what happened
            reason = " ".join(f"internal error: {type(error).__name__}: {error}".split())
    messages = [str(warning.message) for warning in caught if issubclass(warning.category, ValidityWarning)]
    plain = {name: [_plain(metric.value), metric.unit] for name, metric in metrics.items()}
    return {"run": number, "reason": reason, "warnings": list(dict.fromkeys(messages)), "metrics": plain}


def _plain(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
