"""The generator's torques, forces, masses and frictions against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from tests.analytic.frictionless import DAMPED, FRICTIONLESS, SAMPLE, momentum, moving, run, total_inertia
from tests.generator.axis import BENCH
from tests.generator.constants import Constants, declared_constants
from tests.generator.effects import (
    BallPassRipple,
    ConstantForce,
    Effect,
    InertiaDeviation,
    LoadDependentFriction,
    Payload,
    PlantedEffects,
    PositionSpring,
    StructuralMode,
    TorqueConstantDroop,
    TorqueRipple,
    ViscousWarmup,
)
from tests.generator.state import State

R = BENCH.transmission


def planted(constants: Constants, *effects: Effect) -> Constants:
    """Return `constants` with the effects."""
    return PlantedEffects(effects).planted(constants)


@pytest.mark.parametrize(
    ("effect", "inertia"),
    [
        (Payload(22.0), R**2 * 22.0),
        (InertiaDeviation("motor", 4e-4), 4e-4),
        (InertiaDeviation("screw", -5e-4), -5e-4),
        (StructuralMode(15.0, 120.0, 0.03), R**2 * 15.0),
    ],
)
def test_torque_accelerates_every_mass(effect: Effect, inertia: float) -> None:
    """A torque T raises the momentum of all masses together by T t, whatever swings between them."""
    constants = planted(DAMPED, effect)
    bare = BENCH.motor_inertia + BENCH.screw_inertia + R**2 * BENCH.table_mass
    assert total_inertia(constants) == pytest.approx(bare + inertia, rel=1e-12)
    states = run(constants, moving(0.0, constants), 3.0, 0.1)
    # Rounding of some ten thousand steps.
    assert momentum(states, constants)[-1] == pytest.approx(0.3, rel=1e-9)
    # The table's mean acceleration; what still swings is worth 30 µm of 38 mm.
    travel = 0.5 * R * 3.0 / (bare + inertia) * 0.1**2
    assert states[-1, 4] - states[0, 4] == pytest.approx(travel, rel=2e-3)


@pytest.mark.parametrize("torque", [6.0, -6.0])
def test_droop(torque: float) -> None:
    """What acts is T (1 - share (T / at)^2): 8 % at 10 N m are 2.88 % at 6 N m, both ways."""
    constants = planted(DAMPED, TorqueConstantDroop(share=0.08, at_torque=10.0))
    states = run(constants, moving(0.0, constants), torque, 0.1)
    assert momentum(states, constants)[-1] == pytest.approx(torque * 0.9712 * 0.1, rel=1e-9)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("kind", [TorqueRipple, BallPassRipple])
def test_ripples_at_constant_speed(kind: type[TorqueRipple] | type[BallPassRipple], direction: float) -> None:
    """At 50 rad/s the momentum swings by A / (n w) (cos - cos); what passes balls resists either way."""
    amplitude, order, phase = 0.02, 7.37, 1.1
    constants = planted(DAMPED, kind(amplitude, order, phase))
    speed = direction * 50.0
    start = moving(speed * R, constants)
    states = run(constants, start, 0.0, 0.2)
    angle = states[:, 0 if kind is TorqueRipple else 2]
    swing = amplitude / (order * speed) * (np.cos(order * angle + phase) - math.cos(order * start.angle + phase))
    swing *= direction if kind is BallPassRipple else 1.0
    found = momentum(states, constants) - momentum(states[:1], constants)
    # The speed itself swings by 3e-4.
    assert np.max(np.abs(found - swing)) < 1e-3 * np.ptp(swing)


def resting_on(constants: Constants, velocity: float, force: float, torque: float) -> State:
    """Return the moving state in which the springs carry `force` [N] in the nut and `torque` [N m] in the shaft."""
    unloaded = moving(velocity, constants)
    screw = unloaded.screw_angle + force / constants.axial_stiffness / R
    return unloaded._replace(screw_angle=screw, angle=screw + torque / constants.torsional_stiffness)


@pytest.mark.parametrize("velocity", [0.1, -0.1])
@pytest.mark.parametrize("force", [400.0, -400.0])
def test_load_dependent_friction(velocity: float, force: float) -> None:
    """Pushing F at constant speed asks r F (1 + mu), and r F (1 - mu) when F drives: efficiencies of a screw."""
    constants = planted(FRICTIONLESS, LoadDependentFriction(0.08), ConstantForce(force))
    torque = R * force * (1.0 + 0.08 * math.copysign(1.0, velocity * force))
    start = resting_on(constants, velocity, force, torque)
    states = run(constants, start, torque, 0.1)
    assert np.max(np.abs(states[:, 5] - velocity)) < 1e-9 * abs(velocity)


def test_spring_balances_a_torque() -> None:
    """Held by T = r K (x - zero), the axis stays."""
    constants = planted(FRICTIONLESS, PositionSpring(stiffness=2e4, zero=0.04))
    force = 2e4 * (0.1 - 0.04)
    states = run(constants, resting_on(constants, 0.0, force, R * force), R * force, 0.1)
    assert np.max(np.abs(states[:, 4] - 0.1)) < 1e-12


def test_warm_up_of_the_guide() -> None:
    """Coasting under B v alone: ln v falls by B r^2 / J times the time that the warming leaves."""
    share, tau, seconds, viscous = 0.6, 0.08, 0.3, 2000.0
    warm = ViscousWarmup(port="table", share=share, time_constant=tau)
    constants = planted(DAMPED, warm)._replace(guide_viscous=viscous)
    states = run(constants, moving(0.2, constants), 0.0, seconds)
    left = (1.0 - share) * seconds + share * tau * (1.0 - math.exp(-seconds / tau))
    expected = total_inertia(constants) / R * 0.2 * math.exp(-viscous * R**2 / total_inertia(constants) * left)
    # Springs let the table lag behind the motor: 1e-5 of the speed.
    assert momentum(states, constants)[-1] == pytest.approx(expected, rel=1e-4)


def test_warm_up_of_the_nut() -> None:
    """Coasting under p w^(2/3) alone: w^(1/3) falls by p / (3 J) times the time that the warming leaves."""
    share, tau, seconds, power = 0.6, 0.08, 0.3, 0.02
    warm = ViscousWarmup(port="screw", share=share, time_constant=tau)
    constants = planted(DAMPED, warm)._replace(nut_power=power)
    start = moving(0.2, constants)
    states = run(constants, start, 0.0, seconds)
    left = (1.0 - share) * seconds + share * tau * (1.0 - math.exp(-seconds / tau))
    root = start.screw_speed ** (1.0 / 3.0) - power / 3.0 / total_inertia(constants) * left
    # As above.
    assert momentum(states, constants)[-1] == pytest.approx(total_inertia(constants) * root**3, rel=1e-4)


def test_one_port_warms() -> None:
    """Warming at one port leaves the other port's drag as declared."""
    declared = declared_constants(BENCH)
    table = planted(declared, ViscousWarmup("table", 0.5, 4.0))
    assert (table.guide_warmup, table.nut_warmup) == (0.5, 0.0)
    screw = planted(declared, ViscousWarmup("screw", 0.5, 4.0))
    assert (screw.guide_warmup, screw.nut_warmup) == (0.0, 0.5)


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_structural_mode_swings_at_its_frequency(mode: int) -> None:
    """Let go in a mode of the four masses, the axis swings as cos(w t) with that mode's frequency from M and K."""
    constants = planted(FRICTIONLESS, StructuralMode(mass=30.0, frequency=90.0, damping=0.0))
    kt, ka, km = constants.torsional_stiffness, constants.axial_stiffness, 30.0 * (2.0 * math.pi * 90.0) ** 2
    stiffness = np.array(
        [
            [kt, -kt, 0.0, 0.0],
            [-kt, kt + ka * R**2, -ka * R, 0.0],
            [0.0, -ka * R, ka + km, -km],
            [0.0, 0.0, -km, km],
        ]
    )
    masses = np.diag([BENCH.motor_inertia, BENCH.screw_inertia, BENCH.table_mass, 30.0])
    squares, shapes = eigh(stiffness, masses)
    rate = math.sqrt(squares[mode])
    angle, screw, table, further = shapes[:, mode] * 1e-5 / np.max(np.abs(shapes[2:, mode]))
    states = run(constants, State(angle, 0.0, screw, 0.0, table, 0.0, 0.0, further - table), 0.0, 0.05)
    expected = further * np.cos(rate * SAMPLE * np.arange(states.shape[0]))
    # Of 10 µm: the rounding of the eigenvector and the scheme's phase error.
    assert np.max(np.abs(states[:, 4] + states[:, 7] - expected)) < 1e-5 * abs(further)


def test_structural_mode_with_the_table_held_has_the_named_frequency() -> None:
    """On a table a million times as heavy, the further mass swings at its own frequency and decays at damping w."""
    constants = planted(FRICTIONLESS, StructuralMode(mass=30.0, frequency=90.0, damping=0.05))
    constants = constants._replace(table_mass=3e7)
    states = run(constants, moving(0.0, constants)._replace(mass_deflection=1e-5), 0.0, 0.05)
    rate, time = 2.0 * math.pi * 90.0, SAMPLE * np.arange(states.shape[0])
    damped = rate * math.sqrt(1.0 - 0.05**2)
    expected = np.exp(-0.05 * rate * time) * (np.cos(damped * time) + 0.05 * rate / damped * np.sin(damped * time))
    # The table is not quite held: 30 kg of 3e7 kg.
    assert np.max(np.abs(states[:, 7] * 1e5 - expected)) < 1e-5
