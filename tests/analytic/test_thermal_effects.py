"""Thermal effects: neutral values, physical ranges, closed forms, and plant files that hold them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.judging.physical_reading import READINGS
from feeddrive.effects.base import Parameter
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.effects.heat.bearing_heat import reference_torque
from feeddrive.effects.heat.thermal_effect import Operation, ThermalEffect
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.thermal.laws.friction import Friction
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.run.warm_up import declared_rows, lagging, simulate
from tests.analytic.thermal_cases import BENCH, RPM, with_effects

NEUTRAL: dict[str, dict[str, float]] = {
    "motor_heat": {"power": 0.0, "at_speed": 75.0},
    "bearing_heat": {"factor": 0.0},
    "ambient_drift": {"amplitude": 0.0},
    "preload_growth": {"coefficient": 0.0},
    "viscosity_temperature": {"coefficient": 0.0},
    "cooling": {"conductance": 0.0},
    "convection_deviation": {"factor": 1.0},
    "contact_conductance_deviation": {"factor": 1.0},
    "heat_sink": {"conductance": 0.0, "capacity": 300.0},
    "structure_growth": {"growth": 0.0, "time_constant": 3600.0},
    "sensor_lag": {"time_constant": 0.0},
}
STRONG: dict[str, dict[str, float]] = {
    **{name: {**values, next(iter(values)): 0.5} for name, values in NEUTRAL.items()},
    "preload_growth": {"coefficient": 0.02},
    "viscosity_temperature": {"coefficient": 0.02},
    "structure_growth": {"growth": 1e-6, "time_constant": 3600.0},
    "sensor_lag": {"time_constant": 120.0},
}
PLACE = {"convection_deviation": "all", "sensor_lag": "nut_temperature"}
SPEEDS = np.repeat([500.0, 0.0, 750.0], [60, 30, 60]) * RPM
AMBIENT = np.full(len(SPEEDS), 23.0)
STEP = 30.0


@pytest.fixture(scope="module")
def model() -> HeatModel:
    """The bench, reduced."""
    return reduce_model([BENCH.full_model()], BENCH.limits(3.0))[0]


def _made(name: str, values: dict[str, float]) -> ThermalEffect:
    return THERMAL_EFFECTS[name].of(place=PLACE.get(name, ""), **values)


def _run(model: HeatModel, *effects: ThermalEffect) -> dict[str, np.ndarray]:
    plant = with_effects(*effects)
    for body in plant.attached:
        model = model.with_body(body)
    return simulate(plant, model, STEP, SPEEDS, AMBIENT)


def test_every_effect_is_covered_and_no_name_is_used_twice() -> None:
    assert set(NEUTRAL) == set(THERMAL_EFFECTS)
    assert not set(EFFECTS) & set(THERMAL_EFFECTS)
    assert set(THERMAL_EFFECTS) <= set(READINGS)


@pytest.mark.parametrize("name", NEUTRAL)
def test_vanishes_at_its_neutral_value_and_acts_beside_it(name: str, model: HeatModel) -> None:
    declared = _run(model)
    neutral, strong = _run(model, _made(name, NEUTRAL[name])), _run(model, _made(name, STRONG[name]))
    for channel, values in declared.items():
        # The same sums in another order.
        np.testing.assert_allclose(neutral[channel], values, rtol=1e-10, atol=1e-13)
    changed = max(float(np.max(np.abs(strong[c] - v)) / (1e-8 if "growth" in c else 1e-2)) for c, v in declared.items())
    assert changed > 1  # more than 0.01 K or 10 nm


@pytest.mark.parametrize("name", THERMAL_EFFECTS)
def test_signature_names_effects_that_exist(name: str) -> None:
    assert set(THERMAL_EFFECTS[name].signature.confused_with) <= set(THERMAL_EFFECTS)


@pytest.mark.parametrize("name", THERMAL_EFFECTS)
def test_unknown_key_and_place_are_refused(name: str) -> None:
    with pytest.raises(InputError, match="unknown key 'nonsense'"):
        THERMAL_EFFECTS[name].of(place=PLACE.get(name, ""), nonsense=1.0)
    with pytest.raises(InputError, match="is not possible"):
        THERMAL_EFFECTS[name].of(place="" if name in PLACE else "nowhere", **NEUTRAL[name])


@pytest.mark.parametrize(
    ("name", "parameter"),
    [pytest.param(n, p, id=f"{n}.{p.key}") for n, effect in THERMAL_EFFECTS.items() for p in effect.parameters],
)
def test_value_outside_its_range_is_refused(name: str, parameter: Parameter) -> None:
    good = {**NEUTRAL[name], parameter.key: parameter.minimum if np.isfinite(parameter.minimum) else 0.0}
    for end, outward in ((parameter.minimum, -1.0), (parameter.maximum, 1.0)):
        with pytest.raises(InputError, match="outside its range"):
            _made(name, {**good, parameter.key: end + outward * max(1e-6, 1e-6 * abs(end))})


def test_bearing_torque_is_that_of_the_source() -> None:
    torques = [float(reference_torque(speed * RPM)) for speed in (250.0, 500.0, 750.0)]
    # Table 4 of paper 002 prints 2.2, 3.2 and 4.0 mN m: half of the last digit.
    np.testing.assert_allclose(torques, [2.2e-3, 3.2e-3, 4.0e-3], atol=0.05e-3)


def test_bearing_heat_is_counted_by_the_bearing_that_the_plant_declares() -> None:
    bearing = Friction(load_torque=0.09, viscous_factor=4.5, viscosity=87.6e-6, mean_diameter=37e-3)
    own = replace(with_effects(_made("bearing_heat", {"factor": 1.0})), front=bearing)
    speeds, air = np.array([300.0, 900.0]) * RPM, np.full(2, 23.0)
    shown = declared_rows(own, STEP, speeds, air).inputs
    # As much again as is declared at the front, and that at the rear, which declares none.
    np.testing.assert_allclose(shown["front"], 2 * bearing.heats(speeds), rtol=1e-12)
    np.testing.assert_allclose(shown["rear"], bearing.heats(speeds), rtol=1e-12)


def test_lag_follows_a_ramp_late_by_its_time_constant() -> None:
    time = STEP * np.arange(1.0, 401)
    read = lagging(0.01 * time, 0.0, 120.0, STEP)
    # Closed form of a first-order lag on a ramp, which the straight pieces meet exactly.
    np.testing.assert_allclose(read, 0.01 * (time - 120.0 * (1 - np.exp(-time / 120.0))), rtol=1e-9)


def test_lag_is_of_its_channel_alone(model: HeatModel) -> None:
    declared, late = _run(model), _run(model, _made("sensor_lag", {"time_constant": 120.0}))
    np.testing.assert_array_equal(late["front_bearing_temperature"], declared["front_bearing_temperature"])
    np.testing.assert_allclose(late["nut_temperature"], lagging(declared["nut_temperature"], 23.0, 120.0, STEP))


def test_drift_of_long_enough_is_the_rise_of_everything(model: HeatModel) -> None:
    plant = with_effects(
        THERMAL_EFFECTS["ambient_drift"].of(amplitude=2.0, time=(0.0, 60.0, 1e6), shape=(0.0, 1.0, 1.0))
    )
    shown = simulate(plant, model, STEP, np.zeros(6000), np.full(6000, 23.0))
    # 50 h at rest are more than 30 time constants of 85 min.
    # The reduced model settles within some microkelvin of that.
    assert shown["nut_temperature"][-1] == pytest.approx(25.0, abs=1e-4)
    assert shown["table_growth_200mm"][-1] == pytest.approx(11.7e-6 * 0.2 * 2.0, rel=1e-4)


def test_motor_heat_is_that_of_its_law() -> None:
    effect = _made("motor_heat", {"power": 2.0, "at_speed": 750 * RPM, "share_at_rest": 0.4})
    heats = [
        float(effect.heats(Operation(speed * RPM, 0.0, STEP), effect.values)["front"]) for speed in (0.0, 375.0, 750.0)
    ]
    np.testing.assert_allclose(heats, [0.0, 2.0 * (0.4 + 0.6 / 2), 2.0], rtol=1e-12)


@pytest.mark.parametrize("name", STRONG)
def test_plant_text_with_an_effect_reads_back(name: str, tmp_path: Path) -> None:
    effect = _made(name, STRONG[name])
    text = (plants_folder() / "thermal_bench.toml").read_text(encoding="utf-8")
    path = tmp_path / "after.toml"
    path.write_text(plant_text_with_effects(text, [effect]), encoding="utf-8")
    (read,) = read_plant(path).effects
    assert (read.name, read.place, dict(read.values)) == (effect.name, effect.place, dict(effect.values))


def test_effects_of_the_other_kind_are_refused(tmp_path: Path) -> None:
    heat = (plants_folder() / "thermal_bench.toml").read_text(encoding="utf-8")
    axis = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path / "plant.toml"
    path.write_text(heat + '[[effect]]\nname = "backlash"\nwidth = "5 µm"\n', encoding="utf-8")
    with pytest.raises(InputError, match="acts on motion"):
        read_plant(path)
    path.write_text(axis + '[[effect]]\nname = "cooling"\nconductance = "1 W/K"\n', encoding="utf-8")
    with pytest.raises(InputError, match="acts on heat"):
        read_plant(path)


def test_file_of_motion_and_heat_gives_both(tmp_path: Path) -> None:
    heat = (plants_folder() / "thermal_bench.toml").read_text(encoding="utf-8")
    axis = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    path = tmp_path / "both.toml"
    section = heat[heat.index("[thermal]") :]
    path.write_text(axis + section + '[[effect]]\nname = "cooling"\nconductance = "1 W/K"\n', encoding="utf-8")
    plant = read_plant(path)
    assert "cooling" not in [effect.name for effect in plant.motion_effects]
    assert [effect.name for effect in plant.heat.effects] == ["cooling"] and len(plant.heat.sensors) == 5


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('at = "nut" ', 'at = "moon" ', "not possible"),
        ('kind = "scale"', 'kind = "thermometer"', "no channel of a thermometer"),
        ('channel = "table_growth_250mm"', 'channel = "table_growth_200mm"', "same channel"),
    ],
)
def test_wrong_sensor_is_refused(old: str, new: str, told: str, tmp_path: Path) -> None:
    text = (plants_folder() / "thermal_bench.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "plant.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError, match=told):
        read_plant(path)


def test_reading_of_a_deviation_tells_its_direction() -> None:
    reading = READINGS["convection_deviation"]
    assert "More heat" in reading({"factor": 1.2}) and "Less heat" in reading({"factor": 0.8})
    assert math.isfinite(float(reference_torque(0.0)))
