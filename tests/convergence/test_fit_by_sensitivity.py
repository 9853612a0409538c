"""Values of a drive found again from a recorded run, from starts up to four times wrong: every one arrives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.shaft_drag import NutDrag
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled import SampledController
from feeddrive.simulate.controlled.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.output_error import OutputErrorFit, fit_recorded_run
from feeddrive.simulate.recorded_run import RecordedRun, with_values
from feeddrive.typing import FloatArray
from tests.convergence.test_controlled import SAMPLE, cascade
from tests.convergence.test_simulate import BENCH

TRUE = {
    "table_mass": 134.0, "motor_inertia": 2.6e-3, "torsional_stiffness": 11_982.4, "axial_stiffness": 244.7e6,
    "guide_friction.coulomb": 60.0, "guide_friction.viscous": 300.0, "presliding.stiffness": 5e6,
    "nut_drag.viscous": 0.02,
}  # fmt: skip
LOOP = TorqueLoop(lag=2.5e-4)
NOISE = {"table_position": 20e-9, "command": 0.02}
"""White noise of a good scale [m] and of a torque signal [N m]."""


def plant(values: dict[str, float]) -> Plant:
    chain = replace(BENCH, values={**BENCH.values, **{key: values[key] for key in values if "." not in key}})
    guide = GuideFriction.of(
        coulomb=values["guide_friction.coulomb"], smoothing_velocity=1e-3, viscous=values["guide_friction.viscous"]
    )
    bristle = Presliding.of(stiffness=values["presliding.stiffness"], damping=2e3, break_away=0.5)
    drag = NutDrag.of(coulomb=0.25, smoothing_speed=0.3, viscous=values["nut_drag.viscous"])
    return Plant("drive", chain, (guide, bristle, drag), torque_limit=18.0)


def controller() -> SampledController:
    """Gains with which an axis four times lighter or softer is stable too, so that no trial run meets the limit."""
    return cascade().with_parameters(np.array([10.0, 0.2, 0.2 * SAMPLE / 0.1]))


def stroke(count: int) -> FloatArray:
    """Position and velocity of four sines, slow to fast, from rest."""
    time, total = SAMPLE * np.arange(count), np.zeros((count, 2))
    for frequency, amplitude in ((1.0, 0.03), (7.0, 1.5e-3), (31.0, 2e-4), (83.0, 5e-5)):
        turn = 2 * np.pi * frequency
        total += amplitude * np.column_stack([1 - np.cos(turn * time), turn * np.sin(turn * time)])
    return total


def recorded(true: Plant, count: int, seed: int) -> RecordedRun:
    """A run of the true plant with its noise; below the limit, at which it would jump with its values."""
    reference, generator = stroke(count), np.random.default_rng(seed)
    run = simulate_controlled(true, controller(), reference, None, LOOP)
    assert np.abs(run.command).max() < 18.0
    channels = {key: getattr(run, key) + noise * generator.standard_normal(count) for key, noise in NOISE.items()}
    return RecordedRun(controller(), reference, channels, NOISE, LOOP)


def wrong(true: Plant, values: dict[str, float], seed: int) -> Plant:
    """The plant with every value up to four times too small or too large."""
    factors = 4.0 ** np.random.default_rng(seed).uniform(-1, 1, len(values))
    return with_values(true, {key: value * float(f) for (key, value), f in zip(values.items(), factors, strict=True)})


def misses(fit: OutputErrorFit, values: dict[str, float]) -> list[str]:
    """Values that are further off than five of the standard deviations that the fit tells."""
    return [key for key, value in values.items() if abs(np.log(fit.values[key] / value)) > 5 * fit.deviation[key]]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_eight_values_from_four_times_wrong(seed: int) -> None:
    true = plant(TRUE)
    fit = fit_recorded_run(wrong(true, TRUE, seed), recorded(true, 2000, 7), list(TRUE))
    print(f"{seed}: mean square {fit.mean_square:.3f}, {fit.starts} starts, {fit.runs} runs")
    # the noise is white, so the mean square of the error over it is 1 within 5 standard errors of sqrt(2/4000)
    assert fit.converged and abs(fit.mean_square - 1) < 5 * np.sqrt(2 / 4000)
    assert misses(fit, TRUE) == []


LIGHTER = {
    "table_mass": 40.0, "axial_stiffness": 90e6, "guide_friction.coulomb": 25.0, "guide_friction.viscous": 150.0
}  # fmt: skip


@pytest.mark.parametrize("seed", range(3))
def test_four_values_of_a_lighter_axis_from_four_times_wrong(seed: int) -> None:
    """Another axis, other noise, half a second: nothing is made for the one above."""
    true = plant(TRUE | LIGHTER)
    fit = fit_recorded_run(wrong(true, LIGHTER, 100 + seed), recorded(true, 1000, seed), list(LIGHTER))
    assert fit.converged and misses(fit, LIGHTER) == []


def test_a_recording_that_no_value_explains_is_no_convergence() -> None:
    true = plant(TRUE)
    run = recorded(true, 400, 1)
    disturbed = {**run.channels, "command": run.channels["command"] + np.sin(0.3 * np.arange(400))}
    fit = fit_recorded_run(true, replace(run, channels=disturbed), ["table_mass"], starts=3)
    assert not fit.converged and fit.starts == 3


def test_what_cannot_be_fitted_is_refused() -> None:
    true = plant(TRUE)
    run = recorded(true, 100, 1)
    with pytest.raises(InputError, match="is no value above zero"):
        fit_recorded_run(true, run, ["bearing_drag.coulomb"])
    with pytest.raises(InputError, match="no noise of"):
        replace(run, noise={"command": 0.02})
    with pytest.raises(InputError, match="cannot be used"):
        replace(run, channels={"torqe": run.channels["command"]})
    with pytest.raises(InputError, match="unknown parameter"):
        with_values(true, {"table_weight": 3.0})
