"""Frequency responses against closed forms: rigid axis, three inertias, delay, compliance, margins, families."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.metrology.response import recorded_response
from feeddrive.plant.chain.chain import Rigid, ThreeInertias
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording.recording import Recording
from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.servo.filters import pt2
from feeddrive.servo.linear_loop import closed_loop, open_velocity_loop
from feeddrive.servo.loop_response import Loop, closed_figures, closed_response, controlled_response, open_response
from feeddrive.servo.margins import frequency_response, margins
from feeddrive.servo.mechanics_response import Case, delay_of, mechanics
from feeddrive.servo.resonances import Kind, extrema, on_curve
from feeddrive.servo.response_family import mechanics_family
from feeddrive.simulate.held_torque import simulate_torque
from feeddrive.simulate.scenario.scenario_controller import read_controller
from feeddrive.typing import FloatArray

LEAD, VISCOUS = 0.020, 300.0
RADIUS = LEAD / (2 * math.pi)
INERTIAS = {"motor_inertia": 2.6e-3, "screw_inertia": 2.37e-3, "table_mass": 134.0}
SPRINGS = {"torsional_stiffness": 11_982.4, "torsional_damping": 0.074, "axial_stiffness": 244.7e6,
           "axial_damping": 8650.0}  # fmt: skip
INERTIA = 2.6e-3 + 2.37e-3 + 134.0 * RADIUS**2
# viscous alone, so that the plant is linear: the Coulomb level is 1e-9 N
VISCOUS_GUIDE = GuideFriction.of(coulomb=1e-9, smoothing_velocity=1e-3, viscous=VISCOUS)
RIGID = Plant("rigid", Rigid({"lead": LEAD, **INERTIAS}), (VISCOUS_GUIDE,))
ELASTIC = Plant("bench", ThreeInertias({"lead": LEAD, **INERTIAS, **SPRINGS}), (VISCOUS_GUIDE,))
SERVO = Cascade(RADIUS, 125e-6, 4, 60.0, 2.0, 0.015, 0.015, feedback=Feedback.TABLE, current_lag=150e-6, dead_time=2e-4)


def dynamic_stiffness(s: complex) -> FloatArray:
    """M s^2 + C s + K of the three inertias, written out; coordinates motor, screw, table."""
    kt, ct, ka, ca = (SPRINGS[key] for key in SPRINGS)
    t, a, r = ct * s + kt, ca * s + ka, RADIUS
    return np.array([
        [2.6e-3 * s**2 + t, -t, 0],
        [-t, 2.37e-3 * s**2 + t + r * r * a, -r * a],
        [0, -r * a, 134.0 * s**2 + VISCOUS * s + a],
    ])  # fmt: skip


def test_rigid_axis_is_its_closed_form() -> None:
    """Speed over torque is 1 / (J s + d r^2); magnitude in dB, phase in degrees."""
    found = mechanics(RIGID, "motor_torque", "motor_speed", Case(), 0.1, 2000.0)
    exact = 1 / (2j * math.pi * found.frequency * INERTIA + VISCOUS * RADIUS**2)
    # 1e-9 N of Coulomb friction leave a slope of 1e-6 N s/m beside 300
    np.testing.assert_allclose(found.values, exact, rtol=1e-8)
    np.testing.assert_allclose(found.decibel, 20 * np.log10(np.abs(exact)), atol=1e-7)
    np.testing.assert_allclose(found.degrees, np.degrees(np.angle(exact)), atol=1e-6)
    assert found.marks == () and found.unit == "(rad/s)/(N m)"


@pytest.mark.parametrize(("given", "output", "column", "row", "factor"), [
    ("motor_torque", "motor_angle", 0, 0, 0), ("motor_torque", "table_velocity", 0, 2, 1),
    ("cutting_force", "table_position", 2, 2, 0), ("cutting_force", "motor_speed", 2, 0, 1),
])  # fmt: skip
def test_three_inertias_are_the_inverse_of_their_dynamic_stiffness(
    given: str, output: str, column: int, row: int, factor: int
) -> None:
    found = mechanics(ELASTIC, given, output, Case(), 5.0, 1500.0)
    s = 2j * math.pi * found.frequency
    exact = np.array([np.linalg.inv(dynamic_stiffness(one))[row, column] * one**factor for one in s])
    # a dip 100 dB below the rest keeps fewer digits
    np.testing.assert_allclose(found.values, exact, rtol=1e-6)


def test_anti_resonances_are_the_modes_with_the_motor_held() -> None:
    """Undamped: zeros of the torque-to-speed response solve det of screw and table alone, poles that of all three."""
    bare = {**SPRINGS, "torsional_damping": 0.0, "axial_damping": 0.0}
    plant = Plant("undamped", ThreeInertias({"lead": LEAD, **INERTIAS, **bare}), (
        GuideFriction.of(coulomb=1e-9, smoothing_velocity=1e-3, viscous=1e-9),))  # fmt: skip
    kt, ka, r2 = bare["torsional_stiffness"], bare["axial_stiffness"], RADIUS**2
    js, jm, m = 2.37e-3, 2.6e-3, 134.0
    held = np.roots([js * m, -(js * ka + m * (kt + r2 * ka)), kt * ka])
    # det of the free chain over w^2
    free = np.roots([jm * js * m, -(jm * js * ka + jm * m * (kt + r2 * ka) + js * m * kt),
                     (jm + js) * kt * ka + kt * r2 * ka * m])  # fmt: skip
    found = mechanics(plant, "motor_torque", "motor_speed", Case(), 1.0, 2000.0).marks
    for kind, squared in ((Kind.ANTI_RESONANCE, held), (Kind.RESONANCE, free)):
        seen = [root.frequency for root in found if root.kind is kind]
        np.testing.assert_allclose(seen, np.sort(np.sqrt(squared)) / (2 * math.pi), rtol=1e-9)
        assert all(abs(root.damping) < 1e-9 for root in found if root.kind is kind)


def test_curve_shows_what_poles_and_zeros_say() -> None:
    """At 2 % damping peaks and dips lie within a percent of poles and zeros."""
    found = mechanics(ELASTIC, "motor_torque", "motor_speed", Case(), 1.0, 2000.0)
    seen = extrema(found.frequency, found.values)
    assert [root.kind for root in found.marks] == [Kind.ANTI_RESONANCE, Kind.RESONANCE] * 2
    for root in found.marks:
        one = on_curve(root, seen)
        assert one is not None and one.frequency == pytest.approx(root.frequency, rel=0.01)


def test_peak_of_one_oscillator_is_exact() -> None:
    """|G| of 1 / (s^2 + 2 D w s + w^2) peaks at w sqrt(1 - 2 D^2) with 1 / (2 D w^2 sqrt(1 - D^2))."""
    w, damping = 2 * math.pi * 100, 0.1
    frequency = np.geomspace(10, 1000, 600)
    s = 2j * math.pi * frequency
    (peak,) = extrema(frequency, 1 / (s**2 + 2 * damping * w * s + w**2))
    # the parabola through points 0.8 % apart
    assert peak.frequency == pytest.approx(100 * math.sqrt(1 - 2 * damping**2), rel=1e-4)
    height = 1 / (2 * damping * w**2 * math.sqrt(1 - damping**2))
    assert peak.decibel == pytest.approx(20 * math.log10(height), abs=1e-3)


def test_delay_is_exactly_a_phase() -> None:
    """A drive delay of 1 ms turns the torque's response by 360 deg per kHz, and that of the force not at all."""
    late = ELASTIC.with_effects(DriveDelay.of(delay=1e-3))
    assert delay_of(late) == 1e-3
    for given, seconds in (("motor_torque", 1e-3), ("cutting_force", 0.0)):
        one, other = (mechanics(plant, given, "motor_speed", Case(), 1.0, 900.0) for plant in (ELASTIC, late))
        turned = np.exp(-2j * math.pi * one.frequency * seconds)
        np.testing.assert_allclose(other.values, one.values * turned, rtol=1e-12)


