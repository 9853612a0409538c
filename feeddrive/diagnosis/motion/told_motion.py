"""Motion that the encoder does not tell, told by the torque that it took.

Where more of an expected motion is the encoder's error than motion (`unsure_motion`), what the motor really did is
still there, and at a pole of the load with the motor held nothing else keeps the load from ringing: driven without it
a plant rings at every reversal, and rings the friction of its guide away. The torque was measured, and says what moved:

    θ = argmin |T - f(A + θ)|² / S_T + |θ|² / S_q   ->   θ <- K (T - f(A + θ) + Z θ),   K = Z* / (|Z|² + S_T / S_q)

| symbol | meaning | unit |
|---|---|---|
| A, θ | motion that the encoder tells, and what it does not, at frequencies of the band with ρ beyond a half | rad |
| T, f | torque as it acts, and what the plant asks for, in the band | N m |
| Z | torque over motor angle of the plant, linear about a steady motion | N m/rad |
| S_T, S_q | spectra of the torque's noise and of the steps' error, white | (N m)² s, rad² s |

No motion is larger than S_q there, or the encoder would tell it. These frequencies count for a twenty-sixth and less in
every comparison, so that the torque takes little of what it says of the plant. Source: Gauss and Newton's step of the
motion's likelihood, both channels together (errors in variables: Söderström, Errors-in-Variables Methods in System
Identification (2018)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.signal.windows import tukey

from feeddrive.diagnosis.motion.band import END_CUT, Band
from feeddrive.diagnosis.motion.unsure_motion import HALF
from feeddrive.errors import InputError
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.analysis.ode import OUTPUTS
from feeddrive.plant.motor_torque import asked_torques
from feeddrive.plant.plant import Plant
from feeddrive.simulate.driven import motor_motion, simulate_driven
from feeddrive.typing import BoolArray, ComplexArray, FloatArray

TURNS = 2
"""Steps towards the likeliest motion: the friction that the first motion rang away is there in the second."""


@dataclass(frozen=True)
class Teller:
    """What of a motion a torque tells.

    Attributes:
        plant: that answers the motion.
        band: of the comparison.
        sample_time: [s].
        gain: K, and Z, at the frequencies of `size` samples, zero where the encoder tells the motion [rad/(N m)].
        stiffness: Z [N m/rad].
        size: samples of a transform in which the end does not meet the beginning.
    """

    plant: Plant
    band: Band
    sample_time: float
    gain: ComplexArray
    stiffness: ComplexArray
    size: int

    def asked(self, angle: FloatArray) -> FloatArray:
        """Torque that a motion asks for, in the band [N m], (n,).

        Raises:
            SimulationError: a motion that cannot be followed.
        """
        time: FloatArray = np.arange(len(angle), dtype=np.float64) * self.sample_time
        run = simulate_driven(self.plant, motor_motion(time, angle))
        return self.band.filter(asked_torques(self.plant, run.torque))

    def told(self, angle: FloatArray, torque: FloatArray) -> FloatArray:
        """θ, (n,) [rad].

        Args:
            angle: A, (n,) [rad].
            torque: T in the band, (n,) [N m].

        Raises:
            SimulationError: as `asked`.
        """
        count = len(angle)
        ends = tukey(count, min(2 * END_CUT / (count * self.sample_time), 1.0))
        told: FloatArray = np.zeros(count)
        for _ in range(TURNS):
            missed = rfft(ends * (torque - self.asked(angle + told)), self.size)
            told = irfft(self.gain * (missed + self.stiffness * rfft(told, self.size)), self.size)[:count]
        return told


def teller(
    plant: Plant, band: Band, share: FloatArray, count: int, sample_time: float, noise: float, step: float
) -> Teller | None:
    """What tells the motion that an encoder does not; None where it tells all of the band, or nothing else does.

    Args:
        plant: that answers the motion.
        band: of the comparison.
        share: ρ at the frequencies of `count` samples, (count // 2 + 1,).
        count: samples of a recording.
        sample_time: [s].
        noise: rms of the torque's noise in the band [N m].
        step: of the encoder [rad].
    """
    size = int(next_fast_len(2 * count, real=True))
    size += size % 2  # irfft takes an even length
    frequency: FloatArray = np.asarray(np.fft.rfftfreq(size, sample_time), dtype=np.float64)
    shares = np.interp(frequency, np.fft.rfftfreq(count, sample_time), share)
    asked: BoolArray = (shares >= HALF) & (frequency <= band.edge) & (frequency > 0)
    if not asked.any():
        return None
    try:
        stiffness = _stiffness(plant, frequency[asked])
    except InputError:  # no steady motion there
        return None
    over = (noise / band.noise_gain) ** 2 / (step**2 / 12)
    gain, whole = np.zeros(len(frequency), dtype=complex), np.zeros(len(frequency), dtype=complex)
    whole[asked] = stiffness
    gain[asked] = np.conj(stiffness) / (np.abs(stiffness) ** 2 + over)
    return Teller(plant, band, sample_time, gain, whole, size)


def _stiffness(plant: Plant, frequency: FloatArray) -> ComplexArray:
    """Z at frequencies [Hz], (m,).

    Raises:
        InputError: no steady motion is found.
    """
    A, B, C, _ = linear_matrices(plant, position=plant.middle)
    s = 2j * np.pi * frequency[:, None, None] * np.eye(len(A))
    answers = np.linalg.solve(s - A, np.broadcast_to(B[:, :1], (len(frequency), len(A), 1)))
    found: ComplexArray = 1 / (C[OUTPUTS.index("motor_angle")] @ answers)[:, 0]
    return found
