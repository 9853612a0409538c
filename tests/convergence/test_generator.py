"""The independent generator against scipy's Radau with its own right-hand side, one test per structural family.

Both see the same torque: a smooth curve held over 1 ms. The reference restarts at every sample, because the held
torque jumps there, and at every contact of the free play.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from tests.generator.axis import BENCH
from tests.generator.constants import declared_constants
from tests.generator.effects import Backlash, Effect, LeadErrorPeriodic, PlantedEffects, Presliding
from tests.generator.loop import Sampling, open_loop
from tests.generator.recording import sampling_of
from tests.generator.state import State

Array = npt.NDArray[np.float64]

SAMPLE = 1e-3
COUNT = 90
# Invisible in a recording: a 75th of the noise of the scale, a 50th of its step.
POSITION_TOLERANCE = 0.2e-9
# What 0.2 nm of table travel is at the motor.
ANGLE_TOLERANCE = POSITION_TOLERANCE / BENCH.transmission

FAMILIES = {
    "plain": None,
    "backlash": Backlash(width=7.5e-6),
    "presliding": Presliding(stiffness=5.5e6),
    "lead_error": LeadErrorPeriodic(amplitude=20e-6, order=3.0, phase=0.4),
}


def torque_curve() -> Array:
    """Return a torque (COUNT,) [N m] that moves the axis both ways, through stiction and through the free play."""
    time = np.arange(COUNT) * SAMPLE
    return np.asarray(2.5 * np.sin(2.0 * math.pi * 22.0 * time) + 1.2 * np.sin(2.0 * math.pi * 61.0 * time))


def reference_bristle(z: float, v: float, stiffness: float) -> float:
    """Return dz/dt [m/s] of the elasto-plastic bristle on the bench guide, written from the paper's equations."""
    steady = BENCH.guide_coulomb / stiffness
    elastic = 0.8 * steady
    if np.sign(z) != np.sign(v) or abs(z) <= elastic:
        return v
    if abs(z) >= steady:
        return v * (1.0 - abs(z) / steady)
    alpha = 0.5 * (1.0 + math.sin(math.pi * (abs(z) - (steady + elastic) / 2.0) / (steady - elastic)))
    return v * (1.0 - alpha * abs(z) / steady)


def reference_slopes(effect: Effect | None, torque: float, flank: int) -> Callable[[float, Array], Array]:
    """Return the right-hand side (7,) in the order of the generator's state, for a held torque and a contact flank."""
    r = BENCH.transmission
    lead = effect if isinstance(effect, LeadErrorPeriodic) else LeadErrorPeriodic(0.0, 1.0)
    gap = effect.width if isinstance(effect, Backlash) else 0.0

    def slopes(_: float, y: Array) -> Array:
        theta, omega, phi, nu, x, v, z = (float(value) for value in y)
        ratio = r + lead.amplitude * lead.order * math.cos(lead.order * phi + lead.phase)
        e = r * phi + lead.amplitude * math.sin(lead.order * phi + lead.phase) - x
        touching = gap == 0.0 or flank != 0
        force = BENCH.axial_stiffness * (e - flank * gap / 2.0) + BENCH.axial_damping * (ratio * nu - v)
        force = force if touching else 0.0
        twist = BENCH.torsional_stiffness * (theta - phi) + BENCH.torsional_damping * (omega - nu)
        drag = (BENCH.nut_coulomb + BENCH.bearing_coulomb) * math.tanh(nu / BENCH.drag_speed)
        drag += BENCH.nut_power * float(np.sign(nu)) * abs(nu) ** (2.0 / 3.0)
        rate, shape = 0.0, BENCH.guide_coulomb * math.tanh(v / BENCH.guide_velocity)
        if isinstance(effect, Presliding):
            rate = reference_bristle(z, v, effect.stiffness)
            shape = effect.stiffness * z + effect.damping * rate
        table = (force - shape - BENCH.guide_viscous * v) / BENCH.table_mass
        motor = (torque - twist) / BENCH.motor_inertia
        return np.array([omega, motor, nu, (twist - ratio * force - drag) / BENCH.screw_inertia, v, table, rate])

    return slopes