def test_payload_and_position_make_a_monotone_family() -> None:
    """More mass, and a nut further from the fixed bearing, lower the first resonance."""
    loads = mechanics_family(
        ELASTIC, "motor_torque", "motor_speed", [Case(payload=m) for m in (-50, 0, 50, 100)], 50, 600
    )
    kimm = read_plant(find_plant("kimm_testbed"))
    places = mechanics_family(kimm, "motor_torque", "table_position", [Case(x) for x in (0.0, 0.4, 1.0)], 50, 600)
    for family in (loads, places):
        first = [next(one.frequency for one in curve.seen if one.kind is Kind.RESONANCE) for curve in family.curves]
        assert first == sorted(first, reverse=True) and len(set(first)) == len(first)


def test_margins_are_those_of_control() -> None:
    """The rigid axis has one crossing of each kind, where control.margin interpolates the same loop."""
    system = open_velocity_loop(RIGID, SERVO)
    found = margins(system)
    omega = 2 * math.pi * np.geomspace(10.0, 2000.0, 2000)
    values = system(np.exp(1j * omega * system.dt))
    gain, phase, at_180, at_1 = control.margin((np.abs(values), np.degrees(np.unwrap(np.angle(values))), omega))
    # linear interpolation between 20000 points
    assert found.gain == pytest.approx(20 * math.log10(gain), abs=1e-3)
    assert found.phase == pytest.approx(phase, abs=1e-3)
    assert found.gain_frequency == pytest.approx(at_180 / (2 * math.pi), rel=1e-4)
    assert found.phase_frequency == pytest.approx(at_1 / (2 * math.pi), rel=1e-4)
    response, same = open_response(RIGID, SERVO, Loop.VELOCITY, Case(), 1.0, 4000.0)
    assert same == found
    np.testing.assert_allclose(response.frd().omega, 2 * math.pi * response.frequency)
    np.testing.assert_allclose(response.frd().eval(2 * math.pi * response.frequency), response.values)


