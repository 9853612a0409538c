"""Sines over an angle are looked for where they are in the band, at every speed of the recording."""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.diagnosis.starts.sines import (
    SKIRT,
    longest_sine,
    sine_among_fringes,
    strongest_orders,
    strongest_sines,
)

STEP, EDGE = 2e-3, 50.0


def motion() -> tuple[np.ndarray, np.ndarray]:
    """Angle and speed of slow cuts at 12 rad/s between rapid strokes at 200 rad/s."""
    time = STEP * np.arange(9000)
    speed = np.where(time % 3.0 < 2.4, 12.0, 200.0)
    return np.cumsum(speed) * STEP, speed


def test_high_order_that_shows_at_low_speed_alone_is_found() -> None:
    angle, speed = motion()
    noise = np.random.default_rng(4).standard_normal(len(angle))
    slow = speed < 100.0
    # at the speed of the rapids order 13.2 is at 420 Hz: the filter leaves nothing, and the rest is larger there
    residual = np.where(slow, 0.5 * np.sin(13.2 * angle + 0.4) + noise, 4.0 * noise)
    (first, *_) = strongest_sines(angle, residual, speed, EDGE)
    assert first.order == pytest.approx(13.2, abs=0.02)
    assert first.amplitude == pytest.approx(0.5, rel=0.15)
    assert first.share == pytest.approx(0.5 * 0.5**2 * slow.sum() / (residual @ residual), rel=0.3)
    # of all samples together the noise of the rapids takes more, and the order is still told
    assert strongest_orders(angle, residual, count=1) == [pytest.approx(13.2, abs=0.02)]


def test_low_order_is_found_at_all_speeds() -> None:
    angle, speed = motion()
    residual = 0.3 * np.sin(angle - 1.0) + 0.5 * np.random.default_rng(5).standard_normal(len(angle))
    (first, *_) = strongest_sines(angle, residual, speed, EDGE)
    assert first.order == pytest.approx(1.0, abs=0.01)
    assert first.amplitude == pytest.approx(0.3, rel=0.1)


def test_error_of_every_revolution_is_found_on_a_stroke_of_a_few() -> None:
    # a stroke of 3.7 revolutions to and fro, and a lead that is off beside the error of every revolution
    angle = 2 * np.pi * 3.7 * (0.5 - 0.5 * np.cos(2 * np.pi * STEP * np.arange(9000) / 2.0))
    noise = np.random.default_rng(6).standard_normal(len(angle))
    residual = 0.5 * np.sin(angle + 0.7) + 0.1 * angle + noise
    speed = np.gradient(angle, STEP)
    nearest = min(strongest_sines(angle, residual, speed, EDGE), key=lambda one: abs(one.order - 1))
    assert nearest.order == pytest.approx(1.0, abs=0.03)  # an eighth of what 3.7 revolutions resolve
    assert nearest.amplitude == pytest.approx(0.5, rel=0.15)
    # of less than two periods nothing is told from a line
    few = angle / 3
    assert all(one.order > 1.6 for one in strongest_sines(few, residual, speed / 3, EDGE))


@pytest.mark.parametrize("seed", range(6))
def test_order_is_no_fringe_of_two_places_at_which_most_time_is_spent(seed: int) -> None:
    """Tapered bins have peaks 1 / 5 of an order apart, where the places lie 5 turns apart: half were fringes."""
    random = np.random.default_rng([seed, 31])
    order, apart = random.uniform(5.0, 15.0), random.uniform(4.5, 5.5)
    turns = np.concatenate([np.linspace(0, 0.4, 4000), np.linspace(0.4, apart, 300), apart + np.linspace(0, 0.4, 4000)])
    turns = np.concatenate([[-0.2], turns, [apart + 0.6]])
    residual = np.sin(2 * np.pi * order * turns + random.uniform(0, 6)) + random.standard_normal(len(turns))
    (first, *_) = strongest_sines(2 * np.pi * turns, residual, np.full(len(turns), 2.0), EDGE)
    # the amplitude over the noise of four thousand samples at either place: a fiftieth of a period
    assert first.order == pytest.approx(order, abs=0.02 / apart)


