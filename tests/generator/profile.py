"""Set-points: strokes at several speeds, slow strokes, small reversals, then slow motion under a torque chirp."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from tests.generator.axis import AxisParameters

Array = npt.NDArray[np.float64]

REST_SECONDS = 0.1
STROKE_SHARE = 0.58
SMOOTHING_SECONDS = 0.03
BLEND_SECONDS = 0.5
CHIRP_FADE_SECONDS = 0.1
CHIRP_HZ = (5.0, 450.0)


@dataclass(frozen=True)
class Profile:
    """What the axis is asked to do, lengths in m, times in s.

    start: first set-point. strokes: (distance, speed) pairs, signed, one after the other, without dwell.
    reversals: (amplitude, frequency [Hz], cycles). swing: amplitude and swing_period of the slow motion, which
    lasts swing_seconds and ends in motion. chirp_amplitude [N m] is the torque injected meanwhile (0: none).
    """

    start: float
    strokes: tuple[tuple[float, float], ...]
    reversals: tuple[tuple[float, float, int], ...]
    swing: float
    swing_period: float
    swing_seconds: float
    chirp_amplitude: float
    acceleration: float

    def without_chirp(self) -> Profile:
        """Return the same motion without the torque chirp."""
        return replace(self, chirp_amplitude=0.0)


def train_profile(axis: AxisParameters, seconds: float) -> Profile:
    """Return the profile for fitting, about `seconds` long (at least 6 s)."""
    low, high = axis.travel
    return _fitted(axis, seconds, low, high - low, (1.0, 0.5, 0.7, 0.2, 0.06, 0.012), 60e-6, 2.8)


def validate_profile(axis: AxisParameters, seconds: float) -> Profile:
    """Return the profile for judging: other speeds, positions, amplitudes and periods than in training."""
    low, high = axis.travel
    start = low + 0.06 * (high - low)
    return _fitted(axis, seconds, start, 0.86 * (high - low), (0.8, 0.6, 0.37, 0.13, 0.035, 0.018), 44e-6, 2.3)


def _fitted(
    axis: AxisParameters,
    seconds: float,
    start: float,
    reach: float,
    shares: tuple[float, ...],
    small: float,
    period: float,
) -> Profile:
    """Share the time: strokes first, small reversals, and the slow swing with what is left.

    Strokes: the whole reach out and back at the first two shares of top speed, then shorter ones there and back.
    """
    if seconds < 6.0:
        raise ValueError(f"a recording needs at least 6 s, not {seconds}")
    strokes = [(reach, shares[0] * axis.top_speed), (-reach, shares[1] * axis.top_speed)]
    middle = 0.5 * (axis.travel[0] + axis.travel[1])
    last = (middle - start, 0.9 * axis.top_speed)
    left = STROKE_SHARE * seconds - _stroke_seconds([*strokes, last], axis.acceleration)
    for share in shares[2:]:
        distance = _distance_in(0.5 * left / len(shares[2:]), share * axis.top_speed, axis.acceleration)
        strokes += [(distance, share * axis.top_speed), (-distance, share * axis.top_speed)]
    strokes.append(last)
    cycles = max(1, round(0.15 * seconds))
    reversals = ((small, 1.5, cycles), (small / 3.0, 2.5, cycles))
    used = _stroke_seconds(strokes, axis.acceleration) + REST_SECONDS + sum(n / f for _, f, n in reversals)
    swing = 0.2 * axis.top_speed * period / (2.0 * math.pi)
    return Profile(
        start,
        tuple(strokes),
        reversals,
        swing,
        period,
        max(1.5, seconds - used),
        axis.chirp_amplitude,
        axis.acceleration,
    )


def _distance_in(seconds: float, speed: float, acceleration: float) -> float:
    """Return the distance [m] of a rest-to-rest stroke of about `seconds`, 0.2 s at least, at up to `speed` [m/s]."""
    span = max(0.2, seconds)
    return min(speed * max(0.5 * span, span - speed / acceleration), 0.25 * acceleration * span**2)


def _stroke_seconds(strokes: list[tuple[float, float]], acceleration: float) -> float:
    """Return how long the strokes take [s]."""
    return sum(_ramp_and_cruise(d, v, acceleration)[2] for d, v in strokes) + 2.0 * SMOOTHING_SECONDS


def _ramp_and_cruise(distance: float, speed: float, acceleration: float) -> tuple[float, float, float]:
    """Return reached speed [m/s], ramp time and total time [s] of one rest-to-rest stroke."""
    reached = min(speed, math.sqrt(abs(distance) * acceleration))
    ramp = reached / acceleration
    return reached, ramp, abs(distance) / reached + ramp


def setpoint_and_chirp(profile: Profile, sample_time: float) -> tuple[Array, Array]:
    """Return set-point [m] and injected torque [N m], both (n,), at multiples of `sample_time` [s]."""
    strokes = _stroke_positions(profile, sample_time)
    middle = float(strokes[-1])
    parts = [strokes]
    for amplitude, frequency, cycles in profile.reversals:
        time = _sample_times(cycles / frequency, sample_time)
        parts.append(middle + amplitude * np.sin(2.0 * math.pi * frequency * time))
    time = _sample_times(profile.swing_seconds, sample_time)
    blend = smooth_step(time / BLEND_SECONDS)
    parts.append(middle + blend * profile.swing * np.sin(2.0 * math.pi * time / profile.swing_period))
    setpoint = np.concatenate(parts)
    injected = np.zeros_like(setpoint)
    injected[-time.size :] = profile.chirp_amplitude * chirp(time - BLEND_SECONDS, CHIRP_HZ)
    return setpoint, injected


def _sample_times(seconds: float, sample_time: float) -> Array:
    """Return the sample instants from 0 up to but not including `seconds` [s]."""
    return np.asarray(np.arange(round(seconds / sample_time)) * sample_time, dtype=np.float64)


def _stroke_positions(profile: Profile, sample_time: float) -> Array:
    """Return the set-point [m] of rest and strokes: trapezoids of speed, averaged twice to limit jerk."""
    speeds = [np.zeros(round(REST_SECONDS / sample_time))]
    for distance, speed in profile.strokes:
        _, ramp, total = _ramp_and_cruise(distance, speed, profile.acceleration)
        time = (np.arange(math.ceil(total / sample_time)) + 0.5) * sample_time
        shape = np.clip(np.minimum(time, total - time) / ramp, 0.0, 1.0)
        speeds.append(shape * distance / (np.sum(shape) * sample_time))
    width = round(SMOOTHING_SECONDS / sample_time)
    speed_sequence = np.concatenate([*speeds, np.zeros(2 * width)])
    window = np.ones(width) / width
    for _ in range(2):
        speed_sequence = np.convolve(speed_sequence, window)[: speed_sequence.size]
    return profile.start + np.cumsum(speed_sequence) * sample_time


def smooth_step(share: Array) -> Array:
    """Return a step from 0 to 1 whose first two derivatives vanish at both ends."""
    s = np.clip(share, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def chirp(time: Array, hertz: tuple[float, float]) -> Array:
    """Return a logarithmic sine sweep between two frequencies, zero for negative time [s], faded at both ends."""
    low, high = hertz
    seconds = float(time[-1])
    ratio = math.log(high / low)
    phase = 2.0 * math.pi * low * seconds / ratio * (np.exp(np.maximum(time, 0.0) / seconds * ratio) - 1.0)
    fade = np.clip(np.minimum(time, seconds - time) / CHIRP_FADE_SECONDS, 0.0, 1.0)
    return fade * np.sin(phase)
