"""Eight values of a drive found again from a recording, from starts up to four times wrong: four of five arrive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from feeddrive.compiler import find_compiler
from feeddrive.effects.guide_friction import GuideFriction
from feeddrive.effects.presliding import Presliding
from feeddrive.effects.shaft_drag import NutDrag
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled import SampledController
from feeddrive.simulate.controlled import TorqueLoop, simulate_controlled
from feeddrive.simulate.sensitivity import simulate_sensitivity
from feeddrive.simulate.step_constants import SimulationError
from feeddrive.typing import FloatArray
from tests.convergence.test_controlled import SAMPLE, cascade
from tests.convergence.test_simulate import BENCH

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="no C compiler here")

TRUE = {
    "table_mass": 134.0, "motor_inertia": 2.6e-3, "torsional_stiffness": 11_982.4, "axial_stiffness": 244.7e6,
    "guide_friction.coulomb": 60.0, "guide_friction.viscous": 300.0, "presliding.stiffness": 5e6,
    "nut_drag.viscous": 0.02,
}  # fmt: skip
LOOP = TorqueLoop(lag=2.5e-4)
NOISE = {"table_position": 20e-9, "command": 0.02}
"""White noise of a good scale [m] and of a torque signal [N m]."""


STAGES = (100e-6, 10e-6, 1e-6, 100e-9, 20e-9)
"""Weights of the position [m], far from the solution to near it: at first the torque leads, which is nearly linear."""


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


@pytest.mark.slow
def test_fits_from_values_four_times_wrong() -> None:
    reference, names = stroke(2000), list(TRUE)
    generator = np.random.default_rng(7)
    recorded = simulate_controlled(plant(TRUE), controller(), reference, None, LOOP)
    assert np.abs(recorded.command).max() < 18.0  # a limit that is reached makes the run jump with its values
    measured = {
        key: getattr(recorded, key) + noise * generator.standard_normal(len(reference)) for key, noise in NOISE.items()
    }

    def values(logs: FloatArray) -> dict[str, float]:
        return {name: float(value) for name, value in zip(names, np.exp(logs), strict=True)}

    def found(logs: FloatArray, weights: dict[str, float]) -> tuple[FloatArray, FloatArray]:
        """Residual over weights and its Jacobian in the logarithms of the values."""
        now = values(logs)
        try:
            run = simulate_sensitivity(plant(now), controller(), reference, names, torque_loop=LOOP)
        except SimulationError:
            return np.full(2 * len(reference), 1e6), np.zeros((2 * len(reference), len(names)))
        residual = np.concatenate([(getattr(run.run, key) - measured[key]) / noise for key, noise in weights.items()])
        columns = [
            np.concatenate([run.changes[name][key] * now[name] / noise for key, noise in weights.items()])
            for name in names
        ]
        return residual, np.column_stack(columns)

    truth = np.log(np.array(list(TRUE.values())))
    reached = []
    for seed in range(5):
        start = truth + np.log(4.0) * np.random.default_rng(seed).uniform(-1, 1, len(names))
        at = start
        for position in STAGES:
            weights = {**NOISE, "table_position": position}
            fit = least_squares(
                lambda x, w=weights: found(x, w)[0], at, lambda x, w=weights: found(x, w)[1],
                bounds=(truth - 3, truth + 3), max_nfev=200,
            )  # fmt: skip
            at = fit.x
        reached.append(2 * fit.cost / (2 * len(reference)))
        worst = np.exp(np.abs(fit.x - truth).max()) - 1
        print(f"{seed}: chi2 {reached[-1]:.3f}, {fit.nfev} runs, worst value {worst:.2%}")
    # the noise is white, so the mean square of the weighted residual is 1 within 5 standard errors of sqrt(2/4000).
    # One start of the five (the last) ends in a valley where stiffness and bristle stand in for each other.
    assert sum(chi2 < 1.12 for chi2 in reached) >= 4, reached
