"""Exact slopes of a heat run against central differences of the same run, for every parameter of every effect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.linalg

from feeddrive.effects.base import Effect, Value
from feeddrive.effects.catalogue import THERMAL_EFFECTS
from feeddrive.thermal.laws.laws import laws_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.heat_propagators import propagator
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.run.heat_sensitivity import simulate_with_slopes
from feeddrive.thermal.run.warm_up import simulate
from tests.analytic.test_thermal_effects import AMBIENT, NEUTRAL, PLACE, SPEEDS, STEP, STRONG
from tests.analytic.thermal_cases import BENCH, with_effects

Values = Mapping[str, Value]
CASES: list[tuple[str, Values]] = [
    *((name, STRONG[name]) for name in NEUTRAL if name != "cooling"),
    ("cooling", {"conductance": 0.1, "start": 1010.0}),
    ("ambient_drift", {"amplitude": 1.0, "time": (0.0, 1500.0, 4500.0), "shape": (0.0, 0.4, -0.2)}),
]
OTHER = THERMAL_EFFECTS["preload_growth"].of(coefficient=0.01)
"""Beside the effect in question, so that a heat follows the nut."""


@cache
def bare() -> HeatModel:
    """The bench, reduced."""
    return reduce_model([BENCH.full_model()], BENCH.limits(3.0))[0]


def with_bodies(plant: Heat) -> HeatModel:
    """The reduced bench with what effects attach."""
    model = bare()
    for body in plant.attached:
        model = model.with_body(body)
    return model


def series(effect: Effect) -> dict[str, np.ndarray]:
    """Channels of the bench with an effect."""
    plant = with_effects(OTHER, effect)
    return simulate(plant, with_bodies(plant), STEP, SPEEDS, AMBIENT)


def moved(effect: Effect, key: str, by: float) -> Effect:
    """The effect with one number changed; `key[i]` is an entry of a table."""
    name, _, index = key.rstrip("]").partition("[")
    value = effect.values[name]
    if isinstance(value, tuple):
        table = [v + by * (i == int(index)) for i, v in enumerate(value)]
        return effect.with_values(**{name: tuple(table)})
    return effect.with_values(**{name: value + by})


@pytest.mark.parametrize(("name", "values"), CASES, ids=[f"{name}-{len(values)}" for name, values in CASES])
def test_slopes_are_those_of_the_run(name: str, values: Values) -> None:
    effect = THERMAL_EFFECTS[name].of(None, PLACE.get(name, ""), **values)
    plant = with_effects(OTHER, effect)
    label = plant.effects[-1].label
    keys = [n.split(".", 1)[1] for n in laws_of(plant).names if n.startswith(f"{label}.") and ".time[" not in n]
    shown = simulate_with_slopes(plant, with_bodies(plant), STEP, SPEEDS, AMBIENT, [f"{label}.{key}" for key in keys])
    for channel, plain in series(effect).items():
        np.testing.assert_allclose(shown[channel][0], plain, rtol=1e-9, atol=1e-13)  # another exponential, rounding
    for i, key in enumerate(keys):
        parameter = effect.parameter(key.split("[")[0])
        step = 1e-4 * min(parameter.size, 100.0)
        up, down = (series(moved(effect, key, way * step)) for way in (1, -1))
        for channel, (_, slopes) in shown.items():
            difference = (up[channel] - down[channel]) / (2 * step)
            # Groups of rows share the mean of conductances that agree to 0.2 %: 1e-4 of a slope. Curvature over the
            # step: below it. Rounding: 23 degC or micrometres in 1e-16, over the step.
            least = (1e-13 if "growth" not in channel else 1e-20) / step
            np.testing.assert_allclose(slopes[:, i], difference, rtol=0, atol=1e-4 * np.ptp(difference) + 10 * least)


def test_declared_values_have_slopes_too() -> None:
    wanted = ["nut.load_torque", "nut.viscosity", "film.nut_free", "contact.conductance"]
    shown = simulate_with_slopes(BENCH, bare(), STEP, SPEEDS, AMBIENT, wanted)
    step = 1e-3
    lower, upper = (simulate(_scaled(way * step), bare(), STEP, SPEEDS, AMBIENT) for way in (-1, 1))
    for channel, (_, slopes) in shown.items():
        difference = (upper[channel] - lower[channel]) / (2 * step * BENCH.nut.load_torque)
        np.testing.assert_allclose(slopes[:, 0], difference, atol=1e-6 * np.ptp(difference))  # the run is linear in it
        assert np.all(np.isfinite(slopes)) and np.all(np.ptp(slopes, axis=0) > 0)


def _scaled(by: float) -> Heat:
    return replace(BENCH, nut=replace(BENCH.nut, load_torque=BENCH.nut.load_torque * (1 + by)))


def test_propagator_is_the_exponential(generator: np.random.Generator) -> None:
    half = generator.standard_normal((6, 6))
    matrix, gains = half @ half.T + 0.1 * np.eye(6), generator.standard_normal((6, 2))
    shown = propagator(matrix, gains, 0.3)
    exponential = scipy.linalg.expm(-0.3 * matrix)
    np.testing.assert_allclose(shown.propagator, exponential, atol=1e-12)  # rounding
    np.testing.assert_allclose(shown.input_map, np.linalg.solve(matrix, (np.eye(6) - exponential) @ gains), atol=1e-12)