def flank_event(boundary: float, direction: float) -> Callable[[float, Array], float]:
    """Return a terminal event of solve_ivp: nut travel minus table position passes `boundary` [m] in `direction`."""

    def distance(_: float, y: Array) -> float:
        return float((BENCH.transmission * y[2] - y[4] - boundary) * 1e6)

    distance.terminal = True  # type: ignore[attr-defined]
    # A direction, so that the flank just passed does not fire again at the restart.
    distance.direction = direction  # type: ignore[attr-defined]
    return distance


def flank_events(gap: float, flank: int) -> list[Callable[[float, Array], float]]:
    """Return what can end the present contact or play of total width `gap` [m]."""
    if gap == 0.0:
        return []
    if flank:
        return [flank_event(0.5 * gap * flank, -flank)]
    return [flank_event(-0.5 * gap, -1.0), flank_event(0.5 * gap, 1.0)]


def reference_sample(effect: Effect | None, torque: float, state: Array, flank: int) -> tuple[Array, int, int]:
    """Return state, flank and number of flank changes one sample later, by Radau restarted at every change."""
    gap = effect.width if isinstance(effect, Backlash) else 0.0
    start, changes = 0.0, 0
    while True:
        run = solve_ivp(
            reference_slopes(effect, torque, flank),
            (start, SAMPLE),
            state,
            method="Radau",
            rtol=1e-9,
            # Absolute: 1e-14 m and rad are far below the tolerances of this test.
            atol=1e-14,
            events=flank_events(gap, flank),
        )
        assert run.success, run.message
        state = run.y[:, -1]
        if run.status == 0:
            return state, flank, changes
        start, changes = float(run.t[-1]), changes + 1
        touched = -1 if run.t_events[0].size else 1
        flank = 0 if flank else touched


def reference_run(effect: Effect | None) -> tuple[Array, int]:
    """Return the reference states (COUNT + 1, 7) and the number of flank changes."""
    states = [np.zeros(7)]
    flank, changes = 0, 0
    for torque in torque_curve():
        state, flank, more = reference_sample(effect, float(torque), states[-1], flank)
        changes += more
        states.append(state)
    return np.array(states), changes


def generated_run(effect: Effect | None, refine: int = 1) -> Array:
    """Return the generator's states (COUNT + 1, WIDTH) under the same torque, its step divided by `refine`."""
    effects = PlantedEffects(() if effect is None else (effect,))
    constants = effects.planted(declared_constants(BENCH))
    step = sampling_of(BENCH, constants).longest_step / refine
    sampling = Sampling(SAMPLE, step, 1e-6, 0.0, 0.0, 1.0, 30.0)
    return open_loop(torque_curve(), State(*[0.0] * 6), sampling, constants)


@pytest.mark.parametrize("family", FAMILIES)
def test_agrees_with_radau(family: str) -> None:
    """Table position within 0.2 nm of Radau at rtol 1e-9, motor angle within what that is at the motor."""
    effect = FAMILIES[family]
    reference, changes = reference_run(effect)
    states = generated_run(effect)
    assert np.ptp(reference[:, 4]) > 20e-6, "the torque must move the table"
    assert changes >= (4 if family == "backlash" else 0), "the free play must be crossed"
    assert np.max(np.abs(states[:, 4] - reference[:, 4])) < POSITION_TOLERANCE
    assert np.max(np.abs(states[:, 0] - reference[:, 0])) < ANGLE_TOLERANCE


@pytest.mark.parametrize("family", FAMILIES)
def test_step_is_small_enough(family: str) -> None:
    """Half the step changes the table position by less than a tenth of the tolerance against Radau."""
    effect = FAMILIES[family]
    difference = generated_run(effect)[:, 4] - generated_run(effect, refine=2)[:, 4]
    assert np.max(np.abs(difference)) < 0.1 * POSITION_TOLERANCE
