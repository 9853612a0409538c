"""What a trace file does not say, from what must hold: planted in made signals, found, and not found where absent."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.recording import Recording, read_recording, write_recording
from feeddrive.recording.files.reading import with_angle
from feeddrive.recording.traces.channel_choice import Wishes, at_updates, held_rows
from feeddrive.recording.traces.opened import Understood, understand
from feeddrive.recording.traces.resampling import Part, Series, on_one_grid, parts_of
from feeddrive.recording.traces.trace import Signal, Trace
from feeddrive.typing import FloatArray
from tests.analytic.trace_files import current, motion

TIME = np.arange(3000) * 1e-3


def understood(*signals: Signal, wishes: Wishes | None = None) -> Understood:
    """Choose channels of signals."""
    return understand(Trace("made", signals), wishes or Wishes(), "made")


def found(result: Understood, about: str) -> float:
    """Value of a finding."""
    return next(one.value for one in result.choice.findings if one.about == about)


def position(unit: str = "mm", name: str = "ActPos") -> Signal:
    return Signal(name, TIME, motion(TIME)[0], unit)


@pytest.mark.parametrize(("unit", "factor"), [("mm/s", 1.0), ("mm/min", 60.0), ("m/min", 0.06), ("m/s", 1e-3)])
@pytest.mark.parametrize("step", [0.0, 0.05])
def test_unit_of_a_speed_by_the_derivative_of_the_position(unit: str, factor: float, step: float) -> None:
    """Also where the position moves in steps of 50 µm, whose differences show nothing but steps."""
    place = motion(TIME)[0]
    place = np.round(place / step) * step if step else place
    speed = Signal("ActVelo", TIME, factor * motion(TIME)[1])
    result = understood(Signal("ActPos", TIME, place, "mm"), speed)
    assert found(result, "speed") == pytest.approx(factor, rel=1e-3)  # a step of 50 µm in 45 mm
    assert result.channels["table_velocity"] == pytest.approx(1e-3 * motion(TIME)[1], rel=1e-9, abs=1e-12)


def test_even_motion_tells_the_unit_of_a_speed_too() -> None:
    even = Signal("ActPos", TIME, 25.0 * TIME, "mm")
    assert found(understood(even, Signal("ActVelo", TIME, np.full(TIME.size, 1500.0) + 1e-3 * TIME)), "speed") == (
        pytest.approx(60.0, rel=1e-6)
    )


def test_unit_that_contradicts_the_motion_is_said() -> None:
    result = understood(position(), Signal("ActVelo", TIME, 60.0 * motion(TIME)[1], "mm/s"))
    assert any("60 times what its unit mm/s says" in note for note in result.notes)


def test_speed_that_is_no_velocity_is_said_and_not_given_a_unit() -> None:
    result = understood(position(), Signal("CMD_SPEED|1", TIME, 60.0 / 51.0 * motion(TIME)[1]))
    assert any("51 mm/rev if it is rev/min" in note for note in result.notes)
    assert set(result.channels) == {"table_position"}


def test_rotary_axis_is_told_by_degrees_and_rev_per_min() -> None:
    angle = Signal("nckServoDataMeasPos2 [u1, 7]", TIME, motion(TIME)[0], kind="position")
    speed = Signal("nckServoDataActVelMotorSide64 [u1, 7]", TIME, motion(TIME)[1] / 6.0, kind="velocity")
    result = understood(angle, speed)
    assert found(result, "speed") == pytest.approx(1.0 / 6.0, rel=1e-4)
    assert not result.channels  # an angle of a table is neither a length nor an angle of the motor


def test_two_encoders_in_the_unit_of_the_axis_are_compared() -> None:
    motor = Signal("nckServoDataMeasPos1 [u1, 7]", TIME, 1.0001 * motion(TIME)[0], kind="position")
    result = understood(Signal("nckServoDataMeasPos2 [u1, 7]", TIME, motion(TIME)[0], kind="position"), motor)
    assert found(result, "encoders") == pytest.approx(1.0 / 1.0001, rel=1e-9)


def test_lead_of_motor_angle_and_table_position() -> None:
    place = motion(TIME)[0]
    result = understood(position(), Signal("motor angle", TIME, place / 10.0 * 360.0, "deg"))
    assert found(result, "lead") == pytest.approx(0.010, rel=1e-9)
    assert result.channels["motor_angle"] == pytest.approx(place / 10.0 * 2.0 * np.pi, rel=1e-12)


def test_lead_makes_an_angle_of_a_motor_encoder_in_mm() -> None:
    signal = Signal("ENC1_POS|1", TIME, motion(TIME)[0])
    with_lead = understood(signal, wishes=Wishes(lead=0.01))
    assert with_lead.channels["motor_angle"] == pytest.approx(motion(TIME)[0] / 10.0 * 2.0 * np.pi, rel=1e-12)
    assert "needs the lead, --lead" in understood(signal).choice.blocking


def test_torque_constant_and_a_torque_that_is_a_computed_current() -> None:
    amps = current(TIME)
    result = understood(position(), Signal("CURRENT|1", TIME, amps), Signal("TORQUE|1", TIME, 1.4 * amps))
    assert found(result, "torque constant") == pytest.approx(1.4, rel=1e-12)
    assert "motor_current" not in result.channels


def test_torque_that_is_measured_for_itself_stays_beside_the_current(generator: np.random.Generator) -> None:
    amps = current(TIME)
    torque = 1.4 * amps + 0.2 * generator.standard_normal(TIME.size)
    result = understood(position(), Signal("CURRENT|1", TIME, amps), Signal("TORQUE|1", TIME, torque))
    # Noise of 0.2 N m over 3000 samples of a current of 1.5 A: 0.2 / (1.5 * 55) = 0.0024.
    assert found(result, "torque constant") == pytest.approx(1.4, abs=0.01)
    assert {"motor_torque", "motor_current"} <= set(result.channels)


def test_reversed_current_is_turned_and_said() -> None:
    result = understood(position(), Signal("ActCurrent", TIME, -current(TIME), "A"))
    assert found(result, "sign") == -1.0
    assert np.array_equal(result.channels["motor_current"], current(TIME))
    right = understood(position(), Signal("ActCurrent", TIME, current(TIME), "A"))
    assert np.array_equal(right.channels["motor_current"], current(TIME))
    assert not [one for one in right.choice.findings if one.about == "sign"]


def test_current_that_a_person_chose_is_judged_and_not_changed() -> None:
    wishes = Wishes(channels={"motor_current": ("ActCurrent", "A")})
    result = understood(position(), Signal("ActCurrent", TIME, -current(TIME), "A"), wishes=wishes)
    assert found(result, "sign") == -1.0
    assert np.array_equal(result.channels["motor_current"], -current(TIME))


def test_magnitude_is_no_torque_and_a_load_is() -> None:
    magnitude = understood(position(), Signal("ActCurrent", TIME, np.abs(current(TIME)), "A"))
    assert "motor_current" not in magnitude.channels
    hanging = understood(position(), Signal("ActCurrent", TIME, 10.0 + current(TIME), "A"))
    assert "motor_current" in hanging.channels  # never changes its sign either, and follows the motion


def test_current_without_a_sign_in_one_direction_cannot_be_told() -> None:
    time = np.arange(900) * 1e-3  # the speed of this motion changes its sign later
    time = time[motion(time)[1] > 1.0]
    result = understood(
        Signal("ActPos", time, motion(time)[0], "mm"), Signal("ActCurrent", time, 2.0 + 0.1 * time, "A")
    )
    assert any("whether it has one cannot be told" in note for note in result.notes)
    assert "motor_current" in result.channels


def test_following_error_and_gain() -> None:
    place, speed, _ = motion(TIME)
    result = understood(position(), Signal("SetPos", TIME, place + speed / 30.0, "mm"))
    # The slope over ten samples of 1 ms flattens 1.7 Hz by (2 pi 1.7 * 0.005)^2 / 6 = 5e-4.
    assert found(result, "following") == pytest.approx(30.0, rel=1e-3)
    assert any("K_v 30" in note for note in result.notes)


def test_setpoint_that_is_not_followed_is_a_note() -> None:
    result = understood(position(), Signal("SetPos", TIME, 1000.0 * current(TIME), "mm"))
    assert any("ActPos does not follow SetPos" in note for note in result.notes)


@pytest.mark.parametrize("rows", [2, 5, 8])
def test_samples_that_a_slow_bus_held_are_found_and_read_at_their_updates(rows: int) -> None:
    place = motion(TIME)[0]
    held = Signal("ActPos", TIME, place[(np.arange(TIME.size) // rows) * rows], "mm")
    plain, said = at_updates(held)
    assert held_rows(held) == rows
    assert np.array_equal(plain.values, place[::rows][-plain.values.size :])
    assert np.array_equal(plain.time, TIME[::rows][-plain.time.size :])
    assert f"every {rows} rows" in said
    result = understood(held, Signal("ActCurrent", TIME, current(TIME), "A"))
    assert float(np.median(np.diff(result.time))) == pytest.approx(rows * 1e-3, rel=1e-9)


def test_motion_in_even_steps_of_an_encoder_is_not_held() -> None:
    slow = np.floor(np.arange(TIME.size) / 7.0) * 1e-3  # one count every seven samples
    assert held_rows(Signal("ActPos", TIME, slow)) == 1
    assert held_rows(Signal("ActPos", TIME, motion(TIME)[0])) == 1
    assert held_rows(Signal("ActPos", TIME, np.round(motion(TIME)[0], 1))) == 1


def test_two_clocks_are_said() -> None:
    other = np.arange(30_000) * 1e-3 * (1.0 + 78e-6)
    first = Signal("ActPos", np.arange(30_000) * 1e-3, motion(np.arange(30_000) * 1e-3)[0], "mm")
    result = understood(first, Signal("ActCurrent", other, current(other), "A"))
    assert any("two clocks: ActCurrent is sampled +78 ppm slower than ActPos" in note for note in result.notes)


@pytest.mark.parametrize("ppm", [78.0, -200.0])
def test_two_clocks_under_one_time_are_found_by_the_lag(ppm: float, generator: np.random.Generator) -> None:
    time = np.arange(30_000) * 1e-3
    place = motion(time)[0] + 1e-3 * generator.standard_normal(time.size)
    other = motion(time * (1.0 + ppm * 1e-6))[1] + 0.1 * generator.standard_normal(time.size)
    result = understood(Signal("ActPos", time, place, "mm"), Signal("ActVelo", time, other, "mm/s"))
    finding = next(one for one in result.choice.findings if one.about == "two clocks")
    # What shows the motion of a later time runs ahead: its lag shrinks.
    assert finding.value == pytest.approx(-ppm * 1e-6, abs=4.0 * finding.scatter)
    one_clock = Signal("ActVelo", time, motion(time)[1] + 0.1 * generator.standard_normal(time.size), "mm/s")
    late = Signal("ActVelo", time, motion(time - 0.002)[1], "mm/s")
    for signal in (one_clock, late):  # a constant lag is no drift
        other_result = understood(Signal("ActPos", time, place, "mm"), signal)
        assert not [one for one in other_result.choice.findings if one.about == "two clocks"]


def test_lost_samples_divide_a_recording() -> None:
    kept = np.delete(np.arange(TIME.size), [1000, 1001])
    result = understood(Signal("ActPos", TIME[kept], motion(TIME[kept])[0], "mm"))
    assert any("2 samples are missing behind row 1000 of ActPos" in note for note in result.notes)
    assert (result.time[0], result.time[-1]) == (TIME[1002], TIME[-1])


def test_speed_alone_is_integrated(tmp_path: Path) -> None:
    speed = 10.0 * np.cos(TIME)
    columns, said = with_angle({"motor_speed": speed}, TIME)
    # The trapezoidal rule is wrong by (h^2 / 12) of the change of the derivative.
    assert columns["motor_angle"] == pytest.approx(10.0 * np.sin(TIME), abs=1e-6 / 12 * 10 * 2)
    assert said
    write_recording(Recording("a", TIME, {"motor_speed": speed}, 1e-3), tmp_path / "a.csv")
    assert "motor_angle" in read_recording(tmp_path / "a.csv")
    assert with_angle({"motor_speed": speed, "motor_angle": speed}, TIME)[1] == ()


def grid(rate: float | None, **series: Series) -> tuple[FloatArray, dict[str, FloatArray], tuple[str, ...]]:
    return on_one_grid(series, parts_of(series, "made")[0], rate, "made")


def test_torque_at_a_higher_rate_is_averaged_over_each_step_and_positions_are_read_at_their_instants() -> None:
    fast = np.arange(4000) * 2.5e-4
    slow = np.arange(1000) * 1e-3
    ramp = np.arange(4000.0)
    time, channels, said = grid(None, motor_torque=Series(fast, ramp), table_position=Series(slow, np.arange(1000.0)))
    assert np.array_equal(time, slow[time.size * 0 : time.size])
    assert channels["motor_torque"][:3] == pytest.approx([1.5, 5.5, 9.5], abs=1e-9)  # of 0 1 2 3, of 4 5 6 7, ...
    assert np.array_equal(channels["table_position"], np.arange(float(time.size)))
    assert "averaged over each step" in said[0]


def test_channels_of_one_time_are_not_touched() -> None:
    values = np.sin(TIME)
    time, channels, said = grid(None, motor_torque=Series(TIME, values), table_position=Series(TIME.copy(), values))
    assert time.size == TIME.size and said == ()
    assert all(np.array_equal(one, values) for one in channels.values())


def test_rate_that_is_asked_for() -> None:
    time, channels, said = grid(4000.0, motor_torque=Series(TIME, TIME), table_position=Series(TIME, TIME))
    assert float(np.median(np.diff(time))) == pytest.approx(2.5e-4, rel=1e-9)
    assert channels["motor_torque"][:5].tolist() == [0.0, 0.0, 0.0, 0.0, 0.001]  # it acts to the next sample
    assert channels["table_position"] == pytest.approx(time, abs=1e-15)
    assert "held from its sample to the next" in said[0] and "straight line" in said[0]
    with pytest.raises(InputError, match="give a lower --rate"):
        grid(1e12, table_position=Series(TIME, TIME))


def test_setpoint_of_a_slow_task_does_not_slow_the_recording() -> None:
    slow = TIME[::8]
    time, _, _ = grid(None, setpoint=Series(slow, slow), table_position=Series(TIME, TIME))
    assert float(np.median(np.diff(time))) == pytest.approx(1e-3, rel=1e-9)


def test_parts_of_channels_are_those_in_which_all_are_there() -> None:
    first = np.delete(TIME, slice(500, 600))
    second = np.delete(TIME, slice(2000, 2010))
    parts = parts_of({"a": Series(first, first), "b": Series(second, second)}, "made")
    assert parts == [Part(TIME[0], TIME[499]), Part(TIME[600], TIME[1999]), Part(TIME[2010], TIME[-1])]
    with pytest.raises(InputError, match="share no time"):
        parts_of({"a": Series(TIME, TIME), "b": Series(TIME + 10.0, TIME)}, "made")


def test_two_signals_that_may_be_one_channel_are_asked_for() -> None:
    result = understood(position(), position(name="Act Pos"), Signal("ActCurrent", TIME, current(TIME), "A"))
    assert "--channel 'table_position=ActPos'" in result.choice.blocking
    settled = understood(
        position(), position(name="Act Pos"), wishes=Wishes(channels={"table_position": ("Act Pos", "")})
    )
    assert set(settled.channels) == {"table_position"}


def test_unit_that_does_not_fit_a_channel_is_refused() -> None:
    with pytest.raises(InputError, match="is in mm, which is no unit of motor_torque"):
        understood(position(), wishes=Wishes(channels={"motor_torque": ("ActPos", "")}))
    with pytest.raises(InputError, match='did you mean "ActPos"'):
        understood(position(), wishes=Wishes(channels={"table_position": ("ActPso", "mm")}))


def test_value_that_is_no_number_is_refused_with_its_time() -> None:
    broken = position()
    broken.values[100] = np.nan
    with pytest.raises(InputError, match=r"table_position holds a value that is not a number, at 0.1 s"):
        understood(replace(broken, unit="mm"))
