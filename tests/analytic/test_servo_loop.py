"""The cascade tick by tick and its linear loop, against hand-written loops, closed forms and Nyquist's criterion."""

from __future__ import annotations

import math
from dataclasses import replace

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.errors import InputError
from feeddrive.plant.chain.chain import Rigid, ThreeInertias
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, Feedback, FeedForward
from feeddrive.servo.cascade_function import PARAMETERS, REFERENCES, SIGNALS, cascade_controller
from feeddrive.servo.filters import notch, pt1
from feeddrive.servo.linear_loop import (
    closed_loop,
    closed_velocity_loop,
    open_position_loop,
    open_velocity_loop,
    refuse_unstable,
    worst_eigenvalue,
)
from feeddrive.servo.margins import frequency_response, margins
from feeddrive.servo.sampled_plant import SampledController, sampled_plant
from feeddrive.typing import FloatArray

LEAD = 0.020
RADIUS = LEAD / (2 * math.pi)
TICK = 125e-6
VISCOUS = 300.0
BENCH = ThreeInertias(
    {
        "lead": LEAD, "motor_inertia": 2.6e-3, "screw_inertia": 2.37e-3, "torsional_stiffness": 11_982.4,
        "torsional_damping": 0.074, "axial_stiffness": 244.7e6, "axial_damping": 8650.0, "table_mass": 134.0,
    }
)  # fmt: skip
INERTIA = 2.6e-3 + 2.37e-3 + 134.0 * RADIUS**2
# viscous alone, so that the plant is linear: the Coulomb level is 1e-9 N
PLANT = Plant("bench", BENCH, (GuideFriction.of(coulomb=1e-9, smoothing_velocity=1e-3, viscous=VISCOUS),))
SERVO = Cascade(
    radius=RADIUS, sample_time=TICK, position_divider=4, position_gain=60.0, velocity_gain=2.0, reset_time=0.015,
    tracking_time=0.015, current_lag=150e-6, dead_time=1.6 * TICK, feedback=Feedback.TABLE,
    feed_forward=FeedForward(speed=0.5, torque=0.8, inertia=INERTIA),
    torque_filters=(notch(510.0, 150.0, 20.0), pt1(1500.0)), balancing_time=2e-3,
)  # fmt: skip


