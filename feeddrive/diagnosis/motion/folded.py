"""Rows at which a mode near the rate of the rows answers the torque's steps, and shows as a slow motion.

A drive holds its torque for a cycle. Of a part of the torque at f the steps make one at k f_s + f as well, f_s being
the rate of the cycles and of the rows, and the rows show what the motor does there as a motion at f:

    e(f) = sum over k of |f / f_k| |G(f_k) + 1 / (J_m w_k^2)| / |G(f)|,    f_k = k f_s + f,  k = -2, -1, 1, 2

| symbol | meaning | unit |
|---|---|---|
| e | what is folded to f of the acceleration, over what is there | 1 |
| G | motor angle per torque, as declared; at f_k the largest within its modes' tolerance | rad/(N m) |
| J_m | inertia of the motor alone, whose answer between rows the splines know | kg m^2 |
| f/f_k | part at f_k of a torque that is held, over that at f | 1 |

The torque is predicted from the motion at the rows, so that it is off by e of itself. Rows at which that is more than
the noise in the band are left out. A mode at 940 Hz of a light axis, damped by 1.5 %, makes 0.8 % at 60 Hz of a torque
at 1 kHz, and named a resonance of 1.5 kg at 56 Hz where nothing was missing.
Valid where rows are the drive's cycles; of rows further apart see `slow_rows`.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import binary_dilation, maximum_filter1d, uniform_filter1d

from feeddrive.diagnosis.likelihood.tolerances import STIFFNESS
from feeddrive.diagnosis.motion.band import Band, sensor_noise
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.typing import BoolArray, ComplexArray, FloatArray

IMAGES = (-2, -1, 1, 2)
"""Multiples of the rate about which the steps' images are looked at; those further up are smaller by their cube."""

SKIRT = 2.0
"""Frequency over the edge of the band up to which the folded part is asked for: of twice the edge a 250th passes."""

EXACT = 1e-4
"""Share of the torque to which it is predicted from an exact motion: splines differentiate so well in the band
(`band.SHARE_OF_SAMPLE_RATE`). A recording without noise would lose all its rows otherwise."""

FINENESS = 1e-3
"""Step of the frequency, over itself, in which the answer is read: a tenth of the width of a mode damped by 1 %."""


def folded_rows(recording: Recording, plant: Plant, band: Band) -> BoolArray:
    """Rows, (n,), at which more is folded into the band than the noise of the torque there.

    Args:
        recording: with a motor torque; of others nothing is known, and none is one.
        plant: declared.
        band: of the comparison.
    """
    if "motor_torque" not in recording or not plant.chain.elastic:
        return np.zeros(len(recording), dtype=bool)
    torque = recording["motor_torque"]
    straight = np.linspace(torque[0], torque[-1], len(torque))
    frequency = np.asarray(np.fft.rfftfreq(len(torque), recording.sample_time), dtype=np.float64)
    inside = (frequency > 0) & (frequency < SKIRT * band.edge)
    share = np.zeros(len(frequency))
    share[inside] = _folded(plant, frequency[inside], 1 / recording.sample_time)
    folded = band.filter(np.fft.irfft(share * np.fft.rfft(torque - straight), len(torque)))
    reach = math.ceil(band.sample_rate / band.edge)
    level = np.sqrt(np.maximum(uniform_filter1d(folded**2, reach), 0.0))
    unseen = math.hypot(sensor_noise(torque, band), EXACT * float(np.std(band.filter(torque))))
    return np.asarray(binary_dilation(level > unseen, iterations=reach))


def folded_sentence(rows: BoolArray, recording: Recording) -> str:
    """Remark on a recording of which rows, (n,), are left out for what is folded there."""
    lost = 100 * float(np.mean(rows))
    return (
        f"{max(lost, 0.1):.1f} % of the rows are left out: a mode near the rate of the rows, "
        f"{1 / recording.sample_time:.4g} Hz, answers the torque's steps there, and shows as a slower motion; record "
        f"faster, with a faster loop, to see it as it is"
    )


def _folded(plant: Plant, frequency: FloatArray, rate: float) -> FloatArray:
    """e of the module's docstring at frequencies [Hz], (n,)."""
    highest = max(IMAGES) * rate + float(frequency[-1])
    every = np.exp(np.arange(math.log(float(frequency[0])), math.log(highest) + FINENESS, FINENESS))
    answer, without_motor = _answers(plant, every)
    beyond = np.abs(without_motor)
    # frequencies of modes are off by half of what stiffnesses are, either way
    off = 0.5 * math.log1p(STIFFNESS.catalogue)
    beyond = maximum_filter1d(beyond, 2 * math.ceil(off / FINENESS) + 1)
    total = np.zeros(len(frequency))
    for k in IMAGES:
        image = np.abs(k * rate + frequency)
        total += frequency / image * np.interp(image, every, beyond)
    found: FloatArray = total / np.interp(frequency, every, np.abs(answer))
    return found


def _answers(plant: Plant, frequency: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Motor angle per torque [rad/(N m)] at frequencies [Hz], (n,): of the machine; less that of the motor alone."""
    values, at = plant.chain_values(), plant.middle
    M, C, K = (
        np.array(matrix(values, at), dtype=float)
        for matrix in (plant.chain.mass, plant.chain.damping, plant.chain.stiffness)
    )
    motor = np.array(plant.chain.motor(values), dtype=float)
    w = 2 * np.pi * frequency[:, None, None]
    answer = np.linalg.solve(K + 1j * w * C - w**2 * M, np.broadcast_to(motor[:, None], (len(w), len(motor), 1)))[
        ..., 0
    ]
    motor_alone = -float(motor @ np.linalg.solve(M, motor)) / w[:, 0, 0] ** 2
    return answer @ motor, answer @ motor - motor_alone
