"""State feedback with observer: separation of poles, no error to ramps and loads; scheduled parameters."""

from __future__ import annotations

import math
from dataclasses import replace

import control
import numpy as np
import pytest

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.errors import InputError
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.sampled_plant import sampled_plant
from feeddrive.servo.scheduled import scheduled
from feeddrive.servo.state_feedback import SIGNALS, open_loop, state_feedback, steady_columns, with_load
from feeddrive.typing import FloatArray

RADIUS, TICK = 0.020 / (2 * math.pi), 1 / 4000
CHAIN = ThreeInertias(
    {
        "lead": 0.020, "motor_inertia": 2.6e-3, "screw_inertia": 2.37e-3, "torsional_stiffness": 11_982.4,
        "torsional_damping": 0.074, "axial_stiffness": 244.7e6, "axial_damping": 8650.0, "table_mass": 134.0,
    }
)  # fmt: skip
# viscous alone, so that the plant is linear: the Coulomb level is 1e-9 N
PLANT = Plant("bench", CHAIN, (GuideFriction.of(coulomb=1e-9, smoothing_velocity=1e-3, viscous=300.0),))
DRIVE = Cascade(
    RADIUS, TICK, 1, 10.0, 1.0, math.inf, 1.0, feedback=Feedback.TABLE, current_lag=160e-6, dead_time=1.5 * TICK
)
MACHINE = sampled_plant(PLANT, DRIVE)


def gains() -> tuple[FloatArray, FloatArray]:
    """Optimal feedback and a Kalman filter."""
    row = MACHINE.c[2:3]
    gain, _, _ = control.dlqr(MACHINE.a, MACHINE.b[:, :1], row.T @ row / 9e-12, np.eye(1))
    a, c = with_load(MACHINE)
    torque, force = (np.append(MACHINE.b[:, i], 0.0)[:, None] for i in (0, 1))
    process = torque @ torque.T + 400 * force @ force.T + np.diag(np.append(np.zeros(len(a) - 1), 1.0))
    observer, _, _ = control.dlqr(a.T, c.T, process, np.diag([9e-12, 2.5e-15]))
    return np.asarray(gain), np.asarray(observer).T


def test_closed_loop_has_the_poles_of_feedback_and_observer() -> None:
    """Separation: the eigenvalues of the whole are those of both designs, and the margins are of that loop."""
    gain, observer = gains()
    loop = open_loop(MACHINE, TICK, gain, observer)
    whole = np.linalg.eigvals(loop.A - loop.B @ loop.C)
    a, c = with_load(MACHINE)
    apart = np.concatenate(
        [np.linalg.eigvals(MACHINE.a - MACHINE.b[:, :1] @ gain), np.linalg.eigvals(a - observer @ c)]
    )
    # eigenvalues at 0, from the dead time, are defective and known to the square root of rounding
    for value in apart:
        assert np.min(np.abs(whole - value)) < 1e-4


def followed(
    position: FloatArray, velocity: FloatArray, acceleration: float, load: float
) -> tuple[FloatArray, FloatArray]:
    """Table error [m] and estimated load [N] of the linear plant under its controller, tick by tick."""
    controller = state_feedback(MACHINE, TICK, *gains())
    x, state, error, estimate = np.zeros(len(MACHINE.a)), controller.initial, [], []
    for k, (p, v) in enumerate(zip(position, velocity, strict=True)):
        y = MACHINE.c @ x
        state, torque, shown = controller.function(state, [p, v, acceleration], [y[0], y[2]], k, [])
        error.append(p - y[2])
        estimate.append(float(np.array(shown)[SIGNALS.index("load"), 0]))
        x = MACHINE.a @ x + MACHINE.b @ np.array([float(torque), load])
    return np.array(error), np.array(estimate)


def test_neither_ramp_nor_load_nor_acceleration_leaves_an_error() -> None:
    time = TICK * np.arange(2500)
    error, estimate = followed(0.1 * time + 0.5 * time**2, 0.1 + time, 1.0, -300.0)
    # starts with a jump of the velocity: died away to 1e-9 m of 1 mm, and the load to 1e-3 of 300 N
    assert abs(error[-1]) < 1e-8 and np.max(np.abs(error)) > 1e-6
    assert estimate[-1] == pytest.approx(-300.0, abs=0.3)


def test_steady_columns_are_statics() -> None:
    """A load takes the torque - r, and stretches the chain by its compliance; acceleration takes the inertia."""
    steady = steady_columns(MACHINE, TICK)
    assert steady.torques[0] == pytest.approx(0.0, abs=1e-6)
    assert steady.torques[1] == pytest.approx(300.0 * RADIUS, rel=1e-6)
    assert steady.torques[2] == pytest.approx(2.6e-3 / RADIUS + 2.37e-3 / RADIUS + 134 * RADIUS, rel=0.02)
    assert steady.torques[3] == pytest.approx(-RADIUS, rel=1e-9)
    stretch = (MACHINE.c[0] @ steady.states[:, 3]) * RADIUS
    assert -stretch == pytest.approx(1 / 244.7e6 + RADIUS**2 / 11_982.4, rel=1e-9)


def test_gains_of_another_size_are_refused() -> None:
    gain, observer = gains()
    with pytest.raises(InputError, match=r"gains of shape .* for 9 states"):
        state_feedback(MACHINE, TICK, gain[:, :-1], observer)


def test_schedule_is_its_designs_at_their_places_and_linear_between() -> None:
    slow, fast = (cascade_controller(replace(DRIVE, position_gain=gain)) for gain in (10.0, 30.0))
    following = scheduled(np.array([0.0, 1.0]), [slow, fast])
    for place, gain in ((-0.5, 10.0), (0.0, 10.0), (0.25, 15.0), (1.0, 30.0), (2.0, 30.0)):
        reference = np.array([place + 1e-3, 0, 0, 0, 0])
        _, torque, _ = following.function(following.initial, reference, [0.0, place], 0, following.parameters)
        assert float(torque) == pytest.approx(gain * 1e-3 / RADIUS, rel=1e-9)  # K_p = 1


def test_designs_that_do_not_belong_together_are_refused() -> None:
    one = cascade_controller(DRIVE)
    with pytest.raises(InputError, match="ascending positions, two or more"):
        scheduled(np.array([1.0, 0.0]), [one, one])
    other = cascade_controller(replace(DRIVE, position_divider=2))
    with pytest.raises(InputError, match="different equations"):
        scheduled(np.array([0.0, 1.0]), [one, other])
    blind = cascade_controller(replace(DRIVE, feedback=Feedback.MOTOR))
    with pytest.raises(InputError, match="do not read the table position"):
        scheduled(np.array([0.0, 1.0]), [blind, blind])
    limited = cascade_controller(replace(DRIVE, speed_limit=100.0))
    with pytest.raises(InputError, match="infinite in some designs alone"):
        scheduled(np.array([0.0, 1.0]), [cascade_controller(DRIVE), limited])


def test_limits_that_are_infinite_everywhere_stay_so() -> None:
    """Infinity less infinity is no number: the blend must not meet it."""
    one = cascade_controller(replace(DRIVE, reset_time=0.02))
    assert not np.isfinite(one.parameters).all()
    following = scheduled(np.array([0.0, 0.5, 1.0]), [one, one, one])
    outputs = following.function(following.initial, [0.101, 0, 0, 0, 0], [0.0, 0.1], 0, following.parameters)
    alone = one.function(one.initial, [0.101, 0, 0, 0, 0], [0.0, 0.1], 0, one.parameters)
    for blended, single in zip(outputs, alone, strict=True):
        np.testing.assert_array_equal(blended.full(), single.full())
