"""What one would do otherwise, on the same recordings: sparse regression of the residual, and a black box.

Both correct the declared plant: they are fitted to its error on the recording for fitting and judged on the other one.
"""

from __future__ import annotations

import importlib.util
import warnings
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.judging.judge import error_series, whole
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.plant.plant import Plant
from tests.generator.axis import AxisParameters
from tests.recovery.suite.regression_terms import terms_of
from tests.recovery.suite.truth import Errors, Prepared

THRESHOLDS = (0.02, 0.05, 0.1, 0.2, 0.5)
"""Of sparse regression, in units of the noise: terms whose rms is smaller are dropped."""

RIDGE = 1e-3
"""Over the number of samples, the terms being of rms one: what is alike is not set against each other."""

FOLD = 4
"""Every how many blocks one is held out to choose the threshold."""

POINTS, POINTS_FOR_LENGTHS = 1000, 200
"""Points of the Gaussian process, and those on which its length scales are chosen."""

LEAST = 1e-2
"""Rms of a term where it is fitted, over that where it is judged, below which it is left out: a place that one
recording alone visits."""

STRONGEST = 3
"""Terms that count as named: as many as an ambiguous set may hold."""


@dataclass(frozen=True)
class Column:
    """Residual of one channel at some samples, in units of its noise, and their blocks."""

    residual: np.ndarray
    blocks: np.ndarray
    rows: np.ndarray


def installed() -> bool:
    """Whether PySINDy and scikit-learn are there."""
    return all(importlib.util.find_spec(name) is not None for name in ("pysindy", "sklearn"))


def columns(pair: Prepared, evidence: Evidence) -> dict[str, Column]:
    """The declared plant's error, channel by channel."""
    plant: Plant = pair.problem.plant
    errors = error_series(pair.problem, plant, whole(evidence))
    rows = np.flatnonzero(evidence.thinned(evidence.counted))
    blocks = (rows * evidence.recording.sample_time / evidence.block).astype(int)
    return {name: Column(error[rows] / evidence.noise[name], blocks, rows) for name, error in errors.items()}


@dataclass(frozen=True)
class Sparse:
    """A sparse regression: error after per channel [SI], its strongest terms, and how many it keeps."""

    after: Errors
    terms: dict[str, list[str]]
    kept: dict[str, int]


def sparse(pair: Prepared, axis: AxisParameters | None) -> Sparse:
    """Sparse regression by PySINDy."""
    fitted, judged = pair.problem.evidence[0], pair.judged[0]
    terms, there = terms_of(fitted, axis), terms_of(judged, axis)
    after: Errors = {}
    named: dict[str, list[str]] = {}
    kept: dict[str, int] = {}
    # what hardly varies where it is fitted has no coefficient that means anything elsewhere
    terms = {name: one for name, one in terms.items() if _rms(one, False) > LEAST * _rms(there[name], False)}
    scale = {name: _rms(one, False) for name, one in terms.items()}
    targets = columns(pair, judged)
    for name, column in columns(pair, fitted).items():
        features = np.column_stack([terms[key][column.rows] / scale[key] for key in terms])
        weights = _sparse_weights(features, column)
        others = np.column_stack([there[key][targets[name].rows] / scale[key] for key in terms])
        after[name] = judged.noise[name] * _rms(targets[name].residual - others @ weights, name in judged.floating)
        strength = np.abs(weights) * np.std(others, axis=0)
        strength[0] = abs(weights[0])  # a constant has no spread
        order = np.argsort(-strength)[:STRONGEST]
        named[name] = [list(terms)[i] for i in order if weights[i] != 0]
        kept[name] = int(np.count_nonzero(weights))
    return Sparse(after, named, kept)


def _sparse_weights(features: np.ndarray, column: Column) -> np.ndarray:
    """The sparsest model within one standard error of the best on held-out blocks."""
    held = column.blocks % FOLD == FOLD - 1
    tried = []
    for threshold in (*THRESHOLDS, np.inf):
        weights = _stlsq(features[~held], column.residual[~held], threshold)
        squares = (column.residual[held] - features[held] @ weights) ** 2
        sums = np.bincount(column.blocks[held], weights=squares)
        sums = sums[sums > 0]
        tried.append((float(sums.mean()), float(sums.std() / np.sqrt(len(sums))), threshold))
    least, error, _ = min(tried)
    chosen = max(threshold for mean, _, threshold in tried if mean <= least + error)
    return _stlsq(features, column.residual, chosen)


def _stlsq(features: np.ndarray, target: np.ndarray, threshold: float) -> np.ndarray:
    import pysindy

    if threshold == np.inf:
        return np.zeros(features.shape[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it warns where no term is left, which is an answer here
        model = pysindy.SINDy(
            optimizer=pysindy.STLSQ(threshold=threshold, alpha=RIDGE * len(target)),
            feature_library=pysindy.IdentityLibrary(),
        )
        model.fit(features, t=1.0, x_dot=target[:, None])
    return np.asarray(model.coefficients(), dtype=float).ravel()


def black_box(pair: Prepared, axis: AxisParameters | None) -> Errors:
    """A Gaussian process over x, v and sign v (warm-up: speed, and followed slowly and fast): error after [SI]."""
    fitted, judged = pair.problem.evidence[0], pair.judged[0]
    here, there = _inputs(fitted, axis), _inputs(judged, axis)
    centre, spread = here.mean(axis=0), here.std(axis=0)
    targets = columns(pair, judged)
    after: Errors = {}
    for name, column in columns(pair, fitted).items():
        chosen = np.linspace(0, len(column.rows) - 1, min(POINTS, len(column.rows))).astype(int)
        inputs = (here[column.rows[chosen]] - centre) / spread
        others = (there[targets[name].rows] - centre) / spread
        correction = _gaussian_process(inputs, column.residual[chosen], others)
        after[name] = judged.noise[name] * _rms(targets[name].residual - correction, name in judged.floating)
    return after


def _inputs(evidence: Evidence, axis: AxisParameters | None) -> np.ndarray:
    if isinstance(evidence, AxisEvidence) and axis is not None:
        x = evidence.band.filter(axis.transmission * evidence.recording["motor_angle"])
        v = np.gradient(x, evidence.recording.sample_time)
        return np.column_stack([x, v, np.sign(v)])
    terms = terms_of(evidence, axis)
    return np.column_stack([terms[key] for key in ("N", "N after 1000 s", "N after 10000 s")])


def _gaussian_process(inputs: np.ndarray, target: np.ndarray, others: np.ndarray) -> np.ndarray:
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    smooth = ConstantKernel(1.0, (1e-3, 1e3)) * RBF([1.0] * inputs.shape[1], (1e-2, 1e2))
    kernel = smooth + WhiteKernel(1.0, (1e-2, 1e3))
    few = np.linspace(0, len(inputs) - 1, min(POINTS_FOR_LENGTHS, len(inputs))).astype(int)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a length scale at its bound is an answer here
        chosen = GaussianProcessRegressor(kernel, normalize_y=True, random_state=0).fit(inputs[few], target[few])
        process = GaussianProcessRegressor(chosen.kernel_, optimizer=None, normalize_y=True).fit(inputs, target)
    predicted: np.ndarray = process.predict(others)
    return predicted


def _rms(error: np.ndarray, floating: bool) -> float:
    return float(np.std(error) if floating else np.sqrt(np.mean(error**2)))
