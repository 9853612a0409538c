"""Start of a further resonance on the table: read off the spectrum of what is left, over the table's acceleration.

A mass on a spring pulls the table by -m T(s) a, a being the table's acceleration, and the chain with its motor held in
its motion shows that in torque and position:

    T = (w^2 + 2 zeta w s) / (s^2 + 2 zeta w s + w^2),   x_left = -m G_x T a,   M_left = -m G_M T a,   s = j 2 pi f

with the chain's own responses G to a force on the table. For a few w and zeta the mass follows by least squares, each
channel weighted by its noise and each frequency by what the encoder tells of it. Mass and spectrum alone say where the
resonance is, also between lines of motion.

Declared values that were fitted without the mode have taken what they can of it, the payload that it is below its
resonance above all. So the mass is fitted beside their slopes, under the same tolerances (`calibration`): alone, the
spectrum of what they have left is none of a mode.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from feeddrive.diagnosis.finding.scene import Scene
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.structural_mode import StructuralMode, resonates_within
from feeddrive.typing import BoolArray, ComplexArray, FloatArray

FREQUENCIES = 60
"""Frequencies that are tried, from a few periods in the recording to `HIGHEST` times the edge of the band."""

HIGHEST = 1.6
"""Over the edge of the band; a resonance beyond shows as a payload."""

LOWEST = 3.0
"""Lowest frequency that is tried [Hz]: below it a controlled axis hardly shakes what stands on it."""

RATIOS = (0.01, 0.03, 0.1, 0.3)
"""Damping ratios that are tried."""

FADE = 0.3
"""Time over which samples are faded in and out [s]."""

LEAST_SHARE = 0.005
"""Share of the weighted square that a mode must take, by this reading, to be simulated; beyond the band, or without a
resonance, of what a payload leaves: what is no better there is one. The best of the grid takes 0.0015 of noise."""


def structural_mode(scene: Scene) -> list[list[Effect]]:
    """The mass, frequency and damping that explain most of the spectra."""
    seen = _Spectra(scene)
    payload, _ = seen.fitted(np.ones_like(seen.frequency))
    grid = [
        (seen.fitted(_transmissibility(seen.frequency, f, zeta)), f, zeta)
        for f in np.geomspace(LOWEST, HIGHEST * seen.edge, FREQUENCIES)
        for zeta in RATIOS
    ]
    _, f, zeta = max(grid, key=lambda entry: entry[0][0] if entry[0][1] > 0 else 0.0)
    (share, mass), f, zeta = _polished(seen, float(f), zeta)
    start = StructuralMode.of(mass=max(mass, 1e-6), frequency=f, damping=zeta)
    better = share - payload > LEAST_SHARE * (1 - payload)
    shows = better or (share > LEAST_SHARE and resonates_within(start, seen.edge))
    return [[start]] if shows else []


def _polished(seen: _Spectra, f: float, zeta: float) -> tuple[tuple[float, float], float, float]:
    """Share and mass, frequency and damping ratio where the share is greatest near these."""

    def lacking(logarithms: FloatArray) -> float:
        own, ratio = np.exp(logarithms)
        return -seen.fitted(_transmissibility(seen.frequency, float(own), float(ratio)))[0]

    found = minimize(lacking, np.log([f, zeta]), method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-5})
    own, ratio = (float(value) for value in np.exp(found.x))
    ratio = min(ratio, 1.0)
    allowed = StructuralMode.parameter("frequency")
    own = min(max(own, allowed.minimum), allowed.maximum)
    return seen.fitted(_transmissibility(seen.frequency, own, ratio)), own, ratio


def _transmissibility(frequency: FloatArray, own: float, zeta: float) -> ComplexArray:
    """T at frequencies [Hz] of a mode with its own frequency [Hz] and damping ratio; complex, shape (n,)."""
    ratio = 1j * frequency / own
    result: ComplexArray = (1 + 2 * zeta * ratio) / (1 + 2 * zeta * ratio + ratio**2)
    return result


class _Spectra:
    """Spectra of the longest recording in the band, over the noise of their channels.

    Attributes:
        frequency: [Hz], shape (n,).
        edge: of the band [Hz].
        left: what is left of each channel, shape (channels, n).
        unit: what a payload of one kilogram would leave, shape (channels, n).
        values: what is left, with the declared values that may stand for it.
    """

    def __init__(self, scene: Scene) -> None:
        at = scene.longest
        evidence, run, residual = scene.problem.evidence[at], scene.runs[at], scene.residuals[at]
        window = _faded(evidence.fit_rows, evidence.recording.sample_time)
        every = np.fft.rfftfreq(len(window), evidence.recording.sample_time)
        kept = (every > 0) & (every < evidence.edge)
        self.frequency: FloatArray = every[kept].astype(np.float64)
        self.edge = evidence.edge
        noise = np.array([evidence.unit(name) for name in evidence.channels])[:, None]
        if isinstance(evidence, AxisEvidence) and evidence.gains:
            noise = noise / np.array([evidence.gains[name][kept] for name in evidence.channels])
        self.left = np.array([np.fft.rfft(window * residual[n])[kept] for n in evidence.channels]) / noise
        acceleration = np.fft.rfft(window * np.gradient(run.table_velocity, evidence.recording.sample_time))[kept]
        responses = _responses(scene, self.frequency)
        per_force = np.array([responses[name] for name in evidence.channels])
        self.unit = -per_force * acceleration / noise
        self.values = _beside_values(scene, window, kept, noise, self.left)

    def fitted(self, transmissibility: ComplexArray | FloatArray) -> tuple[float, float]:
        """Share of the weighted square that the best mass takes away, and that mass [kg]."""
        shape = _rows(self.unit * transmissibility)
        along = self.values.basis.T @ shape
        energy = float(shape @ shape - along @ along)
        product = float(shape @ self.values.left - along @ self.values.taken)
        total = self.values.total
        return (product**2 / (energy * total), product / energy) if energy > 0 and total > 0 else (0.0, 0.0)


@dataclass(frozen=True)
class _BesideValues:
    """What is left, as spectra, with the declared values that may stand for it within their tolerances.

    Attributes:
        left: real and imaginary parts, (m,).
        basis: part in these rows of what is orthonormal in them and in the tolerances, (m, k).
        taken: of the spectra that are left and of the tolerances along it, (k,).
        total: weighted square of both that no declared value takes.
    """

    left: FloatArray
    basis: FloatArray
    taken: FloatArray
    total: float


def _beside_values(
    scene: Scene, window: FloatArray, kept: BoolArray, noise: FloatArray, left: ComplexArray
) -> _BesideValues:
    """The spectra that are left, (channels, n), of the longest recording, with its declared values.

    Args:
        scene: what is left.
        window: weights of its samples, (rows,).
        kept: frequencies in the band.
        noise: of channels and frequencies, (channels, n) or (channels, 1).
        left: over the noise.
    """
    evidence, known, rows = scene.problem.evidence[scene.longest], scene.problem.calibration, _rows(left)
    if known is None or not known.values:
        return _BesideValues(rows, np.zeros((len(rows), 0)), np.zeros(0), float(rows @ rows))
    slopes = known.slopes[evidence.recording]
    columns = np.column_stack(
        [
            _rows(np.array([np.fft.rfft(window * slopes[n][:, i])[kept] for n in evidence.channels]) / noise)
            for i in range(len(known.values))
        ]
    )
    # a sum over frequencies is half of the samples' number times that over samples, of which fits take a few
    tolerance = np.sqrt(known.variance * evidence.thinning * len(window) / 2)
    basis, _ = np.linalg.qr(np.vstack([columns, tolerance * np.eye(len(known.values))]))
    whole = np.concatenate([rows, -tolerance * known.coordinates])
    taken = basis.T @ whole
    return _BesideValues(rows, basis[: len(rows)], taken, float(whole @ whole - taken @ taken))


def _rows(spectra: ComplexArray | FloatArray) -> FloatArray:
    """Real and imaginary parts of spectra, (m,)."""
    flat = np.asarray(spectra).ravel()
    rows: FloatArray = np.concatenate([flat.real, flat.imag])
    return rows


def _faded(rows: BoolArray, sample_time: float) -> FloatArray:
    """Weights of the samples: the fitted ones, faded in and out, so that no edge smears the spectrum."""
    fade = np.hanning(max(3, int(FADE / sample_time)))
    faded: FloatArray = np.convolve(rows.astype(float), fade / fade.sum(), mode="same")
    return faded


def _responses(scene: Scene, frequency: FloatArray) -> dict[str, ComplexArray]:
    """Table position and motor torque per force on the table with the motor's motion as it is; complex, shape (n,)."""
    plant = scene.problem.machine(scene.found)
    p, x = plant.chain_values(), plant.middle
    chain = plant.chain
    M, C, K = (np.array(matrix(p, x), dtype=float) for matrix in (chain.mass, chain.damping, chain.stiffness))
    s = (2j * np.pi * frequency)[:, None, None]
    dynamic = M * s**2 + C * s + K
    force = np.zeros((len(M) - 1, 1))
    force[-1] = 1.0
    moved = np.linalg.solve(dynamic[:, 1:, 1:], np.broadcast_to(force, (len(frequency), *force.shape)))
    torque = (dynamic[:, :1, 1:] @ moved)[:, 0, 0] / float(chain.motor(p)[0])
    return {"table_position": moved[:, -1, 0], "motor_torque": torque}