def test_small_response_does_not_cancel() -> None:
    """A closed position loop that has fallen to 1e-6: by elimination with 64 bits of mantissa, where there are so many.

    Its states are metres, torques and integrals of speed. Solved as they are, their sum was known to 1e-13, which is
    1e-7 of the loop; a margin or a comparison there would be one of rounding.
    """
    if np.finfo(np.longdouble).nmant < 63:
        pytest.skip("the longest number of this machine is a double")
    plant = read_plant(find_plant("kimm_testbed"))
    servo = Cascade(plant.chain.motor_radius, 125e-6, 4, 60.0, 8.0, 5e-3, 5e-3, torque_filters=(pt2(600.0, 0.7),) * 3,
                    current_lag=160e-6, dead_time=125e-6, feedback=Feedback.MOTOR)  # fmt: skip
    loop = closed_loop(plant, servo, 0.05, 0.5)["measured_position", "position"]
    frequency = np.array([300.0, 800.0, 970.0, 995.0])
    a, b, c = (np.asarray(one, dtype=np.clongdouble) for one in (loop.A, loop.B, loop.C))
    found = frequency_response(loop, frequency)
    assert np.abs(found).min() < 1e-4
    for f, value in zip(frequency, found, strict=True):
        z = np.exp(2j * np.pi * np.longdouble(f) * np.longdouble(loop.dt))
        exact = (c @ _eliminated(z * np.eye(len(a)) - a, b[:, 0]))[0]
        assert abs(value - exact) < 1e-11 * abs(exact), abs(value - exact) / abs(exact)


def _eliminated(matrix: np.ndarray, given: np.ndarray) -> np.ndarray:
    """The solution by elimination with the largest pivot, in the numbers given."""
    a, x = matrix.copy(), given.copy()
    for k in range(len(a)):
        p = k + int(np.argmax(np.abs(a[k:, k])))
        a[[k, p]], x[[k, p]] = a[[p, k]], x[[p, k]]
        factor = a[k + 1 :, k] / a[k, k]
        a[k + 1 :] -= factor[:, None] * a[k]
        x[k + 1 :] -= factor * x[k]
    for k in range(len(a) - 1, -1, -1):
        x[k] = (x[k] - a[k, k + 1 :] @ x[k + 1 :]) / a[k, k]
    return x


