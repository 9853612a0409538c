"""Frequency response measured through the drive: averaged spectra, H1, coherence; of a recording and of a step.

    H1 = S_uy / S_uu,   coherence = |S_uy|^2 / (S_uu S_yy)

S are averaged cross spectra of segments (scipy.signal.csd: Welch, Hann window, half overlap). A periodic excitation is
averaged over whole periods without window, where nothing leaks. Source: Pintelon, Schoukens, System Identification,
2nd ed., sections 2.2 to 2.6.

Of a recording, laid beside the linear response:

    H1 = S_uy / S_uu,   G(j w) = H1(w) / W(w),   W = sinc(w T / 2) exp(-j w T / 2)   for a torque held over the sample

| symbol | meaning | unit |
|---|---|---|
| u, y | torque or force, and what answers | SI |
| T | sample time | s |
| W | response of the hold, which is in H1 and not in G | 1 |

An answer that was not recorded is the difference of its integral (speed from angle), a mean over the sample, whose own
sinc(w T / 2) exp(+j w T / 2) is taken out likewise. Valid up to a quarter of the sample rate; beyond, what the sampling
folds back shows (2 dB at 0.4). Recordings under control are biased by noise that runs round the loop; the coherence
says where.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.finite import refuse_unknown
from feeddrive.plant.analysis.ode import OUTPUTS
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.recording.recording import Recording
from feeddrive.servo.cascade_function import velocity_loop_of
from feeddrive.servo.linear_loop import closed_loop
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.sampled_plant import sampled_plant
from feeddrive.simulate.scenario.scenario import ScenarioResult
from feeddrive.typing import ComplexArray, FloatArray

SETTLED_BY = 0.8
"""Share of what was recorded after a step by which it must have come within its band for good. An exponential approach
1 - e^(-t/T) that is cut off at t_e has its end value put wrong by e^(-t_e/T); where that is the band of 2 % itself, the
approach enters the band about the wrong end at 0.8 t_e: who enters later, has an end value that is not known."""

_LEAKING = 3
"""Lowest lines into which a Hann window lets what is left of the mean and of a drift leak."""


@dataclass(frozen=True)
class Response:
    """Measured frequency response.

    Attributes:
        frequency: [Hz], shape (n,).
        response: output per input, complex, shape (n,).
        coherence: 0 to 1, shape (n,); NaN where there is one average only.
        averages: number of segments or periods; 0 where it is not known.
    """

    frequency: FloatArray
    response: FloatArray
    coherence: FloatArray
    averages: int

    def between(self, low: float, high: float) -> Response:
        """The part from `low` to `high` [Hz]."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        return Response(self.frequency[inside], self.response[inside], self.coherence[inside], self.averages)


