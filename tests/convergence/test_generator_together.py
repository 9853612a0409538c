"""All of the generator's effects at once against scipy's DOP853 with its own right-hand side; a step for every effect.

Free play and bristle, which need the reference to restart, stand alone in test_generator.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from tests.generator import effects as planted
from tests.generator.axis import AXES, BENCH, AxisParameters
from tests.generator.constants import declared_constants
from tests.generator.effects import Effect, PlantedEffects
from tests.generator.examples import examples
from tests.generator.loop import open_loop
from tests.generator.recording import LONGEST_STEP, QUICK_STEP, sampling_of, state_at_rest

Array = npt.NDArray[np.float64]

COUNT = 120
START = 0.1
# As in test_generator.py: a 75th of the noise of the scale.
POSITION_TOLERANCE = 0.2e-9

TOGETHER: tuple[Effect, ...] = (
    planted.CoulombAsymmetry(delta_force=14.0),
    planted.ViscousAsymmetry(delta_viscous=-90.0),
    planted.Stribeck(delta_force=-22.0, velocity=6e-3),
    planted.FrictionVsPosition(peak=41.0, centre=0.101, half_width=0.002),
    planted.ViscousWarmup(port="table", share=0.6, time_constant=0.03),
    planted.FrictionDeviation(port="screw", coulomb_factor=0.7, viscous_factor=1.3),
    planted.LoadDependentFriction(coefficient=0.1),
    planted.TorqueRipple(amplitude=0.4, order=6.0, phase=0.7),
    planted.BallPassRipple(amplitude=0.1, order=7.37, phase=1.1),
    planted.TorqueConstantDroop(share=0.3, at_torque=5.0),
    planted.ConstantForce(force=-28.0),
    planted.PositionSpring(stiffness=3e4, zero=0.099),
    planted.LeadErrorPeriodic(amplitude=20e-6, order=3.0, phase=0.4),
    planted.LeadErrorCumulative(slope=2e-3),
    planted.ThermalGrowth(strain=1e-3, time_constant=0.05),
    planted.StiffnessDeviation(factor=0.8),
    planted.StiffnessVsPosition(share_over_stroke=0.5),
    planted.PreloadLoss(ratio=0.35, force=150.0),
    planted.Payload(mass=22.0),
    planted.InertiaDeviation(where="motor", inertia=4e-4),
    planted.StructuralMode(mass=15.0, frequency=120.0, damping=0.05),
)


def torque_curve(limit: float) -> Array:
    """Return a torque (COUNT,) [N m] that moves the axis both ways."""
    time = np.arange(COUNT) * BENCH.sample_time
    return np.asarray(limit * (0.6 * np.sin(2.0 * math.pi * 30.0 * time) + 0.4 * np.sin(2.0 * math.pi * 83.0 * time)))


def table_force_of_friction(t: float, x: float, v: float) -> float:
    """Return guide friction [N] with everything of TOGETHER that touches it."""
    level = 60.0 - 22.0 * math.exp(-((v / 6e-3) ** 2)) + 41.0 * math.exp(-(((x - 0.101) / 0.002) ** 2))
    level += 14.0 if v > 0.0 else 0.0
    viscous = (210.0 if v > 0.0 else 300.0) * v * (0.4 + 0.6 * math.exp(-t / 0.03))
    return level * math.tanh(v / 0.5e-3) + viscous


def nut(t: float, phi: float, nu: float, x: float, v: float) -> tuple[float, float, float]:
    """Return force in the nut [N], torque on the screw [N m], force on the table [N]."""
    r, g = BENCH.transmission, 2e-3 + 1e-3 * (1.0 - math.exp(-t / 0.05))
    lead = r + 20e-6 * 3.0 * math.cos(3.0 * phi + 0.4)
    e = r * phi + 20e-6 * math.sin(3.0 * phi + 0.4) + g * x - x
    rate = lead * nu - (1.0 - g) * v + 1e-3 / 0.05 * math.exp(-t / 0.05) * x
    k0 = 0.8 * BENCH.axial_stiffness
    # a share of 0.5 lost at the far end: the compliance doubles along the stroke, in a straight line
    k = k0 / (1.0 + (x - 0.04) / 0.32)
    dk = -(k**2) / (k0 * 0.32)
    e1 = 150.0 / (0.35 * k)
    force = 0.35 * k * e if abs(e) < e1 else float(np.sign(e)) * (150.0 + k * (abs(e) - e1))
    pull = 0.35 * e**2 / 2.0 if abs(e) < e1 else (e**2 - 0.65 * e1**2) / 2.0
    force += BENCH.axial_damping * rate
    return force, lead * force, (1.0 - g) * force - dk * pull


def reference_slopes(command: float, start: float) -> Callable[[float, Array], Array]:
    """Return the right-hand side (8,): motor, screw, table and further mass, each position and speed."""
    torque = command * (1.0 - 0.3 * (command / 5.0) ** 2)

    def slopes(t: float, y: Array) -> Array:
        theta, omega, phi, nu, x, v, xm, vm = (float(value) for value in y)
        force, load, push = nut(start + t, phi, nu, x, v)
        twist = BENCH.torsional_stiffness * (theta - phi) + BENCH.torsional_damping * (omega - nu)
        level = 0.7 * 0.35 + 0.1 * abs(force) * BENCH.transmission + 0.1 * math.sin(7.37 * phi + 1.1)
        drag = level * math.tanh(nu / 0.15) + 1.3 * 0.02 * float(np.sign(nu)) * abs(nu) ** (2.0 / 3.0)
        rate = 2.0 * math.pi * 120.0
        mass_force = 15.0 * (rate**2 * (xm - x) + 2.0 * 0.05 * rate * (vm - v))
        table = push - table_force_of_friction(start + t, x, v) + 28.0 - 3e4 * (x - 0.099) + mass_force
        motor = (torque - twist - 0.4 * math.sin(6.0 * theta + 0.7)) / 3.0e-3
        screw = (twist - load - drag) / BENCH.screw_inertia
        return np.array([omega, motor, nu, screw, v, table / 156.0, vm, -mass_force / 15.0])

    return slopes


def reference_run() -> Array:
    """Return the reference states (COUNT + 1, 8)."""
    angle = START / BENCH.transmission
    x = (START + 20e-6 * math.sin(3.0 * angle + 0.4)) / (1.0 - 2e-3)
    states = [np.array([angle, 0.0, angle, 0.0, x, 0.0, x, 0.0])]
    for number, command in enumerate(torque_curve(5.0)):
        slopes = reference_slopes(float(command), number * BENCH.sample_time)
        # Relative to positions of 0.1 m and 30 rad this is 1e-13 m and 3e-11 rad.
        run = solve_ivp(slopes, (0.0, BENCH.sample_time), states[-1], method="DOP853", rtol=1e-12, atol=1e-14)
        assert run.success, run.message
        states.append(run.y[:, -1])
    return np.array(states)


def generated(axis: AxisParameters, effects: tuple[Effect, ...], longest_step: float, limit: float) -> Array:
    """Return the generator's states (COUNT + 1, WIDTH) under the same torque."""
    constants = PlantedEffects(effects).planted(declared_constants(axis))
    sampling = sampling_of(axis, constants, longest_step)
    return open_loop(torque_curve(limit), state_at_rest(START, constants), sampling, constants)


