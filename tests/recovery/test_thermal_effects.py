"""Every planted thermal effect is named, alone, with its size; where nothing is planted nothing is found.

The recordings come from `tests/generator/thermal.py`, which shares no code with the package; they are made on the fly
(some seconds a pair). With `-s` each case prints what was found.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, read_recording
from tests.generator.thermal import TRAIN, VALIDATE, Rig, measured, simulate, write_csv
from tests.generator.thermal_effects import Planted, ThermalTruth

FAST = 750 * math.pi / 30
MOTOR = {"power": 1.5, "at_speed": FAST, "share_at_rest": 0.3}

SINGLE: dict[str, Planted] = {
    "motor_small": {"motor_heat": {"power": 0.3, "at_speed": FAST, "share_at_rest": 0.0}},
    "motor_large": {"motor_heat": {"power": 3.0, "at_speed": FAST, "share_at_rest": 0.7}},
    "bearing_small": {"bearing_heat": {"factor": 0.6, "rear_share": 1.0}},
    "bearing_large": {"bearing_heat": {"factor": 4.0, "rear_share": 1.0}},
    "drift_day": {"ambient_drift": {"amplitude": 1.5, "curve": "sine", "period": 86400.0}},
    "drift_short": {"ambient_drift": {"amplitude": 0.8, "curve": "sine", "period": 14400.0}},
    "drift_ramp": {"ambient_drift": {"amplitude": 2.0, "curve": "ramp", "period": 21600.0}},
    "drift_settling": {"ambient_drift": {"amplitude": -1.0, "curve": "exponential", "period": 5000.0}},
    "preload_small": {"preload_growth": {"coefficient": 0.005}},
    "preload_large": {"preload_growth": {"coefficient": 0.0215}},
    "preload_lost": {"preload_growth": {"coefficient": -0.01}},
    "viscosity_small": {"viscosity_temperature": {"coefficient": 0.01}},
    "viscosity_large": {"viscosity_temperature": {"coefficient": 0.03}},
    "cooling_always": {"cooling": {"conductance": 0.02, "start": 0.0}},
    "cooling_later": {"cooling": {"conductance": 0.15, "start": 10000.0}},
    "film_of_screw": {"convection_deviation": {"where": "screw", "factor": 1.15}},
    "film_of_nut": {"convection_deviation": {"where": "nut", "factor": 0.8}},
    "films": {"convection_deviation": {"where": "all", "factor": 1.2}},
    "contact_loose": {"contact_conductance_deviation": {"factor": 0.6}},
    "contact_close": {"contact_conductance_deviation": {"factor": 1.6}},
    "sink_small": {"heat_sink": {"conductance": 0.05, "capacity": 200.0}},
    "sink_large": {"heat_sink": {"conductance": 0.1, "capacity": 600.0}},
    "frame": {"structure_growth": {"growth": 1.5e-6, "slope": 0.0, "time_constant": 5000.0}},
    "frame_along": {"structure_growth": {"growth": -1e-6, "slope": 1.2e-5, "time_constant": 9000.0}},
    "lag_of_nut": {"sensor_lag": {"channel": "nut_temperature", "time_constant": 60.0}},
    "lag_of_end": {"sensor_lag": {"channel": "front_bearing_temperature", "time_constant": 90.0}},
}

PAIRS: dict[str, Planted] = {
    "motor_preload": {"motor_heat": MOTOR, "preload_growth": {"coefficient": 0.015}},
    "motor_cooling": {"motor_heat": MOTOR, "cooling": {"conductance": 0.08, "start": 6000.0}},
    "drift_preload": {
        "ambient_drift": {"amplitude": 1.0, "curve": "sine", "period": 20000.0},
        "preload_growth": {"coefficient": 0.015},
    },
    "frame_motor": {"structure_growth": SINGLE["frame"]["structure_growth"], "motor_heat": MOTOR},
    "film_motor": {"convection_deviation": {"where": "screw", "factor": 1.25}, "motor_heat": MOTOR},
    "sink_cooling": {
        "heat_sink": {"conductance": 0.1025, "capacity": 233.0},
        "cooling": {"conductance": 0.0308, "start": 13330.0},
    },
    "sink_bearing": {
        "heat_sink": {"conductance": 0.15, "capacity": 400.0},
        "bearing_heat": {"factor": 2.0, "rear_share": 1.0},
    },
}

Schedule = tuple[tuple[float, int], ...]

SHORT: tuple[Schedule, Schedule] = (((750, 90), (0, 50), (300, 40)), ((500, 80), (0, 40)))
"""Runs of an hour and a half and an hour, for the tests of every suite."""

NULLS = tuple(range(10))

WITHIN = 0.15
"""What is asked of a parameter."""

GROWTH_OVER_NULL = 1.3
"""Error of a growth after the effects over the declared plant's where nothing is planted, as asked."""

NOISE = {"temperature": 0.03, "growth": 0.15e-6}
NOISE_REACHED = 1.2
"""Residual over sensor noise where nothing is missing, as asked."""

