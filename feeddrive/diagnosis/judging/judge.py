"""Judging on data that were not fitted: error before and after, what each effect explains, and whether it carries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.judging.result import ChannelResult, ChannelSeries, JudgedRecording, error_figures
from feeddrive.diagnosis.likelihood.cross_validation import (
    Comparison,
    compare_left_out,
    compare_levelled,
    gain_of_model_error,
    model_error_rows,
)
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import declining, regained
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording.channels import channel_unit
from feeddrive.typing import FloatArray, IntegerArray


@dataclass(frozen=True)
class Judged:
    """One recording, judged: the evidence, the plants before and after for it, and by what its zero was shifted."""

    evidence: Evidence
    before: Plant
    after: Plant
    shift: float = 0.0

    def with_effects(self, problem: Problem, effects: Sequence[Effect]) -> Plant:
        """The declared plant with other effects than those found, counted from this recording's zero."""
        plant: Plant = problem.settled(effects).machine(shifted(effects, self.shift))
        return plant


def shifted(effects: Sequence[Effect], shift: float) -> list[Effect]:
    """The effects with every phase moved by order times `shift` [rad of the motor]."""
    return [
        effect.with_values(phase=float(effect.values["phase"]) + float(effect.values["order"]) * shift)  # type: ignore[arg-type]
        if "phase" in effect.values
        else effect
        for effect in effects
    ]


def prepared_for_judging(
    problem: Problem, evidence: Evidence, before: Plant, after: Plant, shift: float = 0.0
) -> Judged:
    """The recording without the samples that the plant cannot predict, both plants on the same samples."""
    kept = evidence.where_predictable(problem.predictor.predictable(after, evidence))
    return Judged(kept if kept.judged_rows.any() else evidence, before, after, shift)


def error_series(problem: Problem, plant: Plant, evidence: Evidence) -> dict[str, FloatArray]:
    """Channel to measured less predicted over the judged samples, the zero of the scale taken out; NaN elsewhere."""
    predicted = problem.predictor.predict(plant, evidence)
    rows = evidence.judged_rows
    result = {}
    for name in evidence.channels:
        if not np.all(np.isfinite(predicted[name])):
            mend = "a bristle or a damper is too stiff for the sample time; check its value and unit"
            raise InputError("the plant cannot be simulated with this motion", plant.name, mend)
        error = np.where(rows, evidence.measured[name] - predicted[name], np.nan)
        result[name] = error - np.nanmean(error) if name in evidence.floating else error
    return result


def channel_results(problem: Problem, judged: Sequence[Judged]) -> tuple[ChannelResult, ...]:
    """Error of every channel before and after, all judged recordings together."""
    results = []
    for name in judged_channels(judged):
        parts = [j for j in judged if name in j.evidence.channels]
        before = np.concatenate([error_series(problem, j.before, j.evidence)[name] for j in parts])
        after = np.concatenate([error_series(problem, j.after, j.evidence)[name] for j in parts])
        reference = np.concatenate([problem.predictor.reference(name, j.before, j.evidence) for j in parts])
        scale = float(np.sqrt(np.mean(reference**2)))
        noise = float(np.sqrt(np.mean([j.evidence.known_to(name) ** 2 for j in parts])))
        band = (0.0, parts[0].evidence.edge)
        figures = error_figures(before, scale), error_figures(after, scale)
        results.append(ChannelResult(name, channel_unit(name, ""), band, noise, *figures))
    return tuple(results)


def judged_channels(judged: Sequence[Judged]) -> tuple[str, ...]:
    """Channels of all judged recordings, each once."""
    return tuple(dict.fromkeys(name for j in judged for name in j.evidence.channels))


def judged_residual(problem: Problem, plant_of: Sequence[tuple[Plant, Evidence]]) -> tuple[FloatArray, IntegerArray]:
    """Noise-weighted error at the judged samples, all channels and recordings one after the other, and their blocks.

    Returns:
        Residual and number of the block of every row, shape (m,) each; channels share their blocks.
    """
    residuals, numbers, first = [], [], 0
    for plant, evidence in plant_of:
        errors = error_series(problem, plant, evidence)
        blocks = (np.flatnonzero(evidence.judged_rows) * evidence.recording.sample_time / evidence.block).astype(
            np.int64
        )
        residuals.append(evidence.weighted(errors, evidence.judged_rows))
        numbers += [first + blocks] * len(errors)
        first += int(blocks.max(initial=-1)) + 1
    return np.concatenate(residuals), np.concatenate(numbers)


