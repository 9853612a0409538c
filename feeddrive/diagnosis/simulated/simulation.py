"""Closed-loop simulation error, where the controller is declared: what the plant does on its own, set-point given.

Torque in shares of its rms; the table position in shares of the rms of the following error (recorded position less
set-point, about its mean). Unfiltered, over the judged samples that the declared controller commanded.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.recordings.recordings import RecordingPredictor
from feeddrive.diagnosis.simulated.loop_evidence import LoopEvidence
from feeddrive.diagnosis.simulated.simulation_result import ErrorFigure
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

LoopErrors = dict[str, ErrorFigure]
"""Channel to its simulation error, all judged recordings together."""


def loop_errors(loops: Sequence[LoopEvidence], plants: Sequence[Plant]) -> LoopErrors:
    """Channel to its simulation error over the judged samples.

    Args:
        loops: judged recordings.
        plants: one for each of them.

    Returns:
        Empty where nothing is left to judge; not a number where a plant could not be followed.
    """
    missed: dict[str, list[FloatArray]] = {}
    shown: dict[str, list[FloatArray]] = {}
    for loop, plant in zip(loops, plants, strict=True):
        rows = loop.judged_rows
        if not rows.any():
            continue
        for name, error in loop.missed(loop.simulated(plant), rows).items():
            missed.setdefault(name, []).append(error)
            shown.setdefault(name, []).append(_scale(loop, name)[rows])
    return {name: _error(np.concatenate(missed[name]), np.concatenate(shown[name])) for name in missed}


def errors_after(problem: Problem, judged: Sequence[Judged], loops: Sequence[LoopEvidence]) -> LoopErrors:
    """Errors of the plants after, each as it is in its recording, on the samples of the loops."""
    plants, predictor = [j.after for j in judged], problem.predictor
    if isinstance(predictor, RecordingPredictor):
        plants = [predictor.machine(j.after, j.evidence) for j in judged]
    return loop_errors(loops, plants)


def _scale(loop: LoopEvidence, name: str) -> FloatArray:
    series = loop.recording[name]
    if name != "table_position":
        return series
    behind = series - loop.recording["setpoint"]
    following: FloatArray = behind - behind.mean()
    return following


def _error(error: FloatArray, scale: FloatArray) -> ErrorFigure:
    rms = float(np.sqrt(np.mean(error**2)))
    return ErrorFigure(rms, rms / float(np.sqrt(np.mean(scale**2))))