def test_all_together_agree_with_another_integrator() -> None:
    """Table within 0.2 nm, motor within what that is at the motor, further mass within 0.2 nm."""
    reference, states = reference_run(), generated(BENCH, TOGETHER, LONGEST_STEP, 5.0)
    assert np.ptp(reference[:, 4]) > 100e-6, "the torque must move the table"
    assert np.max(np.abs(states[:, 4] - reference[:, 4])) < POSITION_TOLERANCE
    assert np.max(np.abs(states[:, 0] - reference[:, 0])) * BENCH.transmission < POSITION_TOLERANCE
    assert np.max(np.abs(states[:, 4] + states[:, 7] - reference[:, 6])) < POSITION_TOLERANCE


def named(effect: Effect) -> str:
    """Return the effect's name with the word that tells two examples apart."""
    words = [value for value in vars(effect).values() if isinstance(value, str)]
    return "-".join([effect.name, *words])


CASES = [
    pytest.param(axis, effect, id=f"{name}-{named(effect)}") for name, axis in AXES.items() for effect in examples(axis)
]


@pytest.mark.parametrize(("axis", "effect"), CASES)
def test_quick_step_is_small_enough(axis: AxisParameters, effect: Effect) -> None:
    """The step of recordings made on the fly is 1 nm and better, a 15th of the noise of the scale."""
    limit = 0.2 * axis.controller.torque_limit
    quick = generated(axis, (effect,), QUICK_STEP, limit)
    fine = generated(axis, (effect,), 0.5 * LONGEST_STEP, limit)
    assert np.max(np.abs(quick[:, 4] - fine[:, 4])) < 1e-9


# A bristle without deflection would be infinitely stiff.
@pytest.mark.parametrize(("axis", "effect"), [case for case in CASES if "presliding" not in str(case.id)])
def test_an_effect_shows_and_vanishes_with_its_size(axis: AxisParameters, effect: Effect) -> None:
    """An effect of no size leaves the declared equations, exactly; one of the examples' size does not."""
    assert behaviour(axis, effect.scaled(0.0)) == behaviour(axis, None)
    assert behaviour(axis, effect) != behaviour(axis, None)


def behaviour(axis: AxisParameters, effect: Effect | None) -> list[float]:
    """Return the table's positions under the torque curve and the delays, which an open loop does not see."""
    effects = PlantedEffects(() if effect is None else (effect,))
    c = effects.planted(declared_constants(axis))
    delays = [c.drive_delay, c.torque_lateness, c.angle_lateness, c.table_lateness]
    states = generated(axis, effects.effects, LONGEST_STEP, 0.2 * axis.controller.torque_limit)
    return [*states[:, 4].tolist(), *delays]