MESH = 1.5e-3
"""What the generator's own mesh errs, over the rise: of 21 K at the front bearing, heated at its seat, its 250 volumes
of four rings are 32 mK off what finer and finer meshes come to (`motor_large`)."""


@cache
def plant() -> Plant:
    """The declared bench."""
    return read_plant(plants_folder() / "thermal_bench.toml")


@cache
def rig() -> Rig:
    """The generator's mesh."""
    return Rig()


@cache
def nothing_planted(schedule: Schedule) -> dict[str, np.ndarray]:
    """Noiseless channels of the declared rig."""
    return simulate(schedule, ThermalTruth(), rig())


def recorded(planted: Planted, seed: int, folder: Path, runs: tuple[Schedule, Schedule]) -> list[Recording]:
    """A pair of recordings, to fit and to judge, read back from files."""
    pair = []
    for number, schedule in enumerate(runs):
        channels = simulate(schedule, ThermalTruth(planted), rig()) if planted else nothing_planted(schedule)
        path = folder / f"{number}.csv"
        write_csv(measured(channels, 2 * seed + number), path)
        pair.append(read_recording(path))
    return pair


def diagnosed(planted: Planted, seed: int, folder: Path, runs: tuple[Schedule, Schedule]) -> Diagnosis:
    """The diagnosis of a pair."""
    fitted, judged = recorded(planted, seed, folder, runs)
    return diagnose(plant(), [fitted], [judged])[0]


def misses(result: Diagnosis, planted: Planted) -> list[str]:
    """What is wrong, in words."""
    found = {effect.name: effect for effect in result.effects}
    if set(found) != set(planted):
        sets = [names for names in result.ambiguous if len(names) <= 3]
        said = all(name in found or any(name in names for names in sets) for name in planted)
        return [] if said and len(found) == len(planted) else [f"found {sorted(found)}, planted {sorted(planted)}"]
    return [
        f"{name}.{key} {found[name].parameters[key].value} for {value}"
        for name, values in planted.items()
        for key, value in values.items()
        if key not in ("curve", "period") and not close(found[name].parameters[key].value, value)
    ]


def close(found: Any, planted: Any) -> bool:
    """Whether a parameter is near enough; what is planted as zero (a start, a slope) shows in the errors alone."""
    if isinstance(planted, str):
        return bool(found == planted)
    return planted == 0 or abs(float(found) - float(planted)) <= WITHIN * abs(float(planted))


def check(planted: Planted, seed: int, folder: Path, runs: tuple[Schedule, Schedule] = (TRAIN, VALIDATE)) -> None:
    """Diagnose, print a row, and fail with what is wrong."""
    result = diagnosed(planted, seed, folder, runs)
    shown = {e.name: {k: p.value for k, p in e.parameters.items()} for e in result.effects}
    print(f"\n{shown or 'nothing'} ambiguous {result.ambiguous}")
    assert misses(result, planted) == []
    for channel in result.channels:
        noise = NOISE["growth" if channel.name.startswith("table_growth") else "temperature"]
        limit = GROWTH_OVER_NULL if planted else NOISE_REACHED
        assert channel.after.rms <= math.hypot(limit * noise, MESH * channel.before.rms), channel.name


def test_smoke_nothing_is_found_where_nothing_is_planted(tmp_path: Path) -> None:
    check({}, 500, tmp_path, SHORT)


def test_smoke_preload_growth(tmp_path: Path) -> None:
    check(SINGLE["preload_large"], 501, tmp_path, SHORT)


@pytest.mark.slow
@pytest.mark.parametrize("seed", NULLS)
def test_nothing_is_found_where_nothing_is_planted(seed: int, tmp_path: Path) -> None:
    check({}, 600 + seed, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("case", SINGLE)
def test_one_effect(case: str, tmp_path: Path) -> None:
    check(SINGLE[case], 700 + list(SINGLE).index(case), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("case", PAIRS)
def test_two_effects(case: str, tmp_path: Path) -> None:
    check(PAIRS[case], 800 + list(PAIRS).index(case), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["null", "motor_heat", "preload_growth"])
def test_shared_cases(case: str, shared_data: Path) -> None:
    """Recordings of a third simulator, absent from the project (see `shared_data` in tests/conftest.py)."""
    folder = shared_data / "thermal_cases" / case
    fitted, judged = (read_recording(folder / f"{part}.csv") for part in ("train", "validate"))
    result, _ = diagnose(plant(), [fitted], [judged])
    planted: dict[str, Planted] = {
        "null": {},
        "motor_heat": {"motor_heat": {"power": 1.8022, "at_speed": FAST, "share_at_rest": 0.4}},
        "preload_growth": {"preload_growth": {"coefficient": 0.021506}},
    }
    assert misses(result, planted[case]) == []
    for channel in result.channels:
        if channel.name.startswith("table_growth"):
            assert channel.after.rms <= GROWTH_OVER_NULL * NOISE["growth"], channel.name
