"""Passivity, sticking and impact: what a right simulation never does, whatever the steps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from feeddrive.effects.base import Effect
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.effects.friction.shaft_drag import NutDrag
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.engine.program import Position
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.controlled import ControlledRun, ControlledState, resting_state, simulate_controlled
from tests.convergence.test_controlled import cascade
from tests.convergence.test_simulate import BENCH

GUIDE = GuideFriction.of(coulomb=60.0, smoothing_velocity=5e-4, viscous=300.0)
SETS: dict[str, tuple[Effect, ...]] = {
    "none": (),
    "guide": (GUIDE, NutDrag.of(coulomb=0.25, smoothing_speed=0.15, viscous=0.02)),
    "stribeck": (GUIDE, Stribeck.of(delta_force=30.0, velocity=5e-3)),
    "bump": (GUIDE, FrictionVsPosition.of(peak=40.0, centre=0.0, half_width=0.01)),
    "bristle": (GUIDE, Presliding.of(stiffness=2e7, damping=2e3, break_away=0.8)),
    "play": (Backlash.of(width=8e-6),),
    "play and guide": (Backlash.of(width=8e-6), GUIDE),
}
"""Dissipative and conservative effects; one structure each, so that the binaries are few."""


def silent() -> SampledController:
    """A controller that asks for no torque: the cascade with its gains at zero."""
    return replace(cascade(), parameters=np.zeros(3))


def free_run(plant: Plant, state: np.ndarray, count: int, load: np.ndarray | None = None) -> ControlledRun:
    """Motor off, from a state of the chain."""
    begin = resting_state(plant, silent())
    memory = begin.position.memory.copy()
    memory[: len(state)] = state
    start = ControlledState(0, Position(memory, begin.position.own))
    return simulate_controlled(plant, silent(), np.zeros((count, 2)), load, start=start)


def stored(plant: Plant, run: ControlledRun) -> np.ndarray:
    """Kinetic energy, and that of the springs, free play and bristle [J], shape (n,)."""
    v, r = plant.chain.values, plant.chain.radius
    theta, phi, x, dtheta, dphi, dx = run.states.T[:6]
    play = sum(float(e.values["width"]) for e in plant.effects if isinstance(e, Backlash))  # type: ignore[arg-type]
    stretch = np.maximum(np.abs(r * phi - x) - play / 2, 0)
    energy = v["motor_inertia"] * dtheta**2 + v["screw_inertia"] * dphi**2 + v["table_mass"] * dx**2
    energy += v["torsional_stiffness"] * (theta - phi) ** 2 + v["axial_stiffness"] * stretch**2
    for i, bristle in enumerate(e for e in plant.effects if isinstance(e, Presliding)):
        energy += float(bristle.values["stiffness"]) * run.states[:, 6 + i] ** 2  # type: ignore[arg-type]
    return energy / 2


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(
    st.sampled_from(list(SETS)), st.floats(0.3, 3), st.floats(0.3, 3), st.floats(0.1, 5), st.floats(-100, 100),
    st.floats(-100, 100), st.floats(-0.3, 0.3), st.floats(-2e-3, 2e-3), st.floats(-2e-5, 2e-5),
)  # fmt: skip
def test_energy_never_rises_with_the_motor_off(
    effects: str, mass: float, stiffness: float, damping: float, motor: float, screw: float, table: float, twist: float,
    stretch: float,
) -> None:  # fmt: skip
    v = BENCH.values
    values = {**v, "table_mass": mass * v["table_mass"], "axial_stiffness": stiffness * v["axial_stiffness"]}
    values |= {"axial_damping": damping * v["axial_damping"], "motor_inertia": mass * v["motor_inertia"]}
    plant = Plant("free", ThreeInertias(values), SETS[effects])
    run = free_run(plant, np.array([twist, 0.0, -stretch, motor, screw, table]), 80)
    energy = stored(plant, run)
    assert len(run.states.T) == 6 + bristle_count(plant)
    # a step may err by 0.01 nm and 1 nm/s, a sample by ten of each, against the largest force and momentum of the run
    rate = math.sqrt(2 * energy[0] / values["table_mass"])
    momentum, force = values["table_mass"] * rate, math.sqrt(2 * energy[0] * values["axial_stiffness"])
    assert np.diff(energy).max() <= 1e-8 * momentum + 1e-10 * force + 1e-12 * energy[0] + 1e-15


def ramped(share: float, count: int, shake: float) -> np.ndarray:
    """Load below break-away, laid on in a second, with a shake of 50 Hz [N]."""
    time = 5e-4 * np.arange(count)
    return share * 60.0 * np.minimum(time, 1.0) + shake * np.sin(2 * math.pi * 50 * time) * (time > 1)


@pytest.mark.parametrize("shake", [0.0, 35.0])
def test_bristle_holds_a_load_for_a_minute(shake: float) -> None:
    """Below break-away the table rests where it is: 1 nm from 10 s to 60 s, also when shaken by about 1 um."""
    guide = GuideFriction.of(coulomb=60.0, smoothing_velocity=1e-3, viscous=300.0)
    plant = Plant("held", BENCH, (guide, Presliding.of(stiffness=5e6, damping=5e4, break_away=0.7)))
    count = 120_000
    run = free_run(plant, np.zeros(6), count, ramped(0.5, count, shake))
    period = run.table_position[20_000:].reshape(-1, 40)  # whole periods of the shake
    assert np.ptp(period.mean(axis=1)) <= 1e-9
    if shake:
        assert 0.8e-6 < np.ptp(period[-1]) < 1.4e-6  # the inertia takes most of the 35 N


def test_momentum_through_an_impact() -> None:
    """Nothing but the nut acts: J w / r of the shafts and m v of the table together stay as they are."""
    plant = Plant("free", BENCH, (Backlash.of(width=8e-6),))
    run = free_run(plant, np.array([0.0, 0.0, 0.0, 10.0, 10.0, 0.0]), 400)
    v, r = BENCH.values, BENCH.radius
    _, _, _, dtheta, dphi, dx = run.states.T
    assert np.abs(dx).max() > 1e-2  # the table was hit
    momentum = (v["motor_inertia"] * dtheta + v["screw_inertia"] * dphi) / r + v["table_mass"] * dx
    assert np.abs(momentum - momentum[0]).max() <= 1e-9 * abs(momentum[0])
