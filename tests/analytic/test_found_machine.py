"""What is asked anew of the machine that is found: the encoder's error, the end of the fit, what tolerances leave."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from feeddrive.diagnosis import settled
from feeddrive.diagnosis.certainty import one_sided, uncertainty
from feeddrive.diagnosis.certainty.uncertainty import Certainty
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.likelihood.fit import MOVED, fit, fitted_to_the_end, linear_step
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion import preparing
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import beside_machine, prepare
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.typing import FloatArray
from tests.recovery.planted import axis_plant, pair


@pytest.fixture(scope="module")
def evidence() -> AxisEvidence:
    return prepare(pair("bench", "null")[0], axis_plant("bench"), 1.0)


@pytest.mark.parametrize(("gain", "is_new"), [(0.87, False), (0.80, True)])
def test_evidence_is_new_where_the_encoder_shows_otherwise(
    evidence: AxisEvidence, monkeypatch: pytest.MonkeyPatch, gain: float, is_new: bool
) -> None:
    """A twentieth of a gain is a tenth of the power that is carried at all."""
    frequencies = len(evidence.recording) // 2 + 1
    weighed = replace(evidence, gains={"motor_torque": np.full(frequencies, 0.9)})
    other = np.full(frequencies, 0.9)
    other[7] = gain
    monkeypatch.setattr(
        preparing, "weighed_by", lambda e, plant, quieter, plays: replace(e, gains={"motor_torque": other})
    )
    there = beside_machine(weighed, axis_plant("bench"))
    assert (there is not weighed) is is_new


def test_a_fine_encoder_shows_at_the_resonance_of_the_machine_and_not_at_the_declared_one(
    evidence: AxisEvidence,
) -> None:
    """22 bits: a table heavier by a seventh rings lower, where the band is open."""
    declared = axis_plant("bench")
    assert not evidence.gains
    assert beside_machine(evidence, declared) is evidence
    there = beside_machine(evidence, declared.with_effects(EFFECTS["payload"].of(mass=20.0)))
    assert isinstance(there, AxisEvidence) and there.gains


def test_the_last_fit_leaves_no_step_of_a_tenth_of_a_deviation(evidence: AxisEvidence) -> None:
    """A fit that begins half a deviation away takes a ten-thousandth of the square for nothing, and stays."""
    problem = Problem(axis_plant("bench"), (evidence,), AxisPredictor())
    at_end = fitted_to_the_end(problem, fit(problem, [EFFECTS["payload"].of(mass=0.1)]))
    deviation = np.sqrt(at_end.squared_error / len(at_end.residual)) / np.linalg.norm(at_end.jacobian)
    off = float(at_end.effects[0].values["mass"]) * (1 + 0.5 * deviation / at_end.coordinates[0])  # type: ignore[arg-type]
    near = fit(problem, [EFFECTS["payload"].of(mass=off)], iterations=0)
    found = fitted_to_the_end(problem, near)
    assert abs(near.coordinates[0] - at_end.coordinates[0]) == pytest.approx(0.5 * deviation, rel=1e-3)
    assert abs(found.coordinates[0] - at_end.coordinates[0]) < MOVED * deviation
    assert np.abs(linear_step(found.jacobian, found.residual)).max() < MOVED * deviation
    assert fitted_to_the_end(problem, found) is found


def test_along_declared_values_scores_scatter_by_their_tolerances(monkeypatch: pytest.MonkeyPatch) -> None:
    """A column that declared values stand for but for a tenth has their λ, and the noise of its tenth."""
    random = np.random.default_rng(20261131)
    basis, _ = np.linalg.qr(random.standard_normal((50, 3)))
    own, beside = basis @ np.array([2.0, 0.0, 1.0]), random.standard_normal(50)
    beside -= basis @ (basis.T @ beside)

    def white(evidence: Any, rows: Any, residual: FloatArray, columns: FloatArray) -> FloatArray:
        return np.asarray(0.25 * columns.T @ columns)

    monkeypatch.setattr(uncertainty, "score_covariance", white)
    problem: Any = SimpleNamespace(whitener=SimpleNamespace(basis=basis, variance=3.0), evidence=())
    found = uncertainty._scores(problem, [], np.zeros(50), (own + 0.1 * beside)[:, None])
    assert found[0, 0] == pytest.approx(3.0 * 5.0 + 0.25 * 0.01 * float(beside @ beside))
    problem.whitener = None
    alone = uncertainty._scores(problem, [], np.zeros(50), own[:, None])
    assert alone[0, 0] == pytest.approx(0.25 * 5.0)


def test_an_end_of_an_interval_may_be_where_the_fit_is(evidence: AxisEvidence, monkeypatch: pytest.MonkeyPatch) -> None:
    """At the end of its range a value ends there: a traceback once told no value from the one that ends."""
    problem = Problem(axis_plant("bench"), (evidence,), AxisPredictor())
    found = fit(problem, [EFFECTS["constant_force"].of(force=5.0)], iterations=0)
    here = float(found.coordinates[0])
    monkeypatch.setattr(one_sided, "one_sided", lambda problem, fitted, place: (here, 2 * here))
    unknown = Certainty(np.array([[100.0 * here**2]]), np.ones(1))
    (span,) = one_sided.all_intervals(problem, found, unknown)
    assert span["force"] is not None
    (ends,) = span["force"]
    assert ends == pytest.approx((5.0, 10.0))


@pytest.mark.parametrize("told", [False, True])
def test_a_name_that_the_last_fit_does_not_tell_from_none_goes(
    evidence: AxisEvidence, monkeypatch: pytest.MonkeyPatch, told: bool
) -> None:
    """A play of 85 µm, told from none where the fit was asked, ended as [0, 272] µm beside a bristle, and was named."""
    problem = Problem(axis_plant("bench"), (evidence,), AxisPredictor())
    force = EFFECTS["constant_force"].of(force=5.0)
    found = Search(problem, fit(problem, [force], iterations=0), (), (), {})
    further, without = fit(problem, [force], iterations=0), replace(found, fit=fit(problem, ()))
    asked = []

    def denied(other: Search, judged: Any, judge: Any) -> tuple[Search, list[Any]]:
        asked.append(other.fit)
        return without, ["judged without it"]

    monkeypatch.setattr(settled, "fitted_to_the_end", lambda problem, fitted: further)
    monkeypatch.setattr(settled, "sizes_around_none", lambda problem, fitted: ["" if told else "around none"])
    monkeypatch.setattr(settled, "without_denied", denied)
    monkeypatch.setattr(settled, "rivals_of", lambda kept, judged: [])
    kept, judged, rivals = settled._at_the_end(found, [], [["as before"]], lambda other: ["judged"])  # type: ignore[list-item, arg-type, return-value]
    if told:
        assert (kept.fit, judged, rivals, asked) == (further, ["judged"], [["as before"]], [])
    else:
        assert (kept, judged, rivals) == (without, ["judged without it"], []) and asked == [further]
