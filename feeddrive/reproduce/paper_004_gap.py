"""Which single changes of the drive of paper 004 explain its measured stiffness, and which its natural frequency.

One static and one dynamic number cannot tell the candidates apart: any one of `softer_parts` meets the stiffness, any
one of `slower_masses` then meets the frequency. Source: paper 004, which blames the guides' friction; that has the
wrong sign, for guides that carry part of the force make a drive stiffer.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scipy.optimize import brentq

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.analysis.held_frequency import held_frequency
from feeddrive.reproduce.paper_004_candidates import Candidate, DriveAt, slower_masses, softer_parts

FrequencyModel = Callable[[BallScrewDrive, float], float]
"""First natural frequency [Hz] of a drive, motor held, with its nut at a position [m]."""


@dataclass(frozen=True)
class Solved:
    """A candidate with the value that meets the measurement.

    Attributes:
        candidate: what is changed.
        value: to what [candidate.unit].
        state: the drive so changed.
    """

    candidate: Candidate
    value: float
    state: DriveAt


def frequency_of(state: DriveAt, model: FrequencyModel = held_frequency) -> float:
    """First natural frequency [Hz]; sticking guides lie parallel to the drive: f sqrt(1 + k_guide / k)."""
    return model(state.drive, state.position) * math.sqrt(1.0 + state.guide_stiffness / state.stiffness)


def explain_stiffness(start: DriveAt, measured: float) -> tuple[Solved, ...]:
    """Every single change that gives the measured static stiffness.

    Args:
        start: drive as declared.
        measured: [N/m].

    Raises:
        InputError: the measured stiffness is not below the declared one, so nothing has to be softer.
    """
    if not 0.0 < measured < start.stiffness:
        what = f"{measured / 1e6:.4g} N/µm is not below the declared {start.stiffness / 1e6:.4g} N/µm"
        raise InputError(what, "measured stiffness", "check its unit and the declared parts; nothing has to be softer")
    return _all_solved(softer_parts(start), lambda state: state.stiffness, measured)


def explain_frequency(start: DriveAt, measured: float, model: FrequencyModel = held_frequency) -> tuple[Solved, ...]:
    """Every single change of a mass, an inertia or the guides that gives the measured natural frequency.

    Args:
        start: drive whose stiffness is right already.
        measured: [Hz].
        model: natural frequency of a drive.

    Raises:
        InputError: not a positive frequency.
    """
    if not 0.0 < measured < math.inf:
        raise InputError(f"{measured:g} Hz is not a frequency", "measured frequency", "write it in Hz")
    return _all_solved(slower_masses(start), lambda state: frequency_of(state, model), measured)


def _all_solved(
    candidates: Sequence[Candidate], figure: Callable[[DriveAt], float], measured: float
) -> tuple[Solved, ...]:
    """The candidates that reach the measured figure within their range, with the value that does."""
    found = []
    for candidate in candidates:
        value = _solve(candidate, figure, measured)
        if value is not None:
            found.append(Solved(candidate, value, candidate.applied(value)))
    return tuple(found)


def _solve(candidate: Candidate, figure: Callable[[DriveAt], float], measured: float) -> float | None:
    """The value at which a figure is as measured; None where no value of the candidate's range gives it."""
    begin, end = candidate.ends

    def excess(value: float) -> float:
        return figure(candidate.applied(value)) - measured

    with warnings.catch_warnings():
        # The search tries values that no part has; the one it finds is checked when the drive is made with it.
        warnings.simplefilter("ignore", ValidityWarning)
        if excess(begin) * excess(end) > 0.0:
            return None
        return float(brentq(excess, begin, end, rtol=1e-12, maxiter=300))
