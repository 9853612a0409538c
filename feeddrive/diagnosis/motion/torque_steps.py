"""What the steps of a recorded torque make of it: the same at every passage of the same motion, as no noise is.

    e = k (Q(f) - f),    k = (Q(f) - f)'r / |Q(f) - f|²,    0 <= k <= 1

| symbol | meaning | unit |
|---|---|---|
| f | torque that is predicted | N m |
| Q | rounds to the steps of the recording | |
| e | what the steps alone leave of a right prediction, in the band | N m |
| r | residual, in the band | N m |
| k | share of the rounding that comes again | 1 |

Where the noise below the steps is less than half of one, a torque that comes again is rounded alike each time: at a
steady speed e stays, and looks like a friction that is other than declared. The spectrum of a residual knows how much
that scatters, not that it holds along the answer of one value. So e is a part of the variance along any direction.
Noise of s leaves k = exp(-2 pi² s² / step²), of half a step 0.7 %: Widrow and Kollár, Quantization Noise (2008),
chapter 4. The noise below steps cannot be read, as rows that toggle between two of them differ by as much as noise of a
step does; the residual tells k.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.effects.base import Effect
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.typing import FloatArray

TORQUE = "motor_torque"

_known: WeakKeyDictionary[Recording, float] = WeakKeyDictionary()


def coarse_step(evidence: AxisEvidence) -> float:
    """Step of a recorded torque [N m], where less than one is read as the noise of its rows; else 0."""
    if TORQUE not in evidence.channels or TORQUE not in evidence.recording.channels:
        return 0.0
    recording = evidence.recording
    if recording not in _known:
        _known[recording] = quantisation_step(recording[TORQUE])
    step = _known[recording]
    return step if step > evidence.noise[TORQUE] / evidence.band.noise_gain else 0.0


def steps_of_torque(problem: Problem, effects: Sequence[Effect]) -> FloatArray | None:
    """What the steps of the torque leave of the prediction with some effects, over the noise, (m,); None of no steps.

    Declared values have not been taken out of it.
    """
    coarse = [coarse_step(e) if isinstance(e, AxisEvidence) else 0.0 for e in problem.evidence]
    if not any(coarse):
        return None
    machine, parts = problem.machine(effects), []
    for e, step in zip(problem.evidence, coarse, strict=True):
        rows = e.thinned(e.fit_rows)
        series = {name: np.zeros(len(rows)) for name in e.channels}
        if step:
            predicted = problem.predictor.predict(machine, e)[TORQUE]
            if np.all(np.isfinite(predicted)):
                series[TORQUE] = e.in_band(step * np.round(predicted / step) - predicted)
        parts.append(e.weighted(series, rows))
    rounding = np.concatenate([*parts, np.zeros(len(problem.numbers))])
    square = float(rounding @ rounding)
    share = float(rounding @ problem.unwhitened(effects)) / square if square > 0 else 0.0
    scaled: FloatArray = min(max(share, 0.0), 1.0) * rounding
    return scaled
