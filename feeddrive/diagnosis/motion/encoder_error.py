"""The encoder's own error: the motion that is expected given what was measured, and what its rest does to the channels.

The motor angle is measured in steps, θ_m = θ + q. Differentiated by the plant, q comes out as torque and position that
nothing of the machine asked for, and an effect that only makes the plant answer the motor less (a mass that is taken
away, a soft spring, a resonance of strong damping) lowers the error by that alone. What is simulated is therefore the
motion A that is expected given what was measured: the smoothest that the encoder would have written down so
(`smoothest_motion`). What it holds is motion, and what it lacks the encoder does not tell: its error is nearly
independent of it. Of errors that the same encoder would make and that are drawn, the share ρ(f) of the power of that
motion follows; of what is uncertain, every comparison is without (`unsure_motion`). The error that is left draws values
little towards none (Carroll et al., Measurement Error in Nonlinear Models (2006), chapter 4); what it does draw them by
is `Calibration`'s to widen (`encoder_scores`). It adds to the residual what the declared plant makes of it: errors are
drawn anew and simulated, and each channel is weighed, frequency by frequency, by the sensor's noise over both, and by
how small an error of the motion it is,

    gain(f) = 1 / √(1 + S_encoder(f) / S_sensor(f)) / (1 + (ρ(f) / `SMALL`)²)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal.windows import hann

from feeddrive.diagnosis.motion.band import END_CUT, Band
from feeddrive.diagnosis.motion.smoothest_motion import smoothest_motion
from feeddrive.diagnosis.motion.told_motion import teller
from feeddrive.diagnosis.motion.unsure_motion import unsure_motions
from feeddrive.diagnosis.suspicion.torque_channel import scale_of
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.plant.analysis.modes import braked_modes
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.simulate.driven import LoadMotion, MotorMotion, motor_motion, motor_motions, simulate_driven
from feeddrive.typing import FloatArray

WINDOW = 0.128
"""Time [s] of which a recording needs four for a spectrum: motion keeps its own so long."""

MATERIAL = 0.1
"""Power that the encoder adds to a channel at any frequency of the band, over its sensor's, from which it is carried:
errors of what shows there alone, such as a damping at its resonance, grow by 5 %."""

DRAWS = 4
"""Errors that are drawn: with `SMOOTHED` neighbours on either side, a spectrum is known to a fifth."""

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
        unsure: channel to what the plant makes of motion that may not be, in the band, (n, k) [SI] (`unsure_motion`).
        told: part of the motion that the torque tells, (n,) [rad].
    """

    motion: MotorMotion
    drawn: tuple[MotorMotion, ...]
    gains: dict[str, FloatArray]
    added: dict[str, float]
    unsure: dict[str, FloatArray]
    told: FloatArray


def encoder_error(
    plant: Plant, recording: Recording, band: Band, noise: dict[str, float], proportional: bool = False,
    acting: FloatArray | None = None,
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
    """
    angle, sample_time = recording["motor_angle"], recording.sample_time
    step = quantisation_step(angle)
    if step <= 0 or round(WINDOW / sample_time) < 16 or len(angle) < 4 * round(WINDOW / sample_time):
        return None
    time: FloatArray = np.arange(len(angle), dtype=np.float64) * sample_time
    expected, errors, share = known_motion_of(angle, step, sample_time)
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
    inner = slice(round(END_CUT / sample_time), -round(END_CUT / sample_time))
    frequencies = np.fft.rfftfreq(len(angle), sample_time)
    gains, added, units, material = {}, {}, {}, False
    for name in noise:
        true, *others = (_answer(run, name) for run in runs)
        unit = _per_newton_metre(recording, true, band) if proportional and name == "motor_torque" else 1.0
        units[name] = unit
        made = [unit * (other - true) for other in others]
        added[name] = float(np.sqrt(np.mean([np.var(band.filter(error)[inner]) for error in made])))
        frequency, density = _density([error[inner] for error in made], sample_time)
        over = density / (2 * sample_time * (noise[name] / band.noise_gain) ** 2)
        material = material or bool(np.any(over[frequency <= band.edge] > MATERIAL))
        gains[name] = 1 / np.sqrt(1 + np.interp(frequencies, frequency, over))
    if not material:
        return None
    gains = {name: gain / (1 + (share / SMALL) ** 2) for name, gain in gains.items()}
    unsure: dict[str, list[FloatArray]] = {name: [] for name in noise}
    held = braked_modes(plant, plant.middle).poles
    for part in unsure_motions(expected, share, sample_time, band.edge, [p for p in held if p.imag > 0]):
        try:
            run = simulate_driven(plant, motor_motion(time, expected + told + part))
        except SimulationError:
            continue
        for name, columns in unsure.items():
            columns.append(units[name] * band.filter(_answer(run, name) - _answer(runs[0], name)))
    return EncoderError(
        motion, tuple(drawn), gains, added, {name: np.column_stack(c) for name, c in unsure.items() if c}, told
    )


def known_motion_of(
    angle: FloatArray, step: float, sample_time: float
) -> tuple[FloatArray, list[FloatArray], FloatArray]:
    """The motion that is expected, (n,), errors that are drawn of it, (n,) each, and the share of them in its power.

    Args:
        angle: as the encoder gives it, (n,).
        step: of the encoder.
        sample_time: of the rows [s].
    """
    expected = smoothest_motion(angle, step)
    # the smoothest motion is smoother than the true one: as true ones stand those that it may be the smoothest of
    likely = [expected - drawn_error(expected, step, draw) for draw in range(DRAWS)]
    errors = [drawn_error(true, step, DRAWS + draw) for draw, true in enumerate(likely)]
    return expected, errors, _share_of_error(expected, errors, sample_time)


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


def drawn_error(expected: FloatArray, step: float, draw: int) -> FloatArray:
    """The error that the expected motion would have if it were the true one, measured by the same encoder, (n,) [rad].

    Slow motion and rest make an error that is slow: it is drawn by measuring, not as white noise. Draws differ in where
    the steps lie: `draw` is the seed of that.
    """
    true = expected + step * np.random.default_rng(draw).uniform()
    measured = step * np.round(true / step)
    return smoothest_motion(measured, step) - true