@dataclass(frozen=True)
class Share:
    """What one effect does on data not fitted.

    Attributes:
        explains: channel to 1 - (rms with / rms without)^2.
        comparison: of the plants without and with it.
        size: what it predicts there, in standard deviations of the noise; infinite where nothing is left to chance, 0
            where it predicts nothing: a place on the stroke that the judged recording does not visit.
        levelled: the comparison with every block over what is left of it.
    """

    explains: dict[str, float]
    comparison: Comparison
    size: float
    levelled: Comparison

    @property
    def shows(self) -> bool:
        """Whether the judged data could tell the effect from none: three standard deviations of the noise."""
        return self.size > 3.0

    @property
    def is_open(self) -> bool:
        """Whether the judged data speak for the effect, and too little: its gain is within its standard error.

        Where the effect predicts d standard deviations, that is what becomes of a real one in more than one of forty
        cases up to d = 6 (its gain over its standard error scatters by one about d / 2).
        """
        return self.comparison.gain > 0 and self.size <= 6.0

    @property
    def carries(self) -> bool:
        """Whether the effect lowers the squared error there, by more than its standard error and the model's own error.

        An effect that is not there makes the error larger there by what it predicts, d standard deviations of the
        noise; its gain over its standard error scatters by one about -d / 2, that of a real one about +d / 2. With
        the d of 3 that the search asks for, a false one passes in less than one of a hundred cases. The share of the
        error that the search asks for is not asked for again: a long or noisy recording would refuse by it what it
        shows beyond doubt, and a real effect that just met it would fail every second time.

        One block that no law of ours reaches, an end stop or a torque beyond all that was fitted, may hold more than
        all others together, and alone make that scatter. So where the effect lowers the error at all, the same is asked
        with every block over its own level.
        """
        gain, asked = self.comparison.gain, max(self.comparison.least, self.comparison.standard_error)
        evenly = self.levelled.gain > max(self.levelled.least, self.levelled.standard_error)
        return gain > asked or (gain > self.comparison.least and evenly)


def share_of(problem: Problem, judged: Sequence[Judged], effects: Sequence[Effect], index: int) -> Share:
    """What the effect at `index` explains, all other effects refitted without it."""
    rest = [*effects[:index], *effects[index + 1 :]]
    problem = regained(problem, rest)
    try:
        return share_beyond(problem, judged, fit(problem, rest, iterations=2).effects if rest else ())
    except InputError:  # refitted to other motions, the others may be a plant that these cannot be simulated with
        return share_beyond(problem, judged, rest)


def share_beyond(problem: Problem, judged: Sequence[Judged], refitted: Sequence[Effect]) -> Share:
    """What the plants after explain beyond a plant with these effects, which lacks one of theirs.

    Samples that only that plant predicts, as it lacks a free play, count by what the plants after say of them.
    """
    lacking = [(j.with_effects(problem, refitted), j.evidence) for j in judged]
    having = [(j.after, j.evidence) for j in judged]
    explains = {
        name: 1 - _pooled(problem, having, name) / _pooled(problem, lacking, name) for name in judged_channels(judged)
    }
    before, blocks = judged_residual(problem, lacking)
    after, _ = judged_residual(problem, having)
    seen = [j.evidence for j in judged]
    alone = [] if has_play(refitted) else [(j, j.evidence.whole.beside(j.evidence)) for j in judged]
    alone = [(j, lost) for j, lost in alone if lost.judged_rows.any()]
    if alone:
        errors, more = judged_residual(problem, [(j.with_effects(problem, refitted), lost) for j, lost in alone])
        own, _ = judged_residual(problem, [(j.after, lost) for j, lost in alone])
        declines = declining(errors, own, float(np.mean(after**2)))
        before, after = np.concatenate([before, errors]), np.concatenate([after, declines])
        blocks = np.concatenate([blocks, int(blocks.max()) + 1 + more])
        seen += [lost for _, lost in alone]
    rows = model_error_rows(seen, [e.judged_rows for e in seen])
    comparison = compare_left_out(before, after, blocks, gain_of_model_error(rows, before, after))
    # of a difference d the chance part of the gain scatters by 2 |d|, so this is |d|
    predicted, chance = float(np.sum((before - after) ** 2)), comparison.standard_error * float(before @ before)
    size = 2 * predicted / chance if chance > 0 else float("inf") if predicted > 0 else 0.0
    return Share(explains, comparison, size, compare_levelled(before, after, blocks, comparison.least))


def _pooled(problem: Problem, pairs: Sequence[tuple[Plant, Evidence]], name: str) -> float:
    parts = [pair for pair in pairs if name in pair[1].channels]
    errors = np.concatenate([error_series(problem, plant, evidence)[name] for plant, evidence in parts])
    return float(np.nansum(errors**2))


def judged_recordings(problem: Problem, judged: Sequence[Judged]) -> tuple[JudgedRecording, ...]:
    """The series behind `prediction.csv` and the figures; left-out samples are NaN."""
    result = []
    for j in judged:
        evidence = j.evidence
        rows = evidence.judged_rows
        before, after = (error_series(problem, plant, evidence) for plant in (j.before, j.after))
        first, last = np.flatnonzero(rows)[[0, -1]]
        kept = np.flatnonzero(~evidence.fitted)  # of a long recording fitted pieces lie between
        part = kept[(kept >= first) & (kept <= last)]
        series = tuple(
            ChannelSeries(
                name,
                channel_unit(name, ""),
                np.where(rows, evidence.measured[name], np.nan)[part],
                (evidence.measured[name] - before[name])[part],
                (evidence.measured[name] - after[name])[part],
            )
            for name in evidence.channels
        )
        seen = problem.predictor.variables(j.after, evidence)
        variables = {name: values[part] for name, values in seen.items()}
        result.append(JudgedRecording(evidence.recording.name, evidence.recording.time[part], series, variables))
    return tuple(result)


def whole(evidence: Evidence) -> Evidence:
    """A recording with all of it judged."""
    return replace(evidence, fitted=np.zeros(len(evidence.fitted), dtype=bool))
