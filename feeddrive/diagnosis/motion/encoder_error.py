"""The encoder's own error: the motion that is expected given what was measured, and what its rest does to the channels.

The motor angle is measured in steps, θ_m = θ + q. Differentiated by the plant, q comes out as torque and position that
nothing of the machine asked for, and an effect that only makes the plant answer the motor less (a mass that is taken
away, a soft spring, a resonance of strong damping) lowers the error by that alone. What is simulated is therefore the
motion that is expected given what was measured, window by window and frequency by frequency (Wiener, Extrapolation,
Interpolation, and Smoothing (1949)):

    E[A | A_m] = max(1 - N / P, 0) A_m where there is motion, else 0,   N = step²/12 Σw² |2 sin(ω h / 2)|⁴

| symbol | meaning |
|---|---|
| A_m | spectrum of the second difference of the angle in a window |
| P | mean square of A_m over neighbouring windows; neighbouring frequencies tell besides where there is motion at all |
| N | that of the steps' error, white, of variance step²/12 |
| w, h | window, sample time |

P is of one frequency, as the spectrum of a stroke falls fifty times from one to the next, and what is taken away is
then N in the mean however steep it is (Stein, Ann. Statist. 9 (1981) 1135). Of errors that the same encoder would make
and that are drawn, the share ρ(f) of the power of that motion follows; so much is left out of it, and of what is
uncertain still, every comparison is without (`unsure_motion`). Motion need not last: of a chirp in one part of a
recording ρ(f) says how much of the whole is error, and left out is only what is error in its own window (`Told`). The
error that is left is nearly independent of the motion that is simulated, so that it draws values little towards none
(Carroll et al., Measurement Error in Nonlinear Models (2006), chapter 4); what it does draw them by is `Calibration`'s
to widen (`encoder_scores`). It adds to the residual what the declared plant makes of it: errors are drawn anew and
simulated, and each channel is weighed, frequency by frequency, by the sensor's noise over both, and by how small an
error of the motion it is,

    gain(f) = 1 / √(1 + S_encoder(f) / S_sensor(f)) / (1 + (ρ(f) / `SMALL`)²) / (1 + (ρ_c(f) / `SMALL`)²)

ρ_c is the error's share of what was recorded, S_encoder(f) / S_recorded(f): at a pole of the load with the motor held
the motor hardly moves, in a band too narrow for ρ, and all that the machine is told to do there is error. Its answer is
in the slope of a damping as well, and drew it to ten times what it was.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from scipy.ndimage import uniform_filter
from scipy.signal.windows import hann

from feeddrive.diagnosis.motion.band import END_CUT, Band
from feeddrive.diagnosis.motion.expected_motion import (
    ALONG_FREQUENCY,
    ALONG_TIME,
    DRAWS,
    WINDOW,
    ExpectedMotion,
    added,
    expected_motion,
    frames_of,
    spectra_of,
    window_of,
)
from feeddrive.diagnosis.motion.told_motion import teller
from feeddrive.diagnosis.motion.unsure_motion import left_out, unsure_motions, without_share
from feeddrive.diagnosis.suspicion.torque_channel import scale_of
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.plant.analysis.modes import braked_modes
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.simulate.driven import GRID, LoadMotion, MotorMotion, motor_motion, motor_motions, simulate_driven
from feeddrive.simulate.row_steps import at_rows, at_steps, step_count
from feeddrive.typing import FloatArray

MATERIAL = 0.1
"""Power that the encoder adds to a channel at any frequency of the band, over its sensor's, from which it is carried:
errors of what shows there alone, such as a damping at its resonance, grow by 5 %."""

AT_ONCE = 8
"""Motions whose splines are made together: one alone takes three times as long, and more take room for nothing."""

SMALL = 0.1
"""Share of the motion's power up to which an encoder's error is a small one: its square is a hundredth then, and what
the plant makes of error and of motion is told apart. Beyond, the error's own spectrum is that of the plant that is
asked for: where the declared one has no resonance and the true one has, all is error, and frequencies count for
little."""

SMOOTHED = 3, 0.1
"""Neighbouring frequencies on either side over which a spectrum is averaged: so many, and this share of the frequency.
Rest and slow motion make an error of less than a hertz, which a window of fixed length would spread."""


@dataclass(frozen=True)
class EncoderError:
    """What the steps of an encoder do to a comparison.

    Attributes:
        motion: of the motor, as expected.
        drawn: motions that would be expected if that were the true one, measured by the same encoder.
        gains: channel to the gain at each frequency of its whole series, (n // 2 + 1,).
        added: channel to the rms of what the encoder's error makes of it, in the band [SI].
        unsure: of every part of the motion that may not be, channel to what the plant makes of it, in the band, (n,)
            [SI] (`unsure_motion`).
        told: part of the motion that the torque tells, (n,) [rad].
        kept: channel to the share of its noise's power in the band that is left once frequencies of much error count
            for little.
    """

    motion: MotorMotion
    drawn: tuple[MotorMotion, ...]
    gains: dict[str, FloatArray]
    added: dict[str, float]
    unsure: tuple[dict[str, FloatArray], ...]
    told: FloatArray
    kept: dict[str, float]


@dataclass(frozen=True)
class Told:
    """What of an expected motion is motion.

    Attributes:
        share: ρ of the whole recording, (n // 2 + 1,).
        there: how much of what that leaves out is error in a window, at its frequencies, 0 to 1, (windows, m).
        sample_time: of the rows [s].
    """

    share: FloatArray
    there: FloatArray
    sample_time: float

    def known(self, angle: FloatArray) -> FloatArray:
        """A motion without what is more error than motion where it stands, (n,)."""
        return angle - self.uncertain(angle - without_share(angle, self.share, self.sample_time))

    def uncertain(self, part: FloatArray) -> FloatArray:
        """Of a part of a motion that may be error, (n,), what is error in its own window."""
        window = window_of(self.sample_time)
        spectra = np.fft.rfft(frames_of(part, len(window)) * window, axis=1)
        return added(self.there * spectra, window, len(part))


def encoder_error(
    plant: Plant, recording: Recording, band: Band, noise: dict[str, float], proportional: bool = False,
    acting: FloatArray | None = None, plays: bool = False,
) -> EncoderError | None:  # fmt: skip
    """The encoder's error in a recording; None where it does not matter beside the sensors' noise.

    Args:
        plant: as declared, that answers the motion.
        recording: with a motor angle.
        band: of the comparison.
        noise: channel to the rms of its sensor noise in the band [of the channel].
        proportional: whether the recorded torque is only proportional to a torque; the declared plant then sets what
            a newton metre is in its unit.
        acting: torque as it acts, in the band [N m], which tells motion that the encoder does not (`told_motion`);
            None where it tells none.
        plays: whether the load has a free play beside the plant's springs: what moves it by less than that rings it
            little, and what the plant makes of the error is no measure of ρ_c.
    """
    angle, sample_time = recording["motor_angle"], recording.sample_time
    step = quantisation_step(angle)
    if step <= 0 or round(WINDOW / sample_time) < 16 or len(angle) < 4 * round(WINDOW / sample_time):
        return None
    time: FloatArray = np.arange(len(angle), dtype=np.float64) * sample_time
    seen = expected_motion(angle, step, sample_time)
    known = told_of(seen)
    expected, share = known.known(seen.angle), known.share
    errors = [drawn_error(seen, draw, known) for draw in range(DRAWS)]
    told: FloatArray = np.zeros(len(angle))
    try:
        if acting is not None and not proportional and np.all(np.isfinite(acting)):
            tells = teller(plant, band, share, len(angle), sample_time, noise["motor_torque"], step)
            if tells is not None:
                told = tells.told(expected, acting)
                asked = tells.asked(expected + told)
                errors = [left + tells.told(expected + left, asked) - told for left in errors]
        motion, *drawn = motor_motions(
            time, np.column_stack([expected + told, *(expected + told + left for left in errors)])
        )
        runs = [simulate_driven(plant, one) for one in (motion, *drawn)]
    except SimulationError:
        return None
    poles = [pole for pole in braked_modes(plant, plant.middle).poles if pole.imag > 0]
    inner = slice(round(END_CUT / sample_time), -round(END_CUT / sample_time))
    frequencies = np.fft.rfftfreq(len(angle), sample_time)
    gains, kept, added, units, material = {}, {}, {}, {}, False
    for name in noise:
        true, *others = (_answer(run, name) for run in runs)
        unit = _per_newton_metre(recording, true, band) if proportional and name == "motor_torque" else 1.0
        units[name] = unit
        made = [unit * (other - true) for other in others]
        added[name] = float(np.sqrt(np.mean([np.var(band.filter(error)[inner]) for error in made])))
        frequency, density = _density([error[inner] for error in made], sample_time)
        over = density / (2 * sample_time * (noise[name] / band.noise_gain) ** 2)
        material = material or bool(np.any(over[frequency <= band.edge] > MATERIAL))
        small = 1 / (1 + (share / SMALL) ** 2)
        if poles and not plays:
            of_all = _share_of_recorded(recording[name][inner], density, sample_time)
            small = small / (1 + (np.interp(frequencies, frequency, of_all) / SMALL) ** 2)
        gains[name] = small / np.sqrt(1 + np.interp(frequencies, frequency, over))
        kept[name] = float(np.mean(small[frequencies <= band.edge] ** 2))
    if not material:
        return None
    parts = unsure_motions(expected, share, sample_time, band.edge, poles)
    moved = (known.uncertain(part) for part in parts)
    answers = _made_of(plant, expected + told, moved, sample_time)
    unsure = [{name: units[name] * band.filter(one[name]) for name in noise} for one in answers]
    return EncoderError(motion, tuple(drawn), gains, added, tuple(unsure), told, kept)


def _made_of(
    plant: Plant, angle: FloatArray, moved: Iterator[FloatArray], sample_time: float
) -> Iterator[dict[str, FloatArray]]:
    """Channel to what a plant makes of parts of a motion beside the rest, (n,) each, but those it cannot follow.

    In the steps of a simulation, up to `GRID`: what they may be counts, in the band, and not to the last digit.

    Args:
        plant: that answers.
        angle: of the motor, as expected, (n,) [rad].
        moved: parts of it that may not be, (n,) each [rad].
        sample_time: of the rows [s].
    """
    every = max(1, int(GRID / sample_time + 1e-6))
    time: FloatArray = np.arange(step_count(len(angle), every), dtype=np.float64) * (every * sample_time)

    def thinned(part: FloatArray) -> FloatArray:
        return at_steps(part, every) if every > 1 else part

    slow: FloatArray = thinned(angle)
    try:
        alone = simulate_driven(plant, motor_motion(time, slow))
    except SimulationError:
        return
    while some := [thinned(part) for part in islice(moved, AT_ONCE)]:
        for motion in motor_motions(time, (slow + np.vstack(some)).T):
            try:
                run = simulate_driven(plant, motion)
            except SimulationError:
                continue
            made = {name: _answer(run, name) - _answer(alone, name) for name in ("motor_torque", "table_position")}
            yield {name: at_rows(one, every, len(angle)) if every > 1 else one for name, one in made.items()}


def known_motion_of(angle: FloatArray, step: float, sample_time: float) -> FloatArray:
    """The motion that is expected, without what is more error than motion, (n,).

    Args:
        angle: as the encoder gives it, (n,).
        step: of the encoder.
        sample_time: of the rows [s].
    """
    expected = expected_motion(angle, step, sample_time)
    return told_of(expected).known(expected.angle)


def told_of(expected: ExpectedMotion) -> Told:
    """What of an expected motion is motion."""
    errors, sample_time = [drawn_error(expected, draw) for draw in range(DRAWS)], expected.sample_time
    share = _share_of_error(expected.angle, errors, sample_time)
    return Told(share, _error_in_windows(expected.angle, errors, share, sample_time), sample_time)


def _error_in_windows(
    expected: FloatArray, errors: Sequence[FloatArray], share: FloatArray, sample_time: float
) -> FloatArray:
    """`Told.there`: what ρ of a window and its neighbours leaves out over what ρ of the recording does, at most 1.

    Below two periods a window it is 1: a window does not tell one frequency from the next.
    """
    window = window_of(sample_time)
    power = uniform_filter(np.abs(spectra_of(expected, window)) ** 2, (ALONG_TIME, ALONG_FREQUENCY))
    squares = np.mean([np.abs(spectra_of(error, window)) ** 2 for error in errors], axis=0)
    wrong = np.maximum(uniform_filter(squares, (ALONG_TIME, ALONG_FREQUENCY)), 0.0)  # a running sum may end below zero
    local = np.minimum(np.divide(wrong, power, out=np.ones_like(power), where=power > 0), 1.0)
    frequency = np.fft.rfftfreq(len(window), sample_time)
    of_all = left_out(np.interp(frequency, np.fft.rfftfreq(len(expected), sample_time), share))
    there: FloatArray = np.minimum(left_out(local) / np.where(of_all > 0, of_all, np.inf), 1.0)
    there[:, frequency < 2 / WINDOW] = 1.0
    return there


def _answer(run: LoadMotion, name: str) -> FloatArray:
    """What a driven run says of a channel."""
    return run.torque if name == "motor_torque" else run.table_position


def _share_of_error(expected: FloatArray, errors: Sequence[FloatArray], sample_time: float) -> FloatArray:
    """ρ of `unsure_motion`: power of the drawn errors over that of the expected motion, (n // 2 + 1,).

    Below two periods a `WINDOW` the error is white, as the steps are, and its acceleration falls with the fourth power
    of the frequency; that of strokes does not, but stands in lines, between which a ratio of densities says nothing.
    """
    frequency, power = _density([np.diff(expected, 2)], sample_time)
    _, wrong = _density([np.diff(error, 2) for error in errors], sample_time)
    share = np.minimum(wrong / np.where(power > 0, power, np.inf), 1.0)
    asked, told = np.fft.rfftfreq(len(expected), sample_time), 2 / WINDOW
    slower = np.minimum(asked / told, 1.0) ** 4
    return np.asarray(np.interp(np.maximum(asked, told), frequency, share) * slower)


def _per_newton_metre(recording: Recording, torque: FloatArray, band: Band) -> float:
    """What a newton metre is in the unit of a recorded torque: by the torque [N m] that the plant needs, (n,)."""
    recorded = recording["motor_torque"]
    known = np.isfinite(recorded)
    needed = band.filter(torque)[known]
    return scale_of(band.filter(np.where(known, recorded, 0.0))[known], needed)


def _share_of_recorded(recorded: FloatArray, density: FloatArray, sample_time: float) -> FloatArray:
    """ρ_c of an error of a power density at its frequencies, (m,), in a channel as recorded, (n,): 1 at most."""
    known = np.isfinite(recorded)
    _, whole = _density([np.where(known, recorded, np.mean(recorded[known]))], sample_time)
    return np.minimum(np.divide(density, whole, out=np.ones_like(density), where=whole > 0), 1.0)


def _density(series: Sequence[FloatArray], sample_time: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and the power density of several series at them, averaged over them and neighbours."""
    window = hann(len(series[0]), sym=False)
    spectra = [np.abs(np.fft.rfft((one - np.mean(one)) * window)) ** 2 for one in series]
    power = 2 * sample_time * np.mean(spectra, axis=0) / float(window @ window)
    total = np.concatenate([[0.0], np.cumsum(power)])
    at = np.arange(len(power))
    reach = np.maximum(SMOOTHED[0], (SMOOTHED[1] * at).astype(int))
    first, last = np.maximum(at - reach, 0), np.minimum(at + reach + 1, len(power))
    density: FloatArray = (total[last] - total[first]) / (last - first)
    frequency: FloatArray = np.asarray(np.fft.rfftfreq(len(series[0]), sample_time), dtype=float)
    return frequency, density


def drawn_error(expected: ExpectedMotion, draw: int, known: Told | None = None) -> FloatArray:
    """The error of the expected motion if a likely one were the true one, measured by the same encoder, (n,) [rad].

    Slow motion and rest make an error that is slow: it is drawn by measuring, not as white noise. Draws differ in what
    is not told of the motion and in where the steps lie: `draw` is the seed of both. Where a share of the motion is
    left out (`Told`), it is of what would be expected.
    """
    step = expected.step
    true = expected.likely(draw) + step * np.random.default_rng(draw).uniform()
    seen = expected_motion(step * np.round(true / step), step, expected.sample_time).angle
    return (seen if known is None else known.known(seen)) - true
