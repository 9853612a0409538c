"""What a thermal model may miss: a gain along a channel's own rise, and little of any shape, counted by channel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.heat.heat_evidence import GAIN_ERROR, MODEL_ERROR, HeatEvidence, prepare_heat
from feeddrive.diagnosis.likelihood.cross_validation import gain_of_model_error, model_error_rows
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording

PLANT = read_plant(plants_folder() / "thermal_bench.toml").heat
ROWS, STEP = 240, 30.0


def evidence() -> HeatEvidence:
    """A nut that warms by 10 K, and a growth of 20 um."""
    time = STEP * np.arange(1, ROWS + 1)
    rise = 1 - np.exp(-time / 2000.0)
    channels = {
        "screw_speed": np.full(ROWS, 50.0),
        "ambient_temperature": np.full(ROWS, 23.0),
        "nut_temperature": 23.0 + 10.0 * rise,
        "table_growth_300mm": 2e-5 * rise,
    }
    noisy = replace(
        PLANT, sensors=tuple(replace(s, noise=0.03 if s.kind == "thermometer" else 1.5e-7) for s in PLANT.sensors)
    )
    return prepare_heat(Recording("warm", time, channels, STEP), noisy, 1.0)


def test_error_along_the_rise_is_worth_its_share_of_the_prior() -> None:
    made = evidence()
    rows = made.fit_rows
    gain = {name: GAIN_ERROR * made.rise(name) for name in made.channels}
    for name in made.channels:
        left = made.without_open(name, gain[name][rows], rows)
        u = GAIN_ERROR * made.rise(name)[rows] / made.noise[name]
        # u' (1 + u u')^-1 u, by Sherman and Morrison
        assert float(left @ left) == pytest.approx(u @ u / (1 + u @ u), rel=1e-9)
        assert float(left @ left) < 1.0  # an error of one standard deviation is worth at most one


def test_what_is_square_to_the_rise_is_left_as_it_is() -> None:
    made = evidence()
    rows = made.fit_rows
    generator = np.random.default_rng(1)
    for name in made.channels:
        rise = made.rise(name)[rows]
        other = generator.standard_normal(len(rise)) * made.noise[name]
        other -= (rise @ other) / (rise @ rise) * rise
        assert made.without_open(name, other, rows) == pytest.approx(other / made.noise[name], rel=1e-9, abs=1e-12)


def test_model_error_counts_in_its_own_channel() -> None:
    made = evidence()
    rows = model_error_rows([made], [made.fit_rows])
    nut = float(ROWS * (made.model_error["nut_temperature"] / made.noise["nut_temperature"]) ** 2)
    growth = float(ROWS * (made.model_error["table_growth_300mm"] / made.noise["table_growth_300mm"]) ** 2)
    assert made.model_error["nut_temperature"] > MODEL_ERROR["degC"]  # and what grows with the rise
    first, second = np.split(rows, 2)
    assert first == pytest.approx(nut) and second == pytest.approx(growth)
    before, in_nut, in_both = np.full(2 * ROWS, 2.0), np.full(2 * ROWS, 2.0), np.full(2 * ROWS, 1.0)
    in_nut[:ROWS] = 1.0
    assert gain_of_model_error(rows, before, in_nut) == pytest.approx(nut / (before @ before))
    assert gain_of_model_error(rows, before, in_both) == pytest.approx((nut + growth) / 2 / (before @ before))
    assert gain_of_model_error(rows, before, before) == 0.0
