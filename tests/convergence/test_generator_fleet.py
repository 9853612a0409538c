"""The generator's belts, vertical axes and relatives against scipy's Radau with its own right-hand side.

Three machines, each with laws of its own, under a torque held over 1 ms; the reference restarts where the torque jumps.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.generator.axis import BENCH, AxisParameters
from tests.generator.beside import beside
from tests.generator.constants import Constants, declared_constants, packed
from tests.generator.driven import driven
from tests.generator.effects import (
    Backlash,
    Effect,
    FrictionVsPosition,
    LeadErrorCumulative,
    Payload,
    PlantedEffects,
    PreloadLoss,
    StiffnessVsPosition,
    Stribeck,
    TorqueRipple,
    ViscousAsymmetry,
)
from tests.generator.effects.relatives import Relative
from tests.generator.loop import Sampling, closed_loop, open_loop
from tests.generator.machines import Machine
from tests.generator.recording import QUICK_STEP, sampling_of
from tests.generator.runs import at_rest
from tests.generator.transmission import nut_forces, side_of

Array = np.ndarray

SAMPLE, COUNT = 1e-3, 60
TOLERANCE = 0.2e-9
"""Of the table position [m]: invisible in a recording, a fifth of the finest scale's step."""

BELT = dataclasses.replace(BENCH, ratio=2.0, motor_inertia=1.1e-3)
UPRIGHT = dataclasses.replace(BENCH, fall=9.80665, counterbalance=900.0)

BELT_EFFECTS = (
    Relative(Stribeck(20.0, 5e-3), "", {"stribeck_kind": 1.0}),
    Relative(Backlash(8e-6), "", {"gap_softness": 2e-6}, ("gap_softness",)),
)
UPRIGHT_EFFECTS = (
    Relative(FrictionVsPosition(30.0, 0.1005, 0.0004), "", {"bump_kind": 2.0}),
    Relative(LeadErrorCumulative(4e-4), "", {"lead_curve": 3.0}),
)
LIGHT_EFFECTS = (
    Relative(ViscousAsymmetry(120.0), "", {"asymmetry_power": 1.5, "asymmetry_speed": 0.02}),
    Relative(TorqueRipple(0.2, 6.0, 0.3), "", {"ripple_second": 0.4}),
)


def shape(kind: str, x: float, v: float) -> float:
    """Return the guide's friction level and asymmetry of a machine, written from the laws."""
    if kind == "belt":
        return 60.0 + 20.0 / (1.0 + abs(v) / 5e-3)
    if kind == "upright":
        u = (x - 0.1005) / 0.0004
        return 60.0 + (15.0 * (1.0 + math.cos(math.pi * u / 2.0)) if abs(u) < 2.0 else 0.0)
    return 60.0


def reference(kind: str, a: AxisParameters, torque: float) -> Callable[[float, Array], Array]:
    """Return the right-hand side of a machine under a held torque."""
    r = 0.02 / (2.0 * math.pi)

    def slopes(_: float, y: Array) -> Array:
        theta, omega, phi, nu, x, v = (float(value) for value in y)
        lead, grade = 0.0, 0.0
        if kind == "upright":
            far = x - 0.04
            lead, grade = 4e-4 * (x + 3.0 * far**2), 4e-4 * (1.0 + 6.0 * far)
        e, rate = r * phi + lead - x, r * nu - (1.0 - grade) * v
        touch, stretch = 1.0, e
        if kind == "belt":
            up, down = math.hypot(e - 4e-6, 2e-6), math.hypot(e + 4e-6, 2e-6)
            stretch, touch = e + (up - down) / 2.0, 1.0 + ((e - 4e-6) / up - (e + 4e-6) / down) / 2.0
        force = a.axial_stiffness * stretch + touch * a.axial_damping * rate
        twist = a.torsional_stiffness * (theta / a.ratio - phi) + a.torsional_damping * (omega / a.ratio - nu)
        drag = 0.35 * math.tanh(nu / 0.15) + 0.02 * math.copysign(abs(nu) ** (2.0 / 3.0), nu)
        friction = shape(kind, x, v) * math.tanh(v / 0.5e-3) + 300.0 * v
        ripple = 0.0
        if kind == "light":
            friction += 120.0 * v * math.sqrt(v / 0.02) if v > 0.0 else 0.0
            ripple = 0.2 * math.sin(6.0 * theta + 0.3) + 0.08 * math.sin(2.0 * (6.0 * theta + 0.3))
        weight = 134.0 * 9.80665 - 900.0 if kind == "upright" else 0.0
        motor = (torque - twist / a.ratio - ripple) / a.motor_inertia
        table = ((1.0 - grade) * force - friction - weight) / 134.0
        return np.array([omega, motor, nu, (twist - r * force - drag) / a.screw_inertia, v, table])

    return slopes


