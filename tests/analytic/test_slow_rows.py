"""Rows slower than a drive's cycle: where the motion between them is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, sosfiltfilt

from feeddrive.diagnosis.motion.band import END_CUT, comparison_band
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.motion.slow_rows import BOUND, is_slow, known_motion, refuse_unknown_motion, sentence
from feeddrive.diagnosis.suspicion.logged import declared_hold
from feeddrive.errors import InputError
from feeddrive.plant.analysis.modes import braked_modes, inertia_at_motor, lag_per_acceleration
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.plant import DeclaredCascade, Plant
from feeddrive.recording import Recording
from tests.convergence.test_simulate import BENCH

PLANT = Plant("axis", BENCH)
STEP = 0.01


def recording(angle: np.ndarray, torque: np.ndarray) -> Recording:
    """Rows of 10 ms with sensor noise: 40 mN m, and an encoder of 22 bit."""
    generator = np.random.default_rng(2)
    encoder = 2 * np.pi / 2**22
    channels = {
        "motor_angle": encoder * np.round(angle / encoder),
        "motor_torque": torque + 0.04 * generator.standard_normal(len(torque)),
    }
    return Recording("slow", STEP * np.arange(len(angle)), channels, STEP)


def known(made: Recording) -> np.ndarray:
    """Rows with known motion."""
    return known_motion(made, PLANT, comparison_band(PLANT, 1 / made.sample_time))


def test_a_cycle_of_two_milliseconds_is_not_slow() -> None:
    made = recording(np.zeros(1000), np.zeros(1000))
    assert is_slow(made)
    assert not is_slow(replace(made, sample_time=2e-3))


def test_constant_speed_is_known_and_the_jump_of_acceleration_is_not() -> None:
    time = STEP * np.arange(2000)
    angle = np.where(time < 10.0, 30.0 * time, 300.0 - 30.0 * (time - 10.0))  # it turns round within a row
    rows = known(recording(angle, np.where(time < 10.0, 1.0, -1.0)))
    reach = 10  # of a filter at a tenth of the rate
    assert not rows[1000 - reach : 1000 + reach].any()
    assert rows[: 1000 - 2 * reach].all() and rows[1000 + 2 * reach :].all()


def test_vibration_between_rows_is_left_out_where_it_looks_slow_as_well() -> None:
    time = STEP * np.arange(3000)
    frequency = np.where(time > 15.0, 70.0 + 40.0 * (time - 15.0), 0.0)  # through 100 Hz, the rate of the rows
    torque = 1.0 + np.where(time > 15.0, 2.0 * np.sin(2 * np.pi * np.cumsum(frequency) * STEP), 0.0)
    rows = known(recording(30.0 * time, torque))
    assert not rows[1520:2980].any()
    assert rows[:1450].all()


def test_recording_of_which_hardly_a_row_is_left_is_refused() -> None:
    made = recording(np.zeros(300), np.zeros(300))
    rows = np.arange(300) < 40
    with pytest.raises(InputError, match="10 ms apart is known at 40 of them"):
        refuse_unknown_motion(rows, np.ones(300, dtype=bool), made)
    refuse_unknown_motion(~rows, np.ones(300, dtype=bool), made)
    assert "87 % of the rows are left out" in sentence(rows, made)


def test_torque_of_slow_rows_is_that_of_half_a_cycle_later() -> None:
    """A torque that rises with time, held for 2 ms from the instant at which a row of 10 ms is written."""
    time = STEP * np.arange(800)
    made = recording(20.0 * time, time)
    held, at_once = (prepare(made, PLANT, 1.0, hold).measured["motor_torque"] for hold in (2e-3, None))
    inner = slice(100, -100)
    assert np.mean(at_once[inner] - held[inner]) == pytest.approx(
        1e-3, rel=0.03
    )  # 1 N m/s for 1 ms; noise leaves 0.7 %


def test_declared_cycle_is_taken_however_far_rows_are_apart() -> None:
    gains = {"position_gain": "10 1/s", "velocity_gain": "1 N m s/rad", "reset_time": "20 ms", "torque_limit": "30 N m"}
    loop = {"velocity_rate": "500 Hz", "position_rate": "500 Hz", **gains}
    plant = replace(PLANT, controller=DeclaredCascade(loop, "plant.toml"))
    slow = recording(np.zeros(1000), np.zeros(1000))
    assert declared_hold(plant, [slow]) == pytest.approx(2e-3)
    assert declared_hold(plant, [replace(slow, sample_time=2e-3)]) is None  # a row a cycle


def test_steps_of_a_coarse_encoder_are_no_unknown_motion() -> None:
    time = STEP * np.arange(2000)
    made = recording(30.0 * time, np.ones(2000))
    coarse = 2 * np.pi / 2**12
    angle = coarse * np.round(30.0 * time / coarse)
    rows = known(replace(made, channels={**made.channels, "motor_angle": angle}))
    assert rows[20:-20].mean() > 0.98


def test_rows_are_left_out_where_a_faster_loop_moves_between_them() -> None:
    """Rows of 2 ms, the axis turning round within one: known of a drive of one cycle a row alone."""
    time = 2e-3 * np.arange(4000)
    angle = np.where(time < 4.0, 30.0 * time, 120.0 - 30.0 * (time - 4.0))
    made = recording(angle, np.where(time < 4.0, 1.0, -1.0))
    made = replace(made, time=time, sample_time=2e-3)
    every, faster = (prepare(made, PLANT, 1.0, hold).counted for hold in (None, 5e-4))
    assert every[2000] and not faster[1995:2005].any()
    assert faster[600:1900].all()


def test_rows_are_left_out_while_the_load_rings_after_motion_that_is_not_known() -> None:
    """A turn within a row sets the load ringing; dampers a fifth as strong keep it so five times as long."""
    time = 4e-3 * np.arange(3000)
    angle = np.where(time < 6.0, 30.0 * time, 180.0 - 30.0 * (time - 6.0)) + np.sin(time)
    made = replace(recording(angle, np.where(time < 6.0, 1.0, -1.0)), time=time, sample_time=4e-3)
    gone = []
    for share in (1.0, 0.2):
        weak = {key: share * BENCH.values[key] for key in ("axial_damping", "torsional_damping")}
        plant = Plant("axis", ThreeInertias({**BENCH.values, **weak}))  # its modes are faster than 125 Hz
        rows = known_motion(made, plant, comparison_band(plant, 250.0))
        assert rows[:1450].all()  # nothing rings beforehand
        lost = 4e-3 * np.flatnonzero(~rows[1500:]).max(initial=0)
        gone.append(lost * min(-pole.real for pole in braked_modes(plant, plant.middle).poles))
        assert rows[-200:].all()
    assert gone[0] == pytest.approx(gone[1], rel=0.3)  # so many time constants either way
    soft = Plant("axis", ThreeInertias({**BENCH.values, "axial_stiffness": 5e7, "torsional_damping": 3.0}))
    assert known_motion(made, soft, comparison_band(soft, 250.0))[1530:].all()  # the slow mode is seen as it is


def test_a_channel_without_noise_is_compared_as_far_as_its_rows_tell_the_motion() -> None:
    """A simulation has no noise of a sensor; its motion between rows is known to the error of the second difference."""
    step, time = 1e-3, np.arange(8000) * 1e-3
    past = (time - 4.0) / 0.03
    angle = 3.0 * time + np.exp(-(past**2))  # constant speed, and one short bump
    table = BENCH.motor_radius * angle + 5e-5 * np.sin(time)
    exact = Recording("simulated", time, {"motor_angle": angle, "table_position": table}, step)
    acceleration = (4 * past**2 - 2) / 0.03**2 * np.exp(-(past**2))
    missed = np.diff(angle, 2) / step**2 - acceleration[1:-1]
    inside = (time >= END_CUT) & (time <= time[-1] - END_CUT)
    expected = lag_per_acceleration(PLANT) * np.sqrt(np.mean(missed[inside[1:-1]] ** 2))
    found = prepare(exact, PLANT, 1.0).noise["table_position"]
    assert found == pytest.approx(expected, rel=0.01)  # the next term of the series is (h / 0.03 s)^2
    noisy = table + 1e-10 * np.random.default_rng(3).standard_normal(len(table))
    measured = replace(exact, channels={"motor_angle": angle, "table_position": noisy})
    assert prepare(measured, PLANT, 1.0).noise["table_position"] < 1e-10 < found


@pytest.mark.parametrize("share", [0.05, 0.2, 0.4, 0.6, 0.7])
def test_the_bound_of_the_acceleration_holds_for_the_spline(share: float) -> None:
    """Of a sine at a share of half the rate: what the spline misses of the acceleration, and the bound on it."""
    rows = np.arange(400)
    sine = np.sin(np.pi * share * rows + 0.3)
    inner = slice(100, 300)  # the spline's ends are told there by a thousandth of nothing
    missed = np.max(np.abs(make_interp_spline(rows, sine, k=5)(rows, 2) + (np.pi * share) ** 2 * sine)[inner])
    sixth = np.max(np.abs(np.diff(sine, 6))[97:297])
    assert sixth / 720 < missed < sixth / 90 < BOUND[6] * sixth


def test_the_bound_of_the_acceleration_is_that_of_a_jump_in_the_band() -> None:
    rows, shares = np.arange(400), []
    filtered = butter(4, 0.1, fs=1.0, output="sos")
    for place in np.linspace(199.5, 200.5, 41):
        angle = 0.5 * np.maximum(rows - place, 0.0) ** 2
        missed = make_interp_spline(rows, angle, k=5)(rows, 2) - (rows > place)
        shares.append(np.max(np.abs(sosfiltfilt(filtered, missed))) / np.max(np.abs(np.diff(angle, 6))))
    assert np.mean(shares) == pytest.approx(BOUND[6], rel=0.1)  # written as a round number


def test_a_ripple_that_the_rows_show_well_is_no_unknown_motion() -> None:
    """At 0.2 of half the rate: the spline misses a fiftieth of the noise of the torque, the bound is a half of it."""
    step, count = 1e-3, 6000
    time, random = step * np.arange(count), np.random.default_rng(2)
    w, encoder = 2 * np.pi * 97.3, 2 * np.pi / 2**26
    angle = 3.0 * time + 4.0 / (inertia_at_motor(PLANT) * w**2) * np.sin(w * time)
    channels = {"motor_angle": encoder * np.round(angle / encoder), "motor_torque": random.normal(1.0, 0.04, count)}
    # noise alone looks like a jump of the torque at a row of a thousand, of which the filter reaches twenty
    assert known(Recording("fast", time, channels, step))[20:-20].mean() > 0.97


def test_rows_left_out_between_a_drives_cycles_are_told() -> None:
    """Rows of 1 ms of a drive of four cycles in each: it jerks once, and the remark says what that costs."""
    step, time = 1e-3, np.arange(8000) * 1e-3
    random = np.random.default_rng(5)
    angle = np.where(time < 4.0, 30.0 * time, 120.0 - 30.0 * (time - 4.0)) + 1e-6 * np.round(random.normal(size=8000))
    channels = {"motor_angle": angle, "motor_torque": np.where(time < 4.0, 1.0, -1.0) + random.normal(0, 0.04, 8000)}
    made = Recording("fast", time, channels, step)
    remarks = prepare(made, PLANT, 1.0, hold=step / 4).recording.notes
    (said,) = (one for one in remarks if "cycles in each" in one)
    assert "of the rows are left out: the drive has several cycles in each of 1 ms" in said
    share = float(said.split(" %")[0].split()[-1])
    assert 0.1 < share < 50
    assert not any("cycles in each" in one for one in prepare(made, PLANT, 1.0).recording.notes)
    with pytest.raises(InputError, match="record every cycle of the drive"):
        refuse_unknown_motion(np.zeros(8000, dtype=bool), np.ones(8000, dtype=bool), made)
