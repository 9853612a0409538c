"""Judging on data that were not fitted: error before and after, what each effect explains, and whether it carries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnose.cross_validation import LEAST_GAIN, Comparison, compare
from feeddrive.diagnose.evidence import Evidence
from feeddrive.diagnose.fit import Problem, fit
from feeddrive.diagnose.predictor import Machine
from feeddrive.diagnose.result import ChannelResult, ChannelSeries, JudgedRecording, error_figures
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError
from feeddrive.recording.channels import channel_unit
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class Judged:
    """One recording, judged: the evidence, and the plants before and after for it."""

    evidence: Evidence
    before: Machine
    after: Machine


def prepared_for_judging(problem: Problem, evidence: Evidence, before: Machine, after: Machine) -> Judged:
    """The recording without the samples that the plant cannot predict, both plants on the same samples."""
    kept = evidence.where_predictable(problem.predictor.predictable(after, evidence))
    return Judged(kept if kept.judged_rows.any() else evidence, before, after)


def error_series(problem: Problem, plant: Machine, evidence: Evidence) -> dict[str, FloatArray]:
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
        noise = float(np.sqrt(np.mean([j.evidence.noise[name] ** 2 for j in parts])))
        band = (0.0, parts[0].evidence.edge)
        figures = error_figures(before, scale), error_figures(after, scale)
        results.append(ChannelResult(name, channel_unit(name, ""), band, noise, *figures))
    return tuple(results)


def judged_channels(judged: Sequence[Judged]) -> tuple[str, ...]:
    """Channels of all judged recordings, each once."""
    return tuple(dict.fromkeys(name for j in judged for name in j.evidence.channels))


def squared_blocks(problem: Problem, plant_of: Sequence[tuple[Machine, Evidence]]) -> FloatArray:
    """Noise-weighted squared error per block of the judged samples, all recordings one after the other."""
    sums = []
    for plant, evidence in plant_of:
        errors = error_series(problem, plant, evidence)
        rows = np.flatnonzero(evidence.judged_rows)
        blocks = (rows * evidence.recording.sample_time / evidence.block).astype(int)
        total = np.zeros(int(blocks.max()) + 1)
        for name, error in errors.items():
            total += np.bincount(blocks, weights=(error[rows] / evidence.noise[name]) ** 2, minlength=len(total))
        sums.append(total[total > 0])
    return np.concatenate(sums)


@dataclass(frozen=True)
class Share:
    """What one effect does on data not fitted: 1 - (rms with / rms without)^2 per channel, and the comparison."""

    explains: dict[str, float]
    comparison: Comparison

    @property
    def carries(self) -> bool:
        """Whether the effect lowers the squared error there by as much as is asked of a new effect."""
        return self.comparison.gain > LEAST_GAIN


def share_of(problem: Problem, judged: Sequence[Judged], effects: Sequence[Effect], index: int) -> Share:
    """What the effect at `index` explains, all other effects refitted without it."""
    rest = [*effects[:index], *effects[index + 1 :]]
    refitted = fit(problem, rest, iterations=2).effects if rest else ()
    without = problem.plant.with_effects(*refitted)
    explains = {}
    for name in judged_channels(judged):
        lacking = _pooled(problem, [(without, j.evidence) for j in judged], name)
        having = _pooled(problem, [(j.after, j.evidence) for j in judged], name)
        explains[name] = 1 - having / lacking
    before = squared_blocks(problem, [(without, j.evidence) for j in judged])
    after = squared_blocks(problem, [(j.after, j.evidence) for j in judged])
    return Share(explains, compare(before, after))


def _pooled(problem: Problem, pairs: Sequence[tuple[Machine, Evidence]], name: str) -> float:
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
        part = slice(first, last + 1)
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
    """The same recording with all of it judged."""
    return replace(evidence, fitted=np.zeros(len(evidence.fitted), dtype=bool))
