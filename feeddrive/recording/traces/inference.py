"""What a trace file does not say, from what must hold between its signals: stated with factor and scatter.

| relation | what follows |
|---|---|
| integral of a speed against a position | the unit of the speed; whether a position counts mm or degrees |
| torque against current | the torque constant, and whether the torque is a computed current |
| table position against motor angle | the lead |
| torque against acceleration and direction | the sign; a current without a sign |
| position against its set-point | following error and K_v |

A factor is the slope of a regression, its scatter the rms of the rest relative to that of the signal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.recording.traces.naming import MOTOR_SIDE, Candidate, conversion, known_unit
from feeddrive.recording.traces.relations import (
    FEWEST,
    Fit,
    at_times,
    clock_drift,
    explained,
    fit,
    smooth_slope,
    speed_factor,
)
from feeddrive.recording.traces.trace import Signal
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

Taken = dict[str, tuple[Signal, Candidate]]

_CLOSE = 0.05  # scatter above which two signals are not the same motion
_NEAR = 0.05  # of a factor from that of a unit; the nearest two units differ by 1.67 (mm/min and in/s apart, by 16.7)
_COMPUTED = 0.999  # correlation of torque and current above which one is computed from the other
_EXPLAINS = 0.5  # share of a torque that acceleration and direction explain where it has a sign
_MOVING = 0.02  # of the greatest speed; below it an axis counts as at rest
_SPEED_UNITS = {"mm": ("mm/s", "mm/min", "m/s", "m/min", "µm/s"), "deg": ("deg/s", "rev/min", "rad/s", "deg/min")}
_SPEED_NAMES = ("velocity", "speed")


@dataclass(frozen=True)
class Finding:
    """What two signals say about each other.

    Attributes:
        about: kind of relation.
        text: for people.
        value: factor, in `unit`.
        unit: of the factor.
        scatter: rms of what the factor leaves, relative to the signal [1].
    """

    about: str
    text: str
    value: float
    unit: str
    scatter: float


def infer(taken: Taken, signals: Sequence[Signal], fixed: set[str]) -> tuple[tuple[Finding, ...], Taken]:
    """Find what holds between signals of an axis, and use it for what the file does not say; `fixed` ones stay.

    Channels that a person chose are fixed: judged and not changed. Returns what was found, and the channels with units
    and signs inferred, without those that are not what they seem.
    """
    found: list[Finding] = []
    taken = dict(taken)
    _encoders(taken, found)
    _speeds(taken, signals, fixed, found)
    _lead(taken, found)
    _torque_constant(taken, signals, fixed, found)
    for channel in ("motor_torque", "motor_current"):
        if channel in taken:
            _sign(channel, taken, fixed, found)
    _following(taken, found)
    return tuple(found), taken


def _position(taken: Taken) -> tuple[Signal, str] | None:
    """Return the signal and unit of the position that speeds are compared with."""
    for channel in ("table_position", MOTOR_SIDE, "motor_angle"):
        if channel in taken:
            signal, candidate = taken[channel]
            return signal, candidate.unit
    return None


def _speeds(taken: Taken, signals: Sequence[Signal], fixed: set[str], found: list[Finding]) -> None:
    position = _position(taken)
    if position is None:
        return
    place, unit = position
    speeds = [signal for signal in signals if _is_speed(signal, taken)]
    factors = [(signal, one) for signal in speeds if (one := speed_factor(place, signal)) and one.scatter < _CLOSE]
    if not unit:
        unit = _position_unit(taken, factors, fixed)
    for signal, one in factors:
        name, written = signal.name, unit or "its unit"
        stated = _unit_of(signal, taken)
        fits = _speed_unit(one.factor, unit)
        text = (
            f"{name} is {one.factor:.5g} ± {one.scatter * abs(one.factor):.1g} of {place.name} in {written} per second"
        )
        if stated and unit:
            to_si, of_place = conversion(stated, "m/s"), conversion(unit, "m")
            if to_si is not None and of_place is not None:
                ratio = one.factor * to_si.factor / of_place.factor
                text += "" if abs(ratio - 1.0) < _NEAR else f": {ratio:.4g} times what its unit {stated} says"
        elif fits:
            text += f": {fits}"
            _give_unit(taken, signal, fits, one, fixed)
        elif unit == "mm":
            per_turn = 60.0 / abs(one.factor)
            text += f": no unit of a velocity; {per_turn:.4g} mm/rev if it is rev/min, of a motor behind a gear or lead"
        found.append(Finding("speed", text, one.factor, f"per ({written}/s)", one.scatter))
        drift = clock_drift(place, signal) if any(signal is measured for measured, _ in taken.values()) else None
        if drift is not None:
            grows = f"{drift.factor * 1e6:+.0f} ± {drift.scatter * 1e6:.0f} ppm of the time"
            text = f"two clocks: the lag of {name} behind {place.name} grows by {grows}"
            found.append(Finding("two clocks", text, drift.factor, "1", drift.scatter))


def _is_speed(signal: Signal, taken: Taken) -> bool:
    if signal.kind in _SPEED_NAMES:
        return True
    if any(signal is one and channel in ("motor_speed", "table_velocity") for channel, (one, _) in taken.items()):
        return True
    return signal.name.startswith(("CMD_SPEED|", "VEL_FFW|"))


def _unit_of(signal: Signal, taken: Taken) -> str:
    given = known_unit(signal.unit)
    return given or next((c.unit for s, c in taken.values() if s is signal), "")


def _speed_unit(factor: float, position_unit: str) -> str:
    """Return the unit of a speed by its factor over the derivative of a position; empty if none fits."""
    for unit in _SPEED_UNITS.get(position_unit, ()):
        si, base = ("m/s", "m") if position_unit == "mm" else ("rad/s", "rad")
        speed, place = conversion(unit, si), conversion(position_unit, base)
        if speed is not None and place is not None and abs(factor * speed.factor / place.factor - 1.0) < _NEAR:
            return unit
    return ""


def _position_unit(taken: Taken, factors: Sequence[tuple[Signal, Fit]], fixed: set[str]) -> str:
    """Settle whether positions without a unit count mm or degrees: a control shows mm/min, or rev/min for degrees."""
    for signal, one in factors:
        for unit, pair in (("mm", "mm/min"), ("deg", "rev/min")):
            if _speed_unit(one.factor, unit) == pair:
                reason = f"{signal.name} / d(position)/dt = {one.factor:.4g}: {unit} and {pair}, not in inches assumed"
                for channel in ("table_position", "setpoint", MOTOR_SIDE, "motor_angle"):
                    open_ = channel in taken and not taken[channel][1].unit and not taken[channel][1].foreign
                    if open_ and channel not in fixed:
                        where, candidate = taken[channel]
                        needed = "rad" if channel == "motor_angle" else "m"
                        if conversion(unit, needed) is None:
                            del taken[channel]  # a rotary axis: its position is no length
                        else:
                            taken[channel] = where, _settled(candidate, channel, unit, reason)
                return unit
    return ""


def _give_unit(taken: Taken, signal: Signal, unit: str, one: Fit, fixed: set[str]) -> None:
    for channel in ("motor_speed", "table_velocity"):
        if (
            channel in taken
            and taken[channel][0] is signal
            and not (taken[channel][1].unit or taken[channel][1].foreign)
        ):
            needed = "rad/s" if channel == "motor_speed" else "m/s"
            candidate, reason = taken[channel][1], f"{unit} by its factor {one.factor:.4g} over d(position)/dt"
            if conversion(unit, needed) is not None:
                taken[channel] = signal, _settled(candidate, channel, unit, reason)
            elif channel not in fixed:
                del taken[channel]  # an angle of the table, not of the motor, for which there is no channel
            return


def _settled(candidate: Candidate, channel: str, unit: str, reason: str) -> Candidate:
    return replace(candidate, channel=channel, unit=unit, reason=f"{candidate.reason}; {reason}", stated=True)


def _encoders(taken: Taken, found: list[Finding]) -> None:
    """Say the ratio of a motor encoder and a direct one that a control counts in the unit of the axis."""
    table, motor = taken.get("table_position"), taken.get(MOTOR_SIDE)
    one = fit(at_times(motor[0], table[0].time), table[0].values) if table is not None and motor is not None else None
    if one is None or one.scatter > _CLOSE or table is None or motor is None:
        return
    text = f"{table[0].name} per {motor[0].name} is {one.factor:.7g}, ± {one.scatter:.1g}: two encoders in one unit"
    found.append(Finding("encoders", text, one.factor, "1", one.scatter))


def _lead(taken: Taken, found: list[Finding]) -> None:
    """Say the lead where motor angle and table position are there."""
    table, motor = taken.get("table_position"), taken.get("motor_angle")
    if table is None or motor is None:
        return
    one = fit(at_times(motor[0], table[0].time), table[0].values)
    if one is None or one.scatter > _CLOSE:
        return
    angle, length = conversion(motor[1].unit or "?", "rad"), conversion(table[1].unit or "?", "m")
    if angle is not None and length is not None:
        lead = one.factor * length.factor / angle.factor * 2.0 * math.pi
        text = f"{table[0].name} moves {format_quantity(lead, 'm')} per revolution of {motor[0].name}"
        found.append(Finding("lead", f"{text}, ± {one.scatter:.1g} of it", lead, "m/rev", one.scatter))


def _torque_constant(taken: Taken, signals: Sequence[Signal], fixed: set[str], found: list[Finding]) -> None:
    if "motor_torque" not in taken or "motor_current" not in taken:
        return
    (torque, torque_choice), (current, current_choice) = taken["motor_torque"], taken["motor_current"]
    one = fit(at_times(current, torque.time), torque.values)
    to_torque, to_current = conversion(torque_choice.unit or "?", "N m"), conversion(current_choice.unit or "?", "A")
    if one is None or to_torque is None or to_current is None or abs(one.correlation) < _EXPLAINS:
        return
    constant = one.factor * to_torque.factor / to_current.factor
    text = f"{torque.name} is {constant:.5g} N m/A times {current.name} (correlation {one.correlation:.5f})"
    if one.correlation > _COMPUTED:
        text += ": a computed current, no second witness"
        if "motor_current" not in fixed:
            del taken["motor_current"]
            text += "; the torque is taken"
    found.append(Finding("torque constant", text, constant, "N m/A", one.scatter))


def _sign(channel: str, taken: Taken, fixed: set[str], found: list[Finding]) -> None:
    """Judge the sign of a torque or current by acceleration and direction of motion."""
    signal, choice = taken[channel]
    motion = _speed_and_acceleration(taken, signal.time)
    one_sided = signal.values.size > 0 and (np.min(signal.values) >= 0.0 or np.max(signal.values) <= 0.0)
    if motion is None or not np.any(signal.values):
        return
    speed, acceleration = motion
    limit = _MOVING * float(np.nanmax(np.abs(speed)))
    reverses = bool(np.sum(speed > limit) > FEWEST and np.sum(speed < -limit) > FEWEST)
    share, by_acceleration, by_direction = explained(
        signal.values, acceleration, np.where(np.abs(speed) > limit, np.sign(speed), 0.0)
    )
    if one_sided and reverses and share < _EXPLAINS:
        text = f"{signal.name} never changes its sign though the motion reverses: it is a magnitude"
        if channel not in fixed:
            del taken[channel]
            text += " and is not used as torque"
        found.append(Finding("magnitude", text, float(np.min(signal.values)), "", share))
        return
    if one_sided and not reverses and not np.all(signal.values == signal.values[0]):
        text = f"{signal.name} never changes its sign, nor does the motion reverse: whether it has one cannot be told"
        found.append(Finding("magnitude", text, float(np.min(signal.values)), "", share))
    if share >= _EXPLAINS and by_acceleration < 0.0 and by_direction < 0.0:
        text = f"{signal.name} acts against acceleration and motion, which explain {100 * share:.0f} % of it: its sign"
        text += " is reversed"
        if channel not in fixed:
            taken[channel] = signal, replace(choice, reason=f"{choice.reason}; sign turned, by acceleration", sign=-1.0)
            text += ", and was turned"
        found.append(Finding("sign", text, -1.0, "1", math.sqrt(max(0.0, 1.0 - share))))


def _speed_and_acceleration(taken: Taken, time: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Return speed and acceleration at times, (n,) each, in any unit; None without a position or speed."""
    place = _position(taken)
    speed_of = taken.get("motor_speed") or taken.get("table_velocity")
    if speed_of is not None:
        speed = at_times(speed_of[0], time)
    elif place is not None and place[0].time.size > FEWEST:
        speed = np.interp(time, place[0].time, smooth_slope(place[0].values, place[0].time))
    else:
        return None
    if time.size < FEWEST or not np.any(np.isfinite(speed)):
        return None
    speed = np.where(np.isfinite(speed), speed, 0.0)
    return (speed, smooth_slope(speed, time)) if np.ptp(speed) > 0.0 else None


