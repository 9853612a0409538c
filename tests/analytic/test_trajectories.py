"""Set-points and forces: limits kept, least time, derivatives consistent, closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson

from feeddrive.errors import InputError
from feeddrive.simulate.setpoints.cutting_force import Milling, RecordedForce, TriangleForce
from feeddrive.simulate.setpoints.setpoint_motion import Limits, Pieces, Trajectory, move, phases
from feeddrive.simulate.setpoints.trajectories import (
    Circle,
    Sine,
    Wave,
    moves,
    position_step,
    refuse_beyond_travel,
    staircase,
    velocity_steps,
)
from feeddrive.simulate.setpoints.waveforms import Multisine, Prbs, Sweep

SLOW = Limits(0.5, 5.0, 100.0)
POSITIVE = st.floats(1e-2, 1e2)


def duration(distance: float, limits: Limits) -> float:
    tj, ta, tv = phases(distance, limits)
    return 4 * tj + 2 * ta + tv


@given(st.floats(1e-7, 2.0), POSITIVE, POSITIVE, st.floats(1.0, 1e5))
def test_a_move_keeps_its_limits_and_arrives(distance: float, v: float, a: float, j: float) -> None:
    limits = Limits(v, a, j)
    way = Pieces(tuple(move(0.1, 0.1 + distance, limits)))
    motion = way.at(np.linspace(0.0, way.duration, 4001))
    rounding = 1 + 1e-9  # of sums of seven phases
    assert np.max(np.abs(motion.velocity)) <= v * rounding
    assert np.max(np.abs(motion.acceleration)) <= a * rounding
    assert np.max(np.abs(motion.jerk)) <= j
    x, speed, acceleration = way.pieces[-1].end
    assert x == pytest.approx(0.1 + distance, abs=1e-9 * distance + 1e-15)
    # what rounding leaves at the end, of the largest speed and acceleration on the way
    assert abs(speed) <= 1e-9 * np.max(np.abs(motion.velocity))
    assert abs(acceleration) <= 1e-9 * np.max(np.abs(motion.acceleration))


@given(st.floats(1e-5, 2.0), POSITIVE, POSITIVE, st.floats(1.0, 1e5))
def test_a_move_cannot_be_faster(distance: float, v: float, a: float, j: float) -> None:
    """At every instant the motion is on a limit: |jerk| = J, or |a| = A, or v = V; so nothing is left to gain."""
    limits = Limits(v, a, j)
    for piece in move(0.0, distance, limits):
        on_acceleration = abs(piece.acceleration) == pytest.approx(a, rel=1e-6)
        on_velocity = piece.velocity == pytest.approx(v, rel=1e-6)
        assert abs(piece.jerk) == j or on_acceleration or on_velocity


@pytest.mark.parametrize(
    ("distance", "expected"),
    [
        # v reached, a reached: D / V + V / A + A / J
        (1.0, 1.0 / 0.5 + 0.5 / 5.0 + 5.0 / 100.0),
        # nothing reached: 4 (D / 2 J)^(1/3)
        (1e-3, 4 * (1e-3 / 200.0) ** (1 / 3)),
        # a reached, v not: T_j = 0.05, T_a = -0.075 + sqrt(0.000625 + D / 5)
        (0.05, 4 * 0.05 + 2 * (-0.075 + math.sqrt(0.25 * 0.05**2 + 0.01))),
    ],
)
def test_least_time_in_closed_form(distance: float, expected: float) -> None:
    assert duration(distance, SLOW) == pytest.approx(expected, rel=1e-12)


def test_velocity_reached_without_the_acceleration() -> None:
    # V < A^2 / J: T_j = sqrt(V / J), whole time D / V + 2 sqrt(V / J)
    assert duration(0.1, Limits(0.01, 5.0, 100.0)) == pytest.approx(10.0 + 2 * math.sqrt(1e-4), rel=1e-12)


TRAJECTORIES: dict[str, Trajectory] = {
    "moves": moves(0.0, [(0.1, SLOW), (0.05, SLOW), (0.05, SLOW)], 0.1),
    "staircase": staircase([0.1, 0.2], 2, 0.01, SLOW, 0.05),
    "circle": Circle(0.2, 0.05, 1.5, Limits(0.05, 1.0, 20.0), 0.1),
    "sine": Sine(0.1, 0.02, 3.0, 2.0, 0.5),
    "sweep": Wave(0.0, 0.05, 0.02, Sweep(1.0, 30.0, 3.0)),
    "multisine": Wave(0.0, 0.05, 0.02, Multisine(1.0, 20.0, 1.0, 2)),
}


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_derivatives_belong_together(name: str) -> None:
    """Integrals of every derivative are the one before."""
    trajectory = TRAJECTORIES[name]
    time = np.linspace(0.0, trajectory.duration, 200_001)
    motion = trajectory.at(time)
    chain = [motion.position, motion.velocity, motion.acceleration]
    rates = [motion.velocity, motion.acceleration, motion.jerk]
    for value, rate in zip(chain, rates, strict=True):
        integral = value[0] + cumulative_simpson(rate, x=time, initial=0.0)
        # jumps of the jerk lie between the points: one step of 40 µs of the largest rate
        np.testing.assert_allclose(value, integral, atol=1e-4 * np.max(np.abs(rate)) + 1e-12, rtol=0)


def test_stops_are_where_the_motion_rests() -> None:
    trajectory = moves(0.0, [(0.1, SLOW), (0.05, SLOW)], 0.2)
    assert [stop.direction for stop in trajectory.stops] == [0, 1, -1]
    for stop in trajectory.stops:
        middle = trajectory.at(np.array([0.5 * (stop.arrival + stop.leave)]))
        assert (middle.position[0], middle.velocity[0]) == (stop.target, 0.0)


def test_staircase_approaches_every_target_from_both_sides() -> None:
    trajectory = staircase([0.1, 0.2, 0.35], 5, 0.01, SLOW, 0.1)
    for target in (0.1, 0.2, 0.35):
        directions = [stop.direction for stop in trajectory.stops if stop.target == target]
        assert directions.count(1) == directions.count(-1) == 5


def test_steps_are_held() -> None:
    step = position_step(0.1, 1e-4, 0.2, 1.0)
    heights = step.at(np.array([0.0, 0.1999, 0.2, 0.9, 2.0])).position
    np.testing.assert_array_equal(heights, [0.1, 0.1, *[0.1 + 1e-4] * 3])
    speeds = velocity_steps(0.0, [(0.5, 0.1), (0.5, -0.2)]).at(np.array([0.25, 0.75]))
    np.testing.assert_allclose(speeds.position, [0.025, 0.0], atol=1e-15)


def test_circle_keeps_its_feed_and_radius() -> None:
    circle = Circle(0.2, 0.05, 1.0, Limits(0.05, 1.0, 20.0), 0.1)
    time = np.linspace(1.0, 5.0, 1000)
    motion = circle.at(time)
    # inside, the feed is constant: v^2 + (w (x - centre))^2 = feed^2
    np.testing.assert_allclose(np.hypot(motion.velocity, motion.position - 0.2), 0.05, rtol=1e-9)


def test_multisine_has_a_flat_band_and_a_low_crest() -> None:
    wave = Multisine(5.0, 200.0, 1.0)
    values = wave.values(np.arange(2000) / 2000)[1]
    lines = np.abs(np.fft.rfft(values)) / 1000
    np.testing.assert_allclose(lines[5:201], lines[5], rtol=1e-9)
    assert np.max(np.abs(lines[201:])) < 1e-12 and abs(lines[4]) < 1e-12
    assert wave.crest < 2.0  # random phases give about 3.5
    assert np.max(np.abs(values)) <= 1.0


def test_binary_sequence_is_white() -> None:
    values = Prbs(1e-3, 9).values(np.arange(511) * 1e-3)[1]
    correlation = np.fft.ifft(np.abs(np.fft.fft(values)) ** 2).real
    # autocorrelation of a maximum-length sequence: 511 at lag 0, -1 elsewhere
    np.testing.assert_allclose(correlation[1:], -1.0, atol=1e-9)
    integral = Prbs(1e-3, 9).values(np.array([0.0, 1e-3, 2.5e-3]))[0]
    np.testing.assert_allclose(integral[1], 1e-3 * values[0], atol=1e-15)


def test_motion_beyond_the_travel_is_refused() -> None:
    trajectory = moves(0.0, [(0.5, SLOW)], 0.0)
    with pytest.raises(
        InputError, match=r"the set-point is 100 mm beyond the travel at .* s; the travel is 0 mm to 400"
    ):
        refuse_beyond_travel(trajectory, (0.0, 0.4), 1e-3, "scenario")
    refuse_beyond_travel(trajectory, (0.0, 0.5), 1e-3, "scenario")


@pytest.mark.parametrize(
    "make",
    [
        lambda: Limits(0.0, 1.0, 1.0),
        lambda: Limits(1.0, math.inf, 1.0),
        lambda: staircase([0.2, 0.1], 5, 0.01, SLOW, 0.1),
        lambda: Circle(0.0, 0.0, 1.0, SLOW, 0.0),
        lambda: Sine(0.0, 0.1, 1.0, 1.0, 0.6),
        lambda: Sweep(10.0, 5.0, 1.0),
        lambda: Multisine(5.1, 5.2, 1.0),
        lambda: Prbs(1e-3, 30),
    ],
)
def test_impossible_motions_are_refused(make: object) -> None:
    with pytest.raises(InputError):
        make()  # type: ignore[operator]


def test_triangle_and_recorded_forces() -> None:
    triangle = TriangleForce(100.0, 4.0, 1, 1.0)
    np.testing.assert_allclose(triangle.at(np.array([0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 9.0])),
                               [0.0, 0.0, 50.0, 100.0, 0.0, -100.0, 0.0, 0.0], atol=1e-12)  # fmt: skip
    recorded = RecordedForce(np.array([1.0, 2.0]), np.array([5.0, 7.0]))
    np.testing.assert_array_equal(recorded.at(np.array([0.5, 1.5, 2.0, 2.5])), [0.0, 5.0, 7.0, 0.0])


def test_milling_force_has_its_mean_and_period() -> None:
    """Slot with four teeth: the mean force in feed direction is -N b f_t K_r / 4 (Altintas, mean over immersion)."""
    cut = Milling(4, 2 * math.pi * 50, 2e-3, 1e-4, 1.8e9, 0.5e9, 0.0, math.pi, 0.0)
    time = np.arange(100_000) / 100_000 * 0.02
    force = cut.at(time)
    # of a sampled mean over whole revolutions, edges of a sine: 1e-4
    assert np.mean(force) == pytest.approx(-4 * 2e-3 * 1e-4 * 0.5e9 / 4, rel=1e-4)
    np.testing.assert_allclose(cut.at(time + 0.005), force, atol=1e-6 * np.max(np.abs(force)))