def test_order_that_shows_at_the_ends_of_the_travel_alone_is_found_among_its_fringes() -> None:
    # to and fro over a hundred turns, slow enough for order 12 on the first and the last two and a few in between
    places = np.concatenate(
        [np.linspace(36.6, 38.6, 4000), np.linspace(70.0, 70.6, 300), np.linspace(145.0, 147.5, 5000)]
    )
    rapids = np.linspace(38.6, 145.0, 3000)
    angle = 2 * np.pi * np.concatenate([places, rapids])
    speed = 2 * np.pi * np.concatenate([np.full(len(places), 2.0), np.full(len(rapids), 39.0)])
    noise = np.random.default_rng(8).standard_normal(len(angle))
    slow = speed < 100.0
    residual = (
        np.where(slow, 0.5 * np.sin(12 * angle + 0.4) + 0.2 * np.sin(24 * angle), 0.0) + 0.0002 * angle + 0.1 * noise
    )
    (first,) = sine_among_fringes(angle, residual, speed, EDGE)
    assert first.order == pytest.approx(12.0, abs=0.3 / 110)  # of one turn over the travel
    assert first.amplitude == pytest.approx(0.5, rel=0.1)
    # of less than half of what is left it is not told
    assert sine_among_fringes(angle, residual + 0.6 * noise, speed, EDGE) == []


@pytest.mark.parametrize("pitch", [2.66, 4.5])
def test_force_over_some_turns_is_found_on_a_stroke_of_a_few_pitches(pitch: float) -> None:
    # ten revolutions to and fro, forty turns from zero, beside a spring and a ripple of the motor
    angle = 2 * np.pi * (40 + 10 * (0.5 - 0.5 * np.cos(2 * np.pi * STEP * np.arange(9000) / 4.0)))
    noise = np.random.default_rng(7).standard_normal(len(angle))
    residual = 0.5 * np.sin(angle / pitch + 0.7) + 0.3 * np.sin(6 * angle) + 0.02 * angle + noise
    speed = np.gradient(angle, STEP)
    (nearest,) = longest_sine(angle, residual, np.inf)
    assert nearest.order == pytest.approx(1 / pitch, abs=0.1 / 8)  # an eighth of what ten revolutions resolve
    assert nearest.amplitude == pytest.approx(0.5, rel=0.15)
    # of a lead it is a curve along the stroke
    assert all(one.order > 0.45 for one in strongest_sines(angle, residual, speed, EDGE))


def test_nothing_moves_and_nothing_is_left() -> None:
    rest = np.zeros(500)
    assert strongest_sines(rest, np.ones(500), rest, EDGE) == []
    angle, speed = motion()
    assert strongest_sines(angle, np.zeros(len(angle)), speed, EDGE) == []


def test_gaps_do_not_hide_an_order_behind_orders_of_their_own() -> None:
    angle, _ = motion()
    there = np.sin(2 * np.pi * angle / angle[-1] * 3) > 0.8  # three stretches of the way
    residual = np.sin(5.3 * angle + 0.2)[there] + 2.0
    orders = strongest_orders(angle[there], residual, count=1)
    assert orders == [pytest.approx(5.3, abs=0.01)]


@pytest.mark.parametrize("order", [3.0, 8.0])
def test_several_periods_in_little_more_than_a_revolution_are_found(order: float) -> None:
    """A milling programme of 1.1 revolutions: an order of three has few periods there, one of eight many."""
    angle = 2 * np.pi * 1.1 * (0.5 - 0.5 * np.cos(2 * np.pi * STEP * np.arange(9000) / 2.0))
    residual = 0.5 * np.sin(order * angle + 0.7) + 0.3 * np.random.default_rng(7).standard_normal(len(angle))
    found = strongest_sines(angle, residual, np.gradient(angle, STEP), EDGE)
    nearest = min(found, key=lambda one: abs(one.order - order))
    assert nearest.order == pytest.approx(order, abs=1 / (8 * 1.1))  # an eighth of what they resolve
    assert nearest.amplitude == pytest.approx(0.5, rel=0.15)
    assert strongest_orders(angle / 1.2, residual) == []  # less than a revolution


@pytest.mark.parametrize("seed", range(4))
def test_order_that_leaves_the_band_where_a_drive_overshoots_is_found_in_its_strokes(seed: int) -> None:
    """Its strokes show it, but for an overshoot of 15 %, and reversals show more of what is no sine of the angle."""
    random = np.random.default_rng(seed)
    speed = 2 * np.pi * 8.0 * np.where(np.arange(600) < 20, 1.15, 1.0) * np.minimum(1.0, np.arange(600, 0, -1) / 30)
    rate = np.concatenate([way * speed for way in (1.0, -1.0) * 3])
    angle = np.cumsum(rate) * STEP
    highest = 2 * np.pi * SKIRT * EDGE / np.max(np.abs(rate))
    order = float(random.uniform(1.01, 1.1)) * highest
    bumps = np.where(np.abs(rate) < 0.7 * np.max(speed), 0.3 * np.sign(np.roll(rate, 200)), 0.0)
    residual = 0.1 * np.sin(order * angle + 1.0) + bumps + 0.02 * random.standard_normal(len(angle))
    sines = strongest_sines(angle, residual, rate, EDGE)
    # a tenth of the resolution of a travel of ten turns
    assert min(abs(one.order - order) for one in sines) < 0.01
