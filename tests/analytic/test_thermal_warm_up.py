"""Runs from speed and ambient: reduced against full, heat that follows the temperature, the recorded rig."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path as FilePath

import numpy as np
import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.full.full_model import FRONT, NUT, full_model
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.run.warm_up import Rows, declared_rows, grouped, readings, run, simulate
from feeddrive.typing import FloatArray
from tests.analytic.thermal_cases import BENCH, RPM

FULL = full_model(BENCH.rig)
STEP = 30.0
SPEEDS = np.repeat([500.0, 0.0, 750.0, 250.0, 0.0], [180, 120, 180, 60, 180]) * RPM
AMBIENT = 23.0 + 0.5 * np.sin(np.arange(720) / 200)


@pytest.fixture(scope="module")
def reduced() -> HeatModel:
    """The bench reduced for its whole range."""
    return reduce_model([FULL], BENCH.limits())[0]


def test_reduced_run_is_the_full_one(reduced: HeatModel) -> None:
    truth = simulate(BENCH, FULL, STEP, SPEEDS, AMBIENT)
    shown = simulate(BENCH, reduced, STEP, SPEEDS, AMBIENT)
    assert set(shown) >= {"nut_temperature", "front_bearing_temperature", "table_growth_250mm"}
    for channel, values in truth.items():
        # Measured 2 mK and 4 nm.
        limit = 10e-9 if "growth" in channel else 5e-3
        assert np.abs(shown[channel] - values).max() < limit, channel


def test_run_starts_at_ambient_and_stays_there_at_rest(reduced: HeatModel) -> None:
    shown = simulate(BENCH, reduced, STEP, np.zeros(50), np.full(50, 21.5))
    np.testing.assert_allclose(shown["nut_temperature"], 21.5, atol=1e-12)
    np.testing.assert_allclose(shown["table_growth_300mm"], 0.0, atol=1e-18)


def test_heat_that_grows_with_the_nut_settles_where_the_balance_says(reduced: HeatModel) -> None:
    growth, speeds = 0.02, np.full(3000, 500 * RPM)
    rows = declared_rows(BENCH, STEP, speeds, np.full(3000, 23.0))
    share, ω, load = BENCH.nut.heat_share, 500 * RPM, BENCH.nut.load_torque
    base = float(rows.inputs[NUT][0])

    def heat(_: int, rises: FloatArray) -> FloatArray:
        return np.array([base + share * ω * load * growth * rises[0], 0.0, 0.0])

    states = run(reduced, replace(rows, following=heat))
    g = {path: float(values[0]) for path, values in rows.conductances.items()}
    system = reduced.at(g)
    per_watt = float(system.gain()[system.row(NUT), system.column(NUT)])
    settled = per_watt * base / (1 - per_watt * share * ω * load * growth)
    # 25 h are more than 30 time constants.
    assert float(states[-1] @ reduced.readings[NUT]) == pytest.approx(settled, rel=1e-6)


def test_feedback_converges_with_the_rows(reduced: HeatModel) -> None:
    def at_the_end(step: float) -> float:
        count = round(3600 / step)
        rows = declared_rows(BENCH, step, np.full(count, 500 * RPM), np.full(count, 23.0))
        base = float(rows.inputs[NUT][0])
        states = run(reduced, replace(rows, following=lambda _, rises: np.array([base * (1 + 0.02 * rises[0]), 0, 0])))
        return float(states[-1] @ reduced.readings[NUT])

    # A heat that follows the temperature is taken at the middle of each row; 30 s rows are then good to 2 mK.
    assert at_the_end(30.0) == pytest.approx(at_the_end(3.0), abs=2e-3)


def test_noisy_speed_costs_little_and_shifts_nothing(reduced: HeatModel, generator: np.random.Generator) -> None:
    noisy = SPEEDS * (1 + 1e-3 * generator.normal(size=SPEEDS.size))
    rows = declared_rows(BENCH, STEP, noisy, AMBIENT)
    groups, which = grouped(np.column_stack(list(rows.conductances.values())))
    assert len(groups) < 40 and which.shape == noisy.shape
    truth = declared_rows(BENCH, STEP, SPEEDS, AMBIENT)
    shown, wanted = (run(reduced, one) @ reduced.readings[NUT] for one in (rows, truth))
    # The heat itself is 0.1 % noisy: some millikelvin of 14 K.
    assert np.abs(shown - wanted).max() < 0.01


def test_negative_conductance_of_a_row_is_refused(reduced: HeatModel) -> None:
    rows = declared_rows(BENCH, STEP, np.zeros(3), np.full(3, 23.0))
    bad = {**rows.conductances, next(iter(rows.conductances)): np.array([1.0, -1.0, 1.0])}
    with pytest.raises(InputError, match="negative or not finite"):
        run(reduced, replace(rows, conductances=bad))


def test_cooling_from_a_row_on_takes_heat_away(reduced: HeatModel) -> None:
    rows = declared_rows(BENCH, STEP, np.full(400, 500 * RPM), np.full(400, 23.0))
    cooled = dict(rows.conductances)
    path = next(path for path in cooled if path == "cooling")
    cooled[path] = np.where(np.arange(400) < 200, 0.0, 1.5)
    before, after = (run(reduced, one) @ reduced.readings[NUT] for one in (rows, replace(rows, conductances=cooled)))
    np.testing.assert_allclose(after[:200], before[:200], atol=1e-12)
    assert after[-1] < 0.7 * before[-1]


def test_speed_above_the_declared_one_is_said(reduced: HeatModel) -> None:
    with pytest.warns(ValidityWarning, match="above the highest speed declared"):
        declared_rows(BENCH, STEP, np.array([1600 * RPM]), np.array([23.0]))
    with pytest.warns(ValidityWarning, match="lies outside"):
        fast = {path: np.full(1, value) for path, value in BENCH.at_speed(4000 * RPM).items()}
        run(reduced, Rows(STEP, fast, {}))


def test_input_that_the_model_does_not_have_is_refused(reduced: HeatModel) -> None:
    rows = declared_rows(BENCH, STEP, np.zeros(3), np.full(3, 23.0))
    with pytest.raises(InputError, match='no input "spindle"'):
        run(reduced, replace(rows, inputs={"spindle": np.zeros(3)}))
    with pytest.raises(InputError, match="2 values for 3 rows"):
        run(reduced, replace(rows, inputs={FRONT: np.zeros(2)}))
    with pytest.raises(InputError, match="not finite"):
        run(reduced, replace(rows, inputs={FRONT: np.array([0.0, np.nan, 0.0])}))
    with pytest.raises(InputError, match="2 speeds and 3 ambient"):
        declared_rows(BENCH, STEP, np.zeros(2), np.zeros(3))


def _recorded(path: FilePath) -> dict[str, FloatArray]:
    with path.open(encoding="utf-8") as file:
        header, *rows = list(csv.reader(file))
    names = [name.split(" ")[0] for name in header]
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


@pytest.mark.parametrize("name", ["train", "validate"])
def test_residuals_of_the_declared_rig_are_the_sensors_noise(shared_data: FilePath, name: str) -> None:
    path = shared_data / "thermal_cases" / "null" / f"{name}.csv"
    if not path.is_file():
        pytest.skip(f"no development data: no {path}")
    recorded = _recorded(path)
    shown = simulate(BENCH, FULL, STEP, recorded["screw_speed"] * RPM, recorded["ambient_temperature"])
    for channel in ("nut_temperature", "front_bearing_temperature"):
        # Noise 0.03 K; 20 % more for the generator's own discretisation.
        assert np.sqrt(np.mean((recorded[channel] - shown[channel]) ** 2)) < 0.036, channel
    for position in (200, 250, 300):
        channel = f"table_growth_{position}mm"
        residual = recorded[channel] - shown[channel] * 1e6
        assert np.sqrt(np.mean(residual**2)) < 0.18, channel


def test_heat_of_the_motor_end_shows_at_the_front(shared_data: FilePath) -> None:
    path = shared_data / "thermal_cases" / "motor_heat" / "train.csv"
    if not path.is_file():
        pytest.skip(f"no development data: no {path}")
    recorded = _recorded(path)
    rpm = recorded["screw_speed"]
    rows = declared_rows(BENCH, STEP, rpm * RPM, recorded["ambient_temperature"])
    # As planted: 1.8022 W (0.4 + 0.6 N/750) while turning.
    planted = np.where(rpm > 0, 1.8022 * (0.4 + 0.6 * rpm / 750), 0.0)
    states = run(FULL, replace(rows, inputs={**rows.inputs, FRONT: planted}), substeps=4)
    shown = readings(FULL, states, float(recorded["ambient_temperature"][0]))
    residual = recorded["front_bearing_temperature"] - shown["front_bearing_temperature"]
    # Noise 0.03 K and what the two grids leave at the heated end.
    assert np.sqrt(np.mean(residual**2)) < 0.036