def test_closed_position_loop_of_a_slow_gain_is_a_first_order_lag() -> None:
    """K_v far below the velocity loop: bandwidth K_v / 2 pi, no peak."""
    slow = replace(SERVO, position_gain=3.0, velocity_gain=2.0, reset_time=math.inf, tracking_time=1.0)
    response = closed_response(RIGID, slow, Loop.POSITION, Case(), 0.01, 50.0)
    figures = closed_figures(response)
    # the velocity loop, at 50 Hz, and viscous friction turn it by a percent
    assert figures.bandwidth == pytest.approx(3.0 / (2 * math.pi), rel=0.02)
    assert figures.peak < 0.01


def test_static_compliance_of_the_controlled_axis() -> None:
    """Position from the motor encoder, integrator in the velocity loop: the table alone gives way by 1/k."""
    servo = replace(SERVO, feedback=Feedback.MOTOR)
    response = controlled_response(ELASTIC, servo, "cutting_force", "table_position", Case(), 0.01, 10.0)
    compliance = 1 / SPRINGS["axial_stiffness"] + RADIUS**2 / SPRINGS["torsional_stiffness"]
    # at 0.01 Hz the integrator has taken the rest but for a thousandth
    assert abs(response.values[0]) == pytest.approx(compliance, rel=2e-3)
    assert response.unit == "m/N"


def test_recording_gives_the_response_of_the_machine() -> None:
    """Hold and difference are taken out: speed from recorded angles meets the linear curve."""
    tick, count = 1 / 4000, 16_000
    bits = np.random.default_rng(3).integers(0, 2, count) * 2.0 - 1.0
    time, torque = tick * np.arange(count), VISCOUS * 0.05 * RADIUS + bits
    run = simulate_torque(ELASTIC, time, torque, 0.0, 0.05)
    recording = Recording("shaken", time, {"motor_torque": torque, "motor_angle": run.motor_angle}, tick)
    measured = recorded_response(recording, "motor_torque", "motor_speed")
    linear = mechanics(ELASTIC, "motor_torque", "motor_speed", Case(), 10.0, 2000.0)
    chosen = (measured.coherence > 0.99) & (measured.frequency > 20) & (measured.frequency < 1000)
    exact = np.interp(measured.frequency[chosen], linear.frequency, linear.values)
    error = np.abs(measured.response[chosen] / exact - 1)
    assert chosen.sum() > 150
    # spectra of 16 averages over windows of 2.1 Hz
    assert np.median(error) < 0.05 and np.quantile(error, 0.9) < 0.15


def test_recordings_that_cannot_be_used_are_refused() -> None:
    time = np.arange(2000) * 1e-3
    recording = Recording("r", time, {"motor_torque": np.zeros(2000), "motor_angle": time}, 1e-3)
    with pytest.raises(InputError, match="motor_torque does not change"):
        recorded_response(recording, "motor_torque", "motor_speed")
    moved = recording.with_channels({"motor_torque": np.sin(40 * time)})
    with pytest.raises(InputError, match="no channel table_velocity"):
        recorded_response(moved, "motor_torque", "table_velocity")
    with pytest.raises(InputError, match="is no input of the mechanics"):
        recorded_response(moved, "motor_angle", "motor_torque")
    with pytest.raises(InputError, match="too few for 16 averages"):
        recorded_response(moved.between(0.0, 0.1), "motor_torque", "motor_speed")


def test_controller_is_read_from_a_scenario_for_another_plant() -> None:
    kimm = read_plant(find_plant("kimm_testbed"))
    scenarios = Path(__file__).resolve().parents[2] / "scenarios"
    one, other = (
        read_controller(scenarios / name, kimm) for name in ("step_position.toml", "controllers/bench_axis.toml")
    )
    assert one == other and one.radius == pytest.approx(kimm.chain.motor_radius)