def sampling(axis: AxisParameters, c: Constants, steps: int) -> Sampling:
    """Return the loop's numbers with so many steps in a sample."""
    return sampling_of(axis, c)._replace(sample_time=SAMPLE, longest_step=SAMPLE / steps)


@pytest.mark.parametrize(
    ("kind", "axis", "effects"),
    [("belt", BELT, BELT_EFFECTS), ("upright", UPRIGHT, UPRIGHT_EFFECTS), ("light", BENCH, LIGHT_EFFECTS)],
)
def test_against_radau(kind: str, axis: AxisParameters, effects: tuple[Relative, ...]) -> None:
    """Table positions agree to a fifth of a nanometre."""
    c = PlantedEffects(effects).planted(declared_constants(axis))
    time = np.arange(COUNT) * SAMPLE
    torque = 2.5 * np.sin(2.0 * math.pi * 22.0 * time) + 1.2 * np.sin(2.0 * math.pi * 61.0 * time)
    torque = torque / axis.ratio + (134.0 * 9.80665 - 900.0) * 0.02 / (2.0 * math.pi) * (kind == "upright")
    start = at_rest(0.1, c)
    found = open_loop(torque, start, sampling(axis, c, 200), c)[:, 4]
    state, expected = np.array(start[:6]), [start[4]]
    for held in torque:
        run = solve_ivp(reference(kind, axis, float(held)), (0.0, SAMPLE), state, "Radau", rtol=1e-9, atol=1e-13)
        state = run.y[:, -1]
        expected.append(float(state[4]))
    assert np.ptp(expected) > 20e-6  # it moves well beyond its free play
    assert np.max(np.abs(found - expected)) < TOLERANCE


@pytest.mark.parametrize(
    "nut", [Backlash(60e-6), PreloadLoss(0.4, 500.0), StiffnessVsPosition(0.3)], ids=lambda one: type(one).__name__
)
def test_a_weight_at_rest_does_not_move(nut: Effect) -> None:
    """A table that hangs in the nut starts where it stays, but for what the screw twists by and swings to."""
    c = nut.planted(declared_constants(UPRIGHT))
    state = at_rest(0.1, c)
    side = side_of(state, c)
    weight = c.table_mass * c.fall - c.counterbalance
    assert nut_forces(state, side, packed(c))[2] == pytest.approx(weight, rel=1e-6)
    hanging = open_loop(np.full(40, weight * c.transmission / c.ratio), state, sampling(UPRIGHT, c, 200), c)
    assert np.ptp(hanging[:, 4]) < 2.0 * weight * c.transmission**2 / c.torsional_stiffness


def moved(encoder_step: float) -> tuple[Array, Array, Sampling, Constants]:
    """Return torque (n,) and states (n, WIDTH) of a smooth motion under the loop, the loop's numbers and the plant."""
    c = declared_constants(BENCH)
    s = sampling_of(BENCH, c, QUICK_STEP)._replace(encoder_step=encoder_step)
    time = np.arange(1600) * BENCH.sample_time
    setpoint = 0.2 + 2e-3 * (1.0 - np.cos(2.0 * math.pi * 2.5 * time))
    torque, states, _ = closed_loop(setpoint, np.zeros(1600), at_rest(0.2, c), s, c)
    return torque, states, s, c


def test_plant_beside_itself_asks_for_the_same() -> None:
    """The torque that a plant asks for under its own motion is that which moved it, to rounding."""
    torque, _, s, c = moved(1.5e-6)
    asked, _ = beside(torque, at_rest(0.2, c), at_rest(0.2, c), s, c, c)
    assert np.max(np.abs(asked - torque)) < 1e-9 * np.max(np.abs(torque))


def test_heavier_plant_beside_asks_for_its_mass() -> None:
    """A payload asks for m r r theta'' more; at 2.5 Hz the chain's compliance changes that by (2.5 / 190)^2 at most."""
    torque, states, s, c = moved(1e-12)
    asked, _ = beside(torque, at_rest(0.2, c), at_rest(0.2, c), s, c, Payload(20.0).planted(c))
    acceleration = np.diff(states[:, 1]) / BENCH.sample_time
    wanted = 20.0 * BENCH.transmission**2 * acceleration
    # The resonances, other for another mass, ring beside it and have no part in the slope.
    more, late = (asked - torque)[400:-1], wanted[400:]
    assert float(more @ late / (late @ late)) == pytest.approx(1.0, abs=0.02)


def test_plant_led_by_an_exact_angle_leaves_nothing() -> None:
    """The prediction from the exact motor angle is the run itself: a spline over rows misses 2e-4 of it."""
    torque, states, _, c = moved(1e-12)
    asked, position = driven(Machine(BENCH, 1, True, 0.04), c, states[:, 0].copy(), at_rest(0.2, c), QUICK_STEP)
    inner = slice(200, 1500)
    assert np.std((asked - torque)[inner]) < 2e-3 * np.std(torque[inner])
    assert np.max(np.abs(position - states[:, 4])[inner]) < 1e-9