def measured_response(given: FloatArray, output: FloatArray, sample_time: float, segment: int) -> Response:
    """H1 of samples, (n,), over Hann windows of `segment` samples, sample time in s.

    Raises InputError for fewer samples than a segment.
    """
    if len(given) < segment:
        raise InputError(f"{len(given)} samples for windows of {segment}", "frequency response", "record longer")
    refuse_unknown("frequency response", input=given, output=output)
    options = {"fs": 1 / sample_time, "nperseg": segment, "detrend": "constant"}
    from scipy import signal  # takes a second to import

    frequency, cross = signal.csd(given, output, **options)
    _, power = signal.welch(given, **options)
    _, coherence = signal.coherence(given, output, **options)
    averages = (len(given) - segment) // (segment - segment // 2) + 1
    if averages < 2:
        coherence = np.full_like(coherence, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = slice(_LEAKING, -1)  # nor at half the sample rate
        return Response(frequency[inside], (cross / power)[inside], coherence[inside], averages)


def periodic_response(
    given: FloatArray, output: FloatArray, sample_time: float, period: int, lines: FloatArray
) -> Response:
    """Response at excited harmonics of a period in samples, (k,) [Hz], averaged over the last whole periods.

    Raises InputError for less than one period.
    """
    periods = len(given) // period
    if periods < 1:
        raise InputError(f"{len(given)} samples for a period of {period}", "frequency response", "record longer")
    refuse_unknown("frequency response", input=given, output=output)
    index = np.round(lines * period * sample_time).astype(np.int64)
    spectra = [
        np.fft.rfft(_level(values[len(values) - periods * period :].reshape(periods, period)), axis=1)[:, index]
        for values in (given, output)
    ]
    cross, power, answer = (
        np.mean(a * np.conj(b), axis=0)
        for a, b in ((spectra[1], spectra[0]), (spectra[0], spectra[0]), (spectra[1], spectra[1]))
    )
    coherence = np.abs(cross) ** 2 / (power.real * answer.real)
    if periods < 2:
        coherence = np.full_like(coherence, np.nan)
    return Response(np.asarray(lines), cross / power.real, coherence, periods)


def _level(periods: FloatArray) -> FloatArray:
    """Periods without the mean of each."""
    level: FloatArray = periods - periods.mean(axis=1, keepdims=True)
    return level


@dataclass(frozen=True)
class StepResponse:
    """Figures of a step, relative to its height.

    Attributes:
        final: value at the end, in the unit of the signal.
        rise: from 10 to 90 % [s].
        overshoot: beyond the end value, as a share of the height.
        settling: until within 2 % of the height for good [s], from the step on; NaN where it has not settled by
            `SETTLED_BY` of the record, so that its end value is not known either.
    """

    final: float
    rise: float
    overshoot: float
    settling: float


def step_response(time: FloatArray, values: FloatArray, at: float) -> StepResponse:
    """Figures of a step at a time [s], of samples, (n,).

    Raises InputError: no sample before or too few after the step, or no height.
    """
    first = int(np.searchsorted(time, at - 1e-12))
    after = values[first:]
    if first < 1 or len(after) < 20:
        raise InputError("too few samples about the step", "step response", "record before and after the step")
    refuse_unknown("step response", values=values[first - 1 :])
    start, final = float(values[first - 1]), float(np.mean(after[-max(1, len(after) // 20) :]))
    height = final - start
    if height == 0:
        raise InputError("the signal does not change", "step response", "choose the channel that steps")
    share = (after - start) / height
    rise = float(time[first + np.argmax(share >= 0.9)] - time[first + np.argmax(share >= 0.1)])
    outside = np.flatnonzero(np.abs(share - 1) > 0.02)
    settled = float(time[first + outside[-1]] - at) if len(outside) else 0.0
    if settled > SETTLED_BY * float(time[-1] - at):
        settled = math.nan
    return StepResponse(final, rise, float(max(0.0, share.max() - 1)), settled)


_INTEGRALS = {"motor_speed": "motor_angle", "table_velocity": "table_position"}
_HELD = ("motor_torque", "cutting_force")
_AVERAGES = 16
_SHORTEST, _LONGEST = 64, 2.0  # samples, s
_HIGHEST = 0.25


def recorded_response(recording: Recording, given: str, output: str) -> Response:
    """The response of a recording from `motor_torque` or `cutting_force`, held, as the linear plant has it.

    The output is a recorded channel or a speed whose angle is recorded; the axis moves and the input is excited. Raises
    InputError: a channel that is not recorded, or a recording too short for averages.
    """
    if given not in _HELD:
        raise InputError(f"{given} is no input of the mechanics", recording.name, f"choose {' or '.join(_HELD)}")
    force, tick = recording[given], recording.sample_time
    if not np.ptp(force) > 0:
        raise InputError(f"{given} does not change", recording.name, "record while it is excited")
    answer, mean = _answer(recording, output)
    segment = min(int(2 * len(answer) / (_AVERAGES + 1)), int(_LONGEST / tick))
    if segment < _SHORTEST:
        what = f"{len(answer)} samples are too few for {_AVERAGES} averages"
        raise InputError(what, recording.name, f"record {_SHORTEST * (_AVERAGES + 1) // 2} samples or more")
    found = measured_response(force[: len(answer)], answer, tick, segment).between(0.0, _HIGHEST / tick)
    half = math.pi * found.frequency * tick
    hold = np.sinc(half / math.pi) * np.exp(-1j * half)
    own = np.sinc(half / math.pi) * np.exp(1j * half) if mean else np.ones_like(hold)
    return Response(found.frequency, found.response / (hold * own), found.coherence, found.averages)


def _answer(recording: Recording, output: str) -> tuple[FloatArray, bool]:
    """Samples of the output, and whether each is the mean over its sample."""
    if output in recording:
        return recording[output], False
    integral = _INTEGRALS.get(output, "")
    if integral not in recording:
        return recording[output], False  # which tells what the recording has
    return np.diff(recording[integral]) / recording.sample_time, True


def linear_response(result: ScenarioResult, given: str, output: str, frequency: FloatArray) -> ComplexArray | None:
    """The response of the linear plant, or of the closed velocity loop, sampled like the recording.

    Args:
        result: of a run; linearised about its mean velocity.
        given, output: series.
        frequency: [Hz], shape (n,).

    Returns:
        Complex response, shape (n,); None for a pair that is neither torque to a reading nor, with the position loop
        open, speed command to motor speed.

    Raises:
        InputError: no steady motion at that velocity.
    """
    scenario = result.scenario
    mean = float(np.mean(result.series["table_velocity"]))
    velocity = mean if abs(mean) > 1e-3 else MOVING
    if given == "motor_torque" and output in OUTPUTS:
        alone = replace(
            scenario.cascade,
            sample_time=scenario.sample_time,
            current_lag=0.0,
            dead_time=0.0,
            torque_filters=(),
            speed_filters=(),
            tracking_time=1.0,
        )
        machine = sampled_plant(scenario.plant, alone, velocity)
        return _transfer(machine.a, machine.b[:, 0], machine.c[OUTPUTS.index(output)], frequency, scenario.sample_time)
    if (given, output) == ("speed_command", "motor_speed") and not scenario.cascade.position_gain:
        loop = closed_loop(scenario.plant, replace(velocity_loop_of(scenario.cascade), position_divider=1), velocity)
        command, speed = (
            frequency_response(loop[name, "speed_excitation"], frequency) for name in ("speed_command", "motor_speed")
        )
        ratio: ComplexArray = speed / command
        return ratio
    return None


def _transfer(a: FloatArray, b: FloatArray, c: FloatArray, frequency: FloatArray, step: float) -> ComplexArray:
    """c (z - A)^-1 b."""
    z = np.exp(2j * np.pi * frequency * step)
    values: ComplexArray = np.array([c @ np.linalg.solve(one * np.eye(len(a)) - a, b) for one in z])
    return values
