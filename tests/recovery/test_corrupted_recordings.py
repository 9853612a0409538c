"""Forty spoilt copies of a recording in which nothing lacks: refused, or nothing named, and never an absurd machine.

The recording is the committed null of `tests/generator`, which shares no code with the package; both files of it are
spoilt alike, as one wrong mapping spoils all that is read with it. Each is diagnosed as a user would, by the command
line. With `-s` every copy prints a line.
"""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.cli.main import main
from tests.recovery.corruptions import CORRUPTIONS, LIKE_AN_EFFECT, Channels

NULL = Path(__file__).resolve().parents[1] / "data" / "bench"

UNITS = {
    "time": "s", "setpoint": "m", "motor_torque": "N m", "motor_angle": "rad", "table_position": "m",
}  # fmt: skip

# What any machine has, whatever the effect: key -> least value. A payload and an inertia add to what is declared.
LEAST = {
    "mass": -134.0, "inertia": -2.37e-3, "factor": 0.0, "coulomb_factor": 0.0, "viscous_factor": 0.0, "width": 0.0,
    "delay": 0.0, "ratio": 0.0, "half_width": 0.0, "time_constant": 0.0, "frequency": 0.0, "damping": 0.0,
}  # fmt: skip

# Torque and position hold 2 B T values in the band, B = 150 Hz over 6 s or more: the rms of noise is known to 1.7 %,
# and three standard deviations of it are 5 %.
SCATTER = 1.05

FEWEST_UNNAMED = 34
"""Of forty."""


@dataclass(frozen=True)
class Outcome:
    """What a diagnosis of a spoilt recording ended with."""

    status: int
    error: str
    found: dict[str, dict[str, Any]]
    absurd: list[str]


@pytest.fixture(scope="module")
def sound() -> tuple[Channels, Channels]:
    """The recordings to fit and to judge."""
    return read(NULL / "null_train.csv.gz"), read(NULL / "null_validate.csv.gz")


def read(path: Path) -> Channels:
    """Channel to its samples."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        names = [head.split(" [")[0] for head in file.readline().strip().split(",")]
        table = np.loadtxt(file, delimiter=",")
    return {name: table[:, i] for i, name in enumerate(names)}


def write(channels: Channels, path: Path) -> Path:
    """A recording file with these channels."""
    header = ",".join(f"{name} [{UNITS[name]}]" for name in channels)
    np.savetxt(path, np.column_stack(list(channels.values())), "%.12g", ",", header=header, comments="")
    return path


def diagnosed(name: str, sound: tuple[Channels, Channels], folder: Path) -> Outcome:
    """The recordings spoilt in one way, diagnosed."""
    fit, judge = (
        write(CORRUPTIONS[name](one), folder / f"{part}.csv") for part, one in zip(("fit", "judge"), sound, strict=True)
    )
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        words = ["diagnose", "bench_axis", str(fit), "--validate", str(judge), "--out", str(folder / "report")]
        status = main(words)
    if status:
        return Outcome(status, err.getvalue().strip(), {}, [])
    record = json.loads((folder / "report" / "diagnosis.json").read_text(encoding="utf-8"))
    found = {one["name"]: one["parameters"] for one in record["effects"]}
    return Outcome(status, "", found, [*absurd_values(found), *worse(record), *unusable(folder / "report")])


def absurd_values(found: dict[str, dict[str, Any]]) -> list[str]:
    """Values that no machine has."""
    return [
        f"{name} {key} {parameter['value']:.4g}"
        for name, parameters in found.items()
        for key, parameter in parameters.items()
        if isinstance(parameter["value"], float) and not parameter["value"] >= LEAST.get(key, -np.inf)
    ]


def worse(record: dict[str, Any]) -> list[str]:
    """Channels that the machine found predicts worse than the declared one, beyond scatter."""
    return [
        f"{one['name']} {one['after']['rms'] / one['before']['rms']:.3f} x declared"
        for one in record["channels"]
        if one["after"]["rms"] > SCATTER * one["before"]["rms"]
    ]


def unusable(report: Path) -> list[str]:
    """Commands that the corrected plant file breaks."""
    plant = report / "plant_after.toml"
    tomllib.loads(plant.read_text(encoding="utf-8"))
    broken = []
    for command in ("show", "modes"):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            if main([command, str(plant)]) != 0:
                broken.append(f"{command} refuses plant_after.toml")
    return broken


def test_there_are_forty_and_each_changes_the_recording(sound: tuple[Channels, Channels]) -> None:
    assert len(CORRUPTIONS) == 40
    assert set(LIKE_AN_EFFECT) <= set(CORRUPTIONS)
    for name, change in CORRUPTIONS.items():
        spoilt = change(sound[0])
        same = all(len(spoilt[c]) == len(sound[0][c]) and np.array_equal(spoilt[c], sound[0][c]) for c in sound[0])
        assert set(spoilt) == set(sound[0]) and not same, name


@pytest.mark.slow
def test_spoilt_recordings_are_refused_or_nothing_is_named(sound: tuple[Channels, Channels], tmp_path: Path) -> None:
    named, wrong = [], []
    for number, name in enumerate(CORRUPTIONS):
        folder = tmp_path / str(number)
        folder.mkdir()
        outcome = diagnosed(name, sound, folder)
        print(f"{number:2d} {name}: status {outcome.status} {list(outcome.found)} {outcome.error} {outcome.absurd}")
        expected = LIKE_AN_EFFECT.get(name, ())
        if outcome.found and tuple(outcome.found) != expected:
            named.append(f"{name}: {', '.join(outcome.found)}")
        one_line = outcome.status != 2 or len(outcome.error.splitlines()) == 1
        if outcome.status not in (0, 2) or outcome.absurd or not one_line:
            wrong.append(f"{name}: status {outcome.status}, {outcome.absurd or outcome.error}")
    assert wrong == []
    assert len(CORRUPTIONS) - len(named) >= FEWEST_UNNAMED, named