def ticks(controller: SampledController, references: FloatArray, measured: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Torque (n,) and signals (n, ns) of a controller fed with given references (n, nr) and measurements (n, nm)."""
    state, torques, signals = controller.initial, [], []
    for k, (reference, reading) in enumerate(zip(references, measured, strict=True)):
        state, torque, shown = controller.function(state, reference, reading, k, controller.parameters)
        torques.append(float(torque))
        signals.append(np.array(shown).ravel())
    return np.array(torques), np.array(signals)


def test_linear_loop_is_the_loop_stepped_by_hand() -> None:
    """Plant matrices and the controller's own function, tick by tick, against the composed closed loop."""
    machine, controller = sampled_plant(PLANT, SERVO), cascade_controller(SERVO)
    system = closed_loop(PLANT, SERVO)
    n = 400
    rng = np.random.default_rng(1)
    # small, so that no limit is met; a force and all references change at every position tick
    inputs = np.repeat(rng.normal(size=(n // 4, 6)) * [1e-6, 1e-4, 1e-2, 1e-3, 1e-3, 1.0], 4, axis=0)
    state, x = controller.initial, np.zeros(len(machine.a))
    seen = []
    for k in range(4, n + 4):  # from the second period on: at tick 0 the controller takes the axis to stand
        y = machine.c @ x
        reading = [y[0], y[2]]
        state, torque, _ = controller.function(state, inputs[k - 4, :5], reading, k, controller.parameters)
        seen.append(y)
        x = machine.a @ x + machine.b @ np.array([float(torque), inputs[k - 4, 5]])
    _, y = control.forced_response(system, np.arange(n // 4) * 4 * TICK, inputs[::4].T)
    # same arithmetic in another order: 1e-9 of the largest reading
    for row in range(4):
        expected = np.array(seen)[::4, row]
        np.testing.assert_allclose(y[row], expected, atol=1e-9 * np.max(np.abs(expected)), rtol=0)


def test_sampled_plant_is_the_ode_under_delayed_torque() -> None:
    """Dead time of 1.6 ticks and lag, against a stiff integrator on the differential equation."""
    machine = sampled_plant(PLANT, SERVO)
    torques = np.array([1.0, -0.5, 2.0, 0.0, 1.0, 1.0, 0.0, -1.0])
    m, c, k = (np.array(matrix(BENCH.values), dtype=float) for matrix in (BENCH.mass, BENCH.damping, BENCH.stiffness))
    c[2, 2] += VISCOUS
    inverse = np.linalg.inv(m)

    def rate(_: float, s: FloatArray, torque: float) -> FloatArray:
        force = np.array([s[6], 0.0, 0.0]) - c @ s[3:6] - k @ s[:3]
        return np.concatenate([s[3:6], inverse @ force, [(torque - s[6]) / SERVO.current_lag]])

    x, state, seen, exact = np.zeros(len(machine.a)), np.zeros(7), [], []
    delayed = np.concatenate([[0.0, 0.0], torques])  # two and one tick late
    for i, torque in enumerate(torques):
        x = machine.a @ x + machine.b @ np.array([torque, 0.0])
        seen.append((machine.c @ x)[2])
        for older, share in ((delayed[i], 0.6), (delayed[i + 1], 0.4)):
            span = (0.0, share * TICK)
            state = solve_ivp(rate, span, state, "Radau", args=(older,), rtol=1e-11, atol=1e-18).y[:, -1]
        exact.append(state[2])
    # the integrator's tolerance, accumulated
    np.testing.assert_allclose(seen, exact, rtol=1e-6, atol=1e-18)


def test_velocity_loop_of_a_rigid_axis_has_the_textbook_bandwidth() -> None:
    """P control of an inertia: closed loop K_p / (J s + K_p), so -3 dB at K_p / J, when the tick is short."""
    mass = 100.0
    rigid = Rigid({"lead": LEAD, "motor_inertia": 0.0, "screw_inertia": 0.0, "table_mass": mass})
    plant = Plant("mass", rigid, (GuideFriction.of(coulomb=1e-9, smoothing_velocity=1e-3, viscous=1e-9),))
    servo = Cascade(RADIUS, 1e-6, 1, 0.0, 0.1, math.inf, 1.0)
    corner = 0.1 / (mass * RADIUS**2) / (2 * math.pi)
    response = frequency_response(closed_velocity_loop(plant, servo), np.array([corner]))
    # one and a half ticks of delay at the corner: 1.5 T w = 1.5e-4 rad
    assert response[0] == pytest.approx((1 - 1j) / 2, abs=3e-4)


def test_margins_say_when_the_loop_becomes_unstable() -> None:
    """Gain raised to just below the gain margin is stable, just above it not: the eigenvalues know nothing of it."""
    loop = margins(open_velocity_loop(PLANT, SERVO))
    assert loop.stable
    assert not margins(open_velocity_loop(PLANT, replace(SERVO, velocity_gain=30.0))).stable
    factor = 10 ** (loop.gain / 20)
    below, above = (
        worst_eigenvalue(PLANT, replace(SERVO, position_gain=1e-3, velocity_gain=share * factor * SERVO.velocity_gain,
                                        feed_forward=FeedForward()))[1]
        for share in (0.99, 1.01)
    )  # fmt: skip
    assert below < 0 < above


def test_position_gain_at_its_margin() -> None:
    factor = 10 ** (margins(open_position_loop(PLANT, SERVO)).gain / 20)
    growth = [
        worst_eigenvalue(PLANT, replace(SERVO, position_gain=share * factor * SERVO.position_gain))[1]
        for share in (0.99, 1.01)
    ]
    assert growth[0] < 0 < growth[1]


def test_following_error_is_velocity_over_position_gain() -> None:
    """e = v / K_v, the relation everyone uses; feed-forward takes its share away."""
    for share, left in ((0.0, 1.0), (0.5, 0.5)):
        servo = replace(SERVO, feed_forward=FeedForward(speed=share), balancing_time=0.0)
        system = closed_loop(PLANT, servo)["position_error", ["position", "velocity"]]
        time = np.arange(8000) * float(system.dt)
        _, y = control.forced_response(system, time, np.vstack([0.1 * time, np.full(time.size, 0.1)]))
        # the slowest mode has died away to 1e-9; the speed is a difference quotient, exact at constant speed
        assert y.ravel()[-1] == pytest.approx(left * 0.1 / 60.0, rel=1e-6)


def test_unstable_loop_is_refused_with_its_eigenvalue() -> None:
    with pytest.raises(InputError, match=r"the loop is unstable: eigenvalue .* grows by .* 1/s, seen at .* Hz"):
        refuse_unstable(PLANT, replace(SERVO, velocity_gain=30.0), "scenario")


def test_position_loop_runs_at_its_own_ticks() -> None:
    servo = replace(SERVO, balancing_time=0.0, torque_filters=(), feed_forward=FeedForward())
    controller = cascade_controller(servo)
    references = np.zeros((9, len(REFERENCES)))
    references[:, 0] = np.arange(9) * 1e-3
    _, signals = ticks(controller, references, np.zeros((9, 2)))
    error = signals[:, SIGNALS.index("position_error")]
    np.testing.assert_array_equal(error, [0, 0, 0, 0, 4e-3, 4e-3, 4e-3, 4e-3, 8e-3])


def test_torque_is_limited_and_the_integrator_follows() -> None:
    """Back-calculation: a stalled axis holds the integral at the limit; without it, it would wind up for ever."""
    servo = replace(SERVO, position_gain=0.0, torque_filters=(), feed_forward=FeedForward(speed=1.0), torque_limit=5.0)
    references = np.zeros((4000, len(REFERENCES)))
    references[:, 1] = 0.1  # asks for 31 rad/s of a shaft that does not turn
    torque, signals = ticks(cascade_controller(servo), references, np.zeros((4000, 2)))
    raw = signals[:, SIGNALS.index("unlimited_torque")]
    assert torque.max() == 5.0
    # steady state of I' = K_p / T_n e + (T_max - T_raw) / T_t = 0: T_raw = T_max + K_p e T_t / T_n; 0.5 s is 33 T_t
    error = 0.1 / RADIUS
    assert raw[-1] == pytest.approx(
        5.0 + servo.velocity_gain * error * servo.tracking_time / servo.reset_time, rel=1e-9
    )


def test_anti_windup_shortens_the_overshoot() -> None:
    """A rigid axis under a speed step that saturates: the integrator that follows overshoots a tenth as much."""
    over = {}
    for tracking in (0.015, 1e6):
        servo = replace(SERVO, position_gain=0.0, torque_filters=(), torque_limit=3.0, tracking_time=tracking,
                        feed_forward=FeedForward(speed=1.0), feedback=Feedback.MOTOR)  # fmt: skip
        controller, angle, speed, peak = cascade_controller(servo), 0.0, 0.0, 0.0
        state = controller.initial
        for k in range(8000):
            reference = np.array([0.0, 0.3, 0.0, 0.0, 0.0])
            state, torque, _ = controller.function(state, reference, angle, k, controller.parameters)
            angle += TICK * speed + 0.5 * TICK**2 * float(torque) / INERTIA
            speed += TICK * float(torque) / INERTIA
            peak = max(peak, speed)
        over[tracking] = peak * RADIUS / 0.3 - 1.0
    assert over[0.015] < 0.3 * over[1e6]
    assert over[1e6] > 0.3


def test_feed_forward_is_the_torque_of_the_set_motion() -> None:
    forward = FeedForward(torque=1.0, inertia=INERTIA, coulomb=0.4, smoothing_speed=0.1, viscous=0.01)
    servo = replace(SERVO, position_gain=0.0, velocity_gain=0.0, torque_filters=(), feed_forward=forward)
    references = np.zeros((1, len(REFERENCES)))
    references[0, 1:3] = 0.2, 5.0
    torque, _ = ticks(cascade_controller(servo), references, np.zeros((1, 2)))
    w = 0.2 / RADIUS
    assert torque[0] == pytest.approx(INERTIA * 5.0 / RADIUS + 0.4 * math.tanh(w / 0.1) + 0.01 * w, rel=1e-12)


def test_controllers_of_one_structure_share_their_function() -> None:
    one, other = cascade_controller(SERVO), cascade_controller(replace(SERVO, position_gain=10.0))
    assert one.function is other.function
    changed = np.flatnonzero(one.parameters != other.parameters)
    assert [PARAMETERS[i] for i in changed] == ["position_gain"]


def test_impossible_settings_are_refused() -> None:
    for changes, message in (
        ({"velocity_gain": -1.0}, "controller.velocity_gain: is out of range"),
        ({"tracking_time": TICK / 2}, "controller.tracking_time: is out of range; write more than the sample time"),
        ({"feed_forward": FeedForward(torque=1.0)}, "torque feed-forward needs an inertia"),
    ):
        with pytest.raises(InputError, match=message):
            replace(SERVO, **changes)
