"""Which candidate of a round is taken: one that is too small to matter hides those that only imitate it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.round import simplest_of_the_best
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out, least_gain, left_out_residual
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative
from feeddrive.plant.plant import Plant
from tests.convergence.test_simulate import BENCH

ROWS = 6000
RANDOM = np.random.default_rng(5)
SMALL, REAL, IMITATOR = (RANDOM.standard_normal(ROWS) for _ in range(3))
IMITATOR = 0.8 * SMALL + 0.6 * IMITATOR
NOISE = RANDOM.standard_normal(ROWS)
TOO_SMALL, OTHER, LIKE = Payload.of(mass=0.1), ConstantForce.of(force=1.0), LeadErrorCumulative.of(slope=1e-6)
"""The first is less than a thousandth of the table of 134 kg."""


def problem() -> Any:
    """What a round asks of a problem: samples in blocks."""
    evidence = SimpleNamespace(
        channels=("a",), fit_rows=np.ones(ROWS, dtype=bool), recording=SimpleNamespace(sample_time=1.0),
        block=20.0, edge=0.5, model_error={}, noise={}, thinned=lambda rows: rows, counted=np.ones(ROWS, dtype=bool),
        motion_speed=np.zeros(ROWS),
    )  # fmt: skip
    predictor = SimpleNamespace(chance=30.0)
    return SimpleNamespace(evidence=(evidence,), predictor=predictor, plant=Plant("axis", BENCH))


def found(signal: np.ndarray) -> Fit:
    """Nothing found yet."""
    return Fit((), signal, np.zeros((ROWS, 0)), np.zeros(0))


def attempt(effect: Effect, column: np.ndarray, signal: np.ndarray) -> Attempt:
    """An effect that predicts a column, fitted."""
    made, jacobian = problem(), column[:, None]
    coordinates = np.linalg.lstsq(jacobian, signal, rcond=None)[0]
    fitted = Fit((effect,), signal - jacobian @ coordinates, jacobian, coordinates)
    blocks = block_numbers(made)
    errors = left_out_residual(made, fitted, blocks)
    comparison = compare_left_out(signal, errors, blocks, least_gain(made, signal, errors))
    return Attempt(effect.name, fitted, comparison, made, errors)


def taken(signal: np.ndarray, *columns: tuple[Effect, np.ndarray]) -> str:
    """Name of what is taken, the attempts ranked as the search ranks them."""
    attempts = [attempt(effect, column, signal) for effect, column in columns]
    attempts.sort(key=lambda a: -a.comparison.gain)
    best = simplest_of_the_best(attempts, found(signal))
    return best.name if best is not None else ""


def test_imitator_of_what_is_too_small_is_not_taken() -> None:
    signal = 0.5 * SMALL + NOISE
    assert taken(signal, (TOO_SMALL, SMALL), (LIKE, IMITATOR)) == ""
    assert taken(signal, (LIKE, IMITATOR)) == LIKE.name  # where nothing better is known it would be


def test_effect_of_its_own_is_taken_beside_what_is_too_small() -> None:
    signal = 0.5 * SMALL + 0.4 * REAL + NOISE
    assert taken(signal, (TOO_SMALL, SMALL), (LIKE, IMITATOR), (OTHER, REAL)) == OTHER.name


def test_effect_that_ties_with_what_is_too_small_is_taken() -> None:
    signal = 0.5 * SMALL + NOISE
    assert taken(signal, (TOO_SMALL, SMALL), (LIKE, SMALL + 1e-3 * REAL)) == LIKE.name
