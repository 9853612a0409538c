"""Figures of metrology against numbers worked out by hand and made-up signals whose answer is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from feeddrive.errors import InputError
from feeddrive.metrology.circular import circular
from feeddrive.metrology.following import following, settling
from feeddrive.metrology.loops import force_loop, friction_map, torque_loop
from feeddrive.metrology.positioning import positioning
from feeddrive.metrology.response import measured_response, periodic_response, step_response
from feeddrive.simulate.setpoints.waveforms import Multisine

MICRO = 1e-6


def test_iso_230_2_by_hand() -> None:
    """Two targets, three approaches: every figure from the definitions, with pencil and paper."""
    up = np.array([[1.0, 2.0, 3.0], [5.0, 6.0, 7.0]]) * MICRO  # means 2, 6; s 1, 1
    down = np.array([[0.0, 0.0, 0.0], [2.0, 4.0, 6.0]]) * MICRO  # means 0, 4; s 0, 2
    p = positioning(np.array([0.1, 0.2]), up, down)
    found = [
        p.reversal_value, p.mean_reversal, p.repeatability_up, p.repeatability_down, p.repeatability, p.systematic,
        p.systematic_up, p.systematic_down, p.mean_range, p.accuracy, p.accuracy_up, p.accuracy_down,
    ]  # fmt: skip
    # B 2, mean 2; R^ 4, Rv 8, R max(2 + 0 + 2, 2 + 4 + 2) = 8; E 6 - 0; E^ 4, Ev 4; M (1, 5) 4;
    # A 8 - 0 (up 0 .. 8, down 0 .. 8), A^ 8 - 0, Av 8 - 0
    np.testing.assert_allclose(np.array(found) / MICRO, [2, 2, 4, 8, 8, 6, 4, 4, 4, 8, 8, 8], rtol=1e-12)
    np.testing.assert_allclose(p.reversal / MICRO, [2, 2], rtol=1e-12)


def test_positioning_needs_two_approaches() -> None:
    one = np.zeros((2, 1))
    with pytest.raises(InputError, match="approach every target at least twice"):
        positioning(np.array([0.0, 1.0]), one, one)


def test_settling_and_overshoot_of_a_damped_swing() -> None:
    time = np.arange(20_000) * 1e-4
    swing = 1e-5 * np.exp(-(time - 0.5) / 0.1) * np.cos(2 * math.pi * 5 * (time - 0.5))
    position = 0.1 - np.where(time < 0.5, 0.1 - 0.1 * time / 0.5 + 1e-5, swing)
    found = settling(time, position, 0.1, 1, 0.5, 2.0, 2e-6)
    outside = time[np.abs(swing) > 2e-6]
    assert found.time == pytest.approx(outside[outside >= 0.5][-1] + 1e-4 - 0.5, abs=1e-12)
    assert found.overshoot == pytest.approx(-swing[time >= 0.5].min(), rel=1e-12)
    assert settling(time, position, 0.1, 1, 0.5, 0.6, 1e-7).time == math.inf


def test_following_error_has_the_sign_of_drives() -> None:
    found = following(np.array([1.0, 1.0]), np.array([0.9, 0.7]))
    np.testing.assert_allclose([found.mean, found.maximum, found.rms], [0.2, 0.3, math.sqrt(0.05)], rtol=1e-12)


def test_glitch_of_a_circle_is_found_at_its_reversal() -> None:
    """Gain 1.0001, lag 2 mrad and a peak of 8 µm 5 degrees after each reversal, outwards."""
    angle, radius = np.linspace(0, 4 * math.pi, 40_000, endpoint=False), 0.05
    seen = angle - 2e-3
    peak = np.exp(-(((np.mod(seen, math.pi) - math.pi / 2 - math.radians(5)) / math.radians(1.5)) ** 2))
    x = 0.2 + radius * 1.0001 * np.sin(seen) + 8e-6 * np.sign(np.sin(seen)) * peak
    c = circular(angle, x, radius)
    # the peaks' own fundamental is taken out with the circle: 8 µm * 2 * 0.0148 per half turn, below 4 %
    assert c.glitch == pytest.approx((8e-6, 8e-6), rel=0.04)
    assert c.gain == pytest.approx(1.0001, abs=1e-5)
    assert c.lag == pytest.approx(2e-3, abs=2e-5)
    assert c.deviation == pytest.approx(8e-6, rel=0.06)
    with pytest.raises(InputError, match="less than one turn"):
        circular(angle[:8000], x[:8000], radius)


def test_force_loop_of_a_spring_with_play() -> None:
    """A spring of 200 N/µm behind free play of 3 µm: slope of the branches, width and area are known."""
    phase = np.linspace(0, 1, 4001)
    force = 1000 * signal.sawtooth(2 * math.pi * (phase + 0.25), 0.5)
    rising = np.gradient(force) > 0
    displacement = force / 200e6 + np.where(rising, 1.5e-6, -1.5e-6)
    loop = force_loop(force, displacement)
    assert loop.stiffness == pytest.approx(200e6, rel=1e-3)
    assert loop.width == pytest.approx(3e-6, rel=1e-3)
    assert loop.work == pytest.approx(3e-6 * 2000, rel=2e-3)  # a parallelogram, its corners cut by one sample
    with pytest.raises(InputError, match="does not pass zero"):
        force_loop(np.abs(force) + 1, displacement)


def test_torque_loop_of_dry_friction() -> None:
    """0.5 N m of friction that turns over a travel of 10 µm (1/e), and 0.1 N m that always pulls."""
    phase = np.linspace(0, 2 * math.pi, 20_000, endpoint=False)
    position = 0.1 - 1e-3 * np.cos(phase)
    up = phase < math.pi
    since = np.where(up, position - position.min(), position.max() - position)
    torque = 0.1 + np.where(up, 1, -1) * 0.5 * (1 - 2 * np.exp(-since / 10e-6))
    loop = torque_loop(position, torque, 0.02)
    assert loop.friction == pytest.approx(0.5, rel=1e-6)
    assert loop.offset == pytest.approx(0.1, rel=1e-6)
    assert loop.force == pytest.approx(0.5 * 2 * math.pi / 0.02, rel=1e-6)
    # from -63 to +63 %: 10 µm ln(1.63 / 0.37); a sample near the reversal is 0.1 µm
    assert loop.reversal == pytest.approx(10e-6 * math.log(1.63 / 0.37), abs=0.3e-6)


def test_friction_map_takes_the_mean_at_each_velocity() -> None:
    velocity = np.array([0.0, 0.1, 0.1, 0.0, -0.2, -0.2])
    points = friction_map(velocity, np.array([9.0, 1.0, 3.0, 9.0, -4.0, -4.0]), 0.02)
    assert [(point.velocity, point.torque, point.spread) for point in points] == [(-0.2, -4.0, 0.0), (0.1, 2.0, 1.0)]
    assert points[1].force == pytest.approx(2.0 * 2 * math.pi / 0.02)
    with pytest.raises(InputError, match="no constant velocity"):
        friction_map(np.zeros(3), np.zeros(3), 0.02)


def test_response_of_a_known_filter(generator: np.random.Generator) -> None:
    tick = 1e-3
    b, a = signal.butter(2, 100.0, fs=1 / tick)
    wave = Multisine(5.0, 400.0, 1.0, 4)
    given = wave.values(np.arange(4000) * tick)[1]
    output = signal.lfilter(b, a, given)
    found = periodic_response(given[1000:], output[1000:], tick, 1000, wave.frequencies)
    expected = signal.freqz(b, a, wave.frequencies, fs=1 / tick)[1]
    # one second after the start the filter's transient is gone: rounding is left
    np.testing.assert_allclose(found.response, expected, atol=1e-9)
    assert found.averages == 3 and found.coherence.min() > 1 - 1e-9
    noise = generator.normal(size=200_000)
    welch = measured_response(noise, signal.lfilter(b, a, noise), tick, 1000)
    expected = signal.freqz(b, a, welch.frequency, fs=1 / tick)[1]
    # 399 averages without output noise: what leaks between lines, 1 %
    np.testing.assert_allclose(welch.response, expected, atol=0.01)


def test_step_of_a_second_order_system() -> None:
    time = np.arange(4000) * 1e-3
    damping, w = 0.5, 40.0
    plant = signal.TransferFunction([w**2], [1, 2 * damping * w, w**2])
    answer = signal.step(plant, T=time[:3500])[1]
    values = np.concatenate([np.zeros(500), answer]) * 2.0 + 1.0
    found = step_response(time, values, 0.5)
    # textbook: overshoot exp(-pi D / sqrt(1 - D^2)) = 16.3 %; sampling misses 1e-4 of it
    assert found.overshoot == pytest.approx(math.exp(-math.pi * damping / math.sqrt(1 - damping**2)), abs=2e-4)
    assert found.final == pytest.approx(3.0, rel=1e-6)
    assert found.rise == pytest.approx(1.64 / w, abs=1.5e-3)  # textbook value for D = 0.5: 1.64 / w, two samples


@pytest.mark.parametrize(("cut", "settles"), [(3.0, False), (3.7, False), (4.5, True), (9.0, True)])
def test_an_approach_that_is_cut_off_has_not_settled(cut: float, settles: bool) -> None:
    """1 - e^(-t/T) over so many T: it settles to 2 % at 3.9 T, and a record much shorter than that cannot tell."""
    time = np.arange(0.0, 1.0 + cut * 0.1, 1e-4)
    values = np.where(time < 1.0, 0.0, 1 - np.exp(-(time - 1.0) / 0.1))
    found = step_response(time, values, 1.0)
    assert math.isfinite(found.settling) is settles
    if settles:
        # the end value is put too low by e^(-cut): at 4.5 T that costs a tenth of the settling time
        assert found.settling == pytest.approx(0.1 * math.log(50.0), rel=1.05 * (0.02 / 0.9 + 15 * math.exp(-cut)))