def _following(taken: Taken, found: list[Finding]) -> None:
    """Say following error and K_v where the position follows its set-point, and that it does not where not."""
    if "setpoint" not in taken or "table_position" not in taken:
        return
    (wanted, wanted_choice), (place, choice) = taken["setpoint"], taken["table_position"]
    if not choice.unit or wanted_choice.unit != choice.unit or place.time.size < FEWEST:
        return
    target = at_times(wanted, place.time)
    kept = np.isfinite(target)
    if kept.sum() < FEWEST or np.ptp(target[kept]) == 0.0:
        return
    one = fit(target, place.values)
    if one is None or one.correlation < 0.9 or not 0.5 <= one.factor <= 2.0:
        text = f"{place.name} does not follow {wanted.name}"
        found.append(Finding("following", text, one.correlation if one else 0.0, "1", one.scatter if one else 1.0))
        return
    to_si = conversion(choice.unit, "m")
    assert to_si is not None
    error = (target - place.values)[kept] * to_si.factor
    speed = smooth_slope(place.values[kept], place.time[kept]) * to_si.factor  # the position loop asks for K_v e
    gain = fit(error, speed)
    value, unit, scatter = float(np.max(np.abs(error))), "m", one.scatter
    text = f"{place.name} follows {wanted.name}: following error up to {format_quantity(value, 'm')}"
    if gain is not None and gain.correlation > 0.9 and gain.factor > 0.0:
        # 1 (m/min)/mm is 1000/60 1/s.
        text += f", K_v {gain.factor:.4g} 1/s = {gain.factor * 0.06:.3g} (m/min)/mm, ± {gain.scatter:.1g} of it"
        value, unit, scatter = gain.factor, "1/s", gain.scatter
    found.append(Finding("following", text, value, unit, scatter))
