"""Is it the recorder? One number about a recording, asked beside what the machine was found to lack.

| suspect | what is recorded | the recording as mended |
|---|---|---|
| clock_rate | time stamps exp(c) times the true ones | time / exp(c) |
| channel_gain | torque exp(c) times the true one | torque / exp(c) |
| channel_drift | torque with a zero that moves, by c t r, r of one largest torque in one recording | torque - c t r |

Each is one column beside the slopes of a fitted set: for the clock the change of the residual when the recording is
prepared with other time stamps, for a gain the predicted torque, for a drift the time. What a column brings on blocks
left out is compared as for any effect (`cross_validation`), and two questions are asked of it:

    alone    with nothing found, is it worth as much as the best single effect was?
    beside   with all effects found, does it pay?

Where either is so the recording is mended, and searched again where fits say what slopes have said. The mend is kept
where fewer fitted values, that of the fault among them, then say as much, or where no more names leave less. An effect
of one value that says as much as a fault stays, as nobody can tell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.calibration.calibrate import calibrated, calibrated_list
from feeddrive.diagnosis.calibration.known import known_values
from feeddrive.diagnosis.calibration.stated import said_by_effects
from feeddrive.diagnosis.certainty.noise_colour import score_covariance
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.likelihood.cross_validation import (
    LEAST_GAIN,
    Comparison,
    Prior,
    compare_left_out,
    least_gain,
    left_out,
    left_out_residual,
    prior_of,
)
from feeddrive.diagnosis.likelihood.fit import Fit, fit, linear_step
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.recordings.recordings import is_shift
from feeddrive.diagnosis.suspicion.as_recorded import error_within_tolerances
from feeddrive.diagnosis.suspicion.quality import Quality
from feeddrive.effects.base import Effect
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray

CLOCK, GAIN, DRIFT = "clock_rate", "channel_gain", "channel_drift"

LEAST = {CLOCK: 1e-3, GAIN: 5e-3, DRIFT: 5e-3}
"""Logarithm of a factor that is a fault: a quartz misses by 1e-4 at most, a calibrated current by half a per cent, and
so does its zero, of its range, which is at least the largest torque that was recorded."""

MOST = {CLOCK: math.log(4.0), GAIN: math.log(1e4), DRIFT: 10.0}
"""Logarithm of a factor that a recorder has at most, and its drift over the largest torque: a clock counts rows as
samples or as half-cycles, a torque is in mN m or in per cent of a small rated one. What asks for more is no fault."""

STEP = 1e-3
"""Change of the logarithm of a clock from which its column is taken."""

SAME_ERROR = 1.05
"""Ratio of squared errors per sample from which a fault leaves less than what was found without it (`round.TIE`)."""


NOT_ASKED = Comparison(0.0, 0.0, 0.0)
"""What a fault brings that is only applied."""


@dataclass(frozen=True)
class Suspect:
    """A fault of the recorder with its size.

    Attributes:
        kind: `CLOCK`, `GAIN` or `DRIFT`.
        size: c.
        deviation: of c.
        comparison: what it brings on blocks left out.
        rate: r of a drift: largest torque over the duration, of the recordings that were fitted [N m/s].
        beside: whether it pays beside all that was found.
    """

    kind: str
    size: float
    deviation: float = math.inf
    comparison: Comparison = NOT_ASKED
    rate: float = 0.0
    beside: bool = False

    def mended(self, recording: Recording) -> Recording:
        """The recording without the fault."""
        factor = math.exp(-self.size)
        if self.kind == CLOCK:
            return replace(recording, time=recording.time * factor, sample_time=recording.sample_time * factor)
        if self.kind == DRIFT:
            if "motor_torque" not in recording:
                return recording
            moved = self.size * self.rate * (recording.time - recording.time[0])
            return recording.with_channels({"motor_torque": recording["motor_torque"] - moved})
        names = [name for name in ("motor_torque", "motor_current", "motor_torque_share") if name in recording]
        return recording.with_channels({name: factor * recording[name] for name in names})

    def quality(self, recordings: Sequence[Recording]) -> Quality:
        """What is reported; recordings are the mended ones."""
        factor = math.exp(self.size)
        low, high = (math.exp(self.size + way * 1.96 * self.deviation) for way in (-1, 1))
        explains = self.comparison.gain
        if self.kind == DRIFT:
            low, high = (self.rate * (self.size + way * 1.96 * self.deviation) for way in (-1, 1))
            total = self.size * self.rate * recordings[0].duration
            what = f"the zero of the torque moves by {total:+.3g} N m in {recordings[0].duration:.3g} s, whatever runs"
            mend = "record at rest before and after, and take the line between the two zeros off the torque"
            return Quality(
                DRIFT, "motor_torque", self.size * self.rate, "N m/s", what, mend, (low, high), explains, mended=True
            )
        if self.kind == CLOCK:
            off = f"{100 * (factor - 1):+.3g} % off"
            what = f"the clock of the recording is {off}: {factor:.6g} s are written for each second"
            mend = f'write sample_time = "{1e3 * recordings[0].sample_time:.6g} ms" in the mapping'
            return Quality(CLOCK, "time", factor, "1", what, mend, (low, high), explains, mended=True)
        return replace(scaled(factor, (low, high)), explains=explains)


def scaled(factor: float, ci95: tuple[float, float]) -> Quality:
    """A torque that is recorded as so many times what acts."""
    what = f"the torque is recorded {factor:.4g} times as large as this machine needs, whatever it does"
    mend = f'write "factor = {1 / factor:.4g}" in the mapping, or correct the torque constant'
    return Quality(GAIN, "motor_torque", factor, "1", what, mend, ci95, mended=True)


def beyond_its_constant(problem: Problem, found: Fit) -> tuple[Quality, ...]:
    """A torque of another scale than the tolerance of its constant allows; it was fitted and is judged so."""
    known = known_values(problem, found)
    if known is None:
        return ()
    for place, value in enumerate(known.values):
        if value.key != "torque_constant":
            continue
        if value.widened > 1 or known.least() - known.least(place) > SURE**2:
            one, declared = calibrated_list(problem, found)[place], value.declared
            low, high = (end / declared for end in one.ci95)
            if low > 1 + value.tolerance or high < 1 / (1 + value.tolerance):
                return (scaled(declared / one.number, (1 / high, 1 / low)),)
    return ()


def suspected(found: Search) -> Suspect | None:
    """The fault of the recorder that is worth mending the recordings; None where none is."""
    if found.begun is None:
        return None
    problem, empty = _begun(found)
    asked = [*_asked(problem, empty), *_asked(found.problem, found.fit)]
    first = max((trial.gain for trial in found.trials if trial.round == 1), default=0.0)
    alone, beside = asked[: len(asked) // 2], asked[len(asked) // 2 :]
    if not found.fit.effects:  # no name to spare, so that it is kept for what it leaves alone (`is_better`)
        first, beside = max(first, 1 - 1 / SAME_ERROR), []
    able = [one for one in alone if one.comparison.gain > first - max(LEAST_GAIN, 2 * one.comparison.standard_error)]
    able, beside = ([one for one in some if one.comparison.pays and _is_sure(one)] for some in (able, beside))
    best = max((*able, *beside), key=lambda one: one.comparison.gain, default=None)
    return best and replace(best, beside=any(one.kind == best.kind for one in beside))


def again(problem: Problem, kind: str) -> Suspect | None:
    """What is left of a fault in recordings that were mended, nothing being found in them."""
    return next((one for one in _asked(problem, fit(problem, ())) if one.kind == kind), None)


def is_worth_a_search(fault: Suspect, mended: Problem, found: Search) -> bool:
    """Whether recordings that were mended of a fault are to be searched.

    Beside what was found it pays, or alone it leaves as little as the best effect that was found does. Slopes have said
    so; here each has the declared values as they are most likely beside it. Where one effect of one value was found, a
    fault that leaves noise, and no less of it, stays without a search: nobody can tell the two.

    Args:
        fault: as suspected.
        mended: the mended recordings, the declared values calibrated and nothing found.
        found: in the recordings as they are.
    """
    if fault.beside:
        return True
    problem, _ = _begun(found)
    effects, least = found.fit.effects, math.inf
    left = error_within_tolerances(mended, fit(mended, (), iterations=0), problem)
    if not effects:
        return left < error_within_tolerances(found.problem, found.fit, problem) / SAME_ERROR
    if len(effects) == 1:  # at its end, which a fit from the declared values on need not reach
        least = error_within_tolerances(found.problem, found.fit, problem)
        if len(found.fit.coordinates) == 1 and left < 1 / LEVEL**2 and not left < least / SAME_ERROR:
            return False  # one value for one, and what is left is noise, of which a name takes nothing
    for effect in effects:
        stated, said = said_by_effects(problem, [effect])
        there, alone = refitted(stated, fit(stated, said))
        least = min(least, error_within_tolerances(there, alone, there))
    return left <= SAME_ERROR * least


def _begun(found: Search) -> tuple[Problem, Fit]:
    """The recordings with their declared values calibrated, and nothing found."""
    assert found.begun is not None
    problem, empty = found.begun
    if empty.effects:  # it went on from another search
        problem = calibrated(replace(problem, calibration=None))
        empty = fit(problem, ())
    return problem, empty


def is_better(fault: Suspect, mended: Search, found: Search) -> bool:
    """Whether a fault and what was found beside it say as much as what was found without it, or more with no more.

    As much is what chance does for the effects that are spared: for each, less than is asked of any.
    """
    first, _ = _begun(found)
    before, after = (error_within_tolerances(one.problem, one.fit, first) for one in (found, mended))
    if len(mended.fit.coordinates) + 1 < len(found.fit.coordinates):
        spared = max(1, len(found.fit.effects) - len(mended.fit.effects))
        return after <= (1 + spared * fault.comparison.least) * before
    return len(mended.fit.effects) <= len(found.fit.effects) and after < before / SAME_ERROR


def _is_sure(one: Suspect) -> bool:
    return max(LEAST[one.kind], SURE * one.deviation) < abs(one.size) <= MOST[one.kind]


def can_be_asked(problem: Problem, effects: Sequence[Effect]) -> bool:
    """Whether recordings can tell of a fault beside some effects: of motion, with a torque, all of one machine."""
    if not all(isinstance(e, AxisEvidence) for e in problem.evidence):
        return False
    if any(map(is_shift, (*problem.plant.effects, *effects))):
        return False  # recordings that differ are compared with each other, not with a clock
    return not any("motor_torque" not in e.channels or e.scaled_from for e in problem.evidence)  # type: ignore[attr-defined]


def _asked(problem: Problem, found: Fit) -> list[Suspect]:
    """Every suspect beside a fitted set."""
    if not can_be_asked(problem, found.effects):
        return []
    columns = {
        CLOCK: _clock_column(problem, found), GAIN: _gain_column(problem, found), DRIFT: _drift_column(problem),
    }  # fmt: skip
    return [_beside(problem, found, kind, column) for kind, column in columns.items() if column is not None]


def _beside(problem: Problem, found: Fit, kind: str, column: FloatArray) -> Suspect:
    """A suspect whose slope with the prediction is a column, (m,).

    A fit that is not at its end has a linear step of its own, which any column would be thanked for: it is taken first.
    """
    blocks = block_numbers(problem)
    own = linear_step(found.jacobian, found.residual)
    found = replace(found, residual=found.residual - found.jacobian @ own, coordinates=found.coordinates + own)
    wide = np.column_stack([found.jacobian, column])
    step = linear_step(wide, found.residual)
    residual = found.residual - wide @ step
    prior = prior_of(found.free, problem.plant, found.coordinates)
    size = float(step[-1])
    width = max(abs(size), LEAST[kind])
    prior = Prior(np.append(prior.beyond, size), np.append(prior.width, width))
    without = left_out_residual(problem, found, blocks)
    errors = left_out(residual, wide, blocks, prior)
    comparison = compare_left_out(without, errors, blocks, least_gain(problem, without, errors))
    alone = column - found.jacobian @ linear_step(found.jacobian, column) if found.jacobian.size else column
    score = score_covariance(problem.evidence, [e.fit_rows for e in problem.evidence], residual, alone[:, None])
    square = float(alone @ alone)
    deviation = math.sqrt(float(score[0, 0])) / square if square > 0 else math.inf
    return Suspect(kind, size, deviation, comparison, _rate(problem))


def _gain_column(problem: Problem, found: Fit) -> FloatArray:
    """The predicted torque, whitened, (m,)."""
    return _whitened(problem, predicted_torque(problem, found.effects))


def predicted_torque(problem: Problem, effects: Sequence[Effect]) -> FloatArray:
    """The rows of a prediction, (m,), those of all channels but the torque being zero."""
    plant, parts = problem.machine(effects), []
    for e in problem.evidence:
        predicted = problem.predictor.predict(plant, e)
        only = {name: s if name == "motor_torque" else np.zeros_like(s) for name, s in predicted.items()}
        parts.append(e.weighted(only, e.thinned(e.fit_rows)))
    return _with_numbers(problem, np.concatenate(parts))


def at_other_clock(problem: Problem, size: float) -> Problem:
    """The problem with the recordings at the times of a clock that ran exp(-c) as fast."""
    fault = Suspect(CLOCK, size)
    evidence = [e.at_other_times(fault.mended(e.recording)) for e in problem.evidence if isinstance(e, AxisEvidence)]
    return replace(problem, evidence=tuple(evidence))


def _drift_column(problem: Problem) -> FloatArray | None:
    """A torque that grows with time, whitened, (m,); None where the torque is no torque as it is written."""
    if any("motor_torque" not in e.recording for e in problem.evidence):
        return None
    parts, rate = [], _rate(problem)
    for e in problem.evidence:
        series = {name: np.zeros(len(e.counted)) for name in e.channels}
        series["motor_torque"] = e.in_band(rate * (e.recording.time - e.recording.time[0]))
        parts.append(e.weighted(series, e.thinned(e.fit_rows)))
    return _whitened(problem, _with_numbers(problem, np.concatenate(parts)))


def _rate(problem: Problem) -> float:
    """Largest torque over the duration, of the recordings that have one [N m/s]."""
    of = [e.recording for e in problem.evidence if "motor_torque" in e.recording]
    largest = max((float(np.nanmax(np.abs(one["motor_torque"]))) for one in of), default=0.0)
    return largest / max((one.duration for one in of), default=1.0)


def _clock_column(problem: Problem, found: Fit) -> FloatArray | None:
    """What the residual loses per logarithm of a clock, whitened, (m,); None where no other clock can be tried."""
    plant, parts = problem.machine(found.effects), []
    for e, other in zip(problem.evidence, at_other_clock(problem, STEP).evidence, strict=True):
        rows = e.thinned(e.fit_rows)
        here, there = (e.weighted(problem.predictor.predict(plant, one), rows) for one in (e, other))
        parts.append((there - here) / STEP)
    column = np.concatenate(parts)
    return _whitened(problem, _with_numbers(problem, column)) if np.all(np.isfinite(column)) else None


def _with_numbers(problem: Problem, column: FloatArray) -> FloatArray:
    """A column with rows for the numbers measured beside the recordings, by others."""
    return np.concatenate([column, np.zeros(len(problem.numbers))])


def _whitened(problem: Problem, column: FloatArray) -> FloatArray:
    return column if problem.whitener is None else problem.whitener.applied(column)
