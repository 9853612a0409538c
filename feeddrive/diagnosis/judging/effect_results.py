"""The effects that were taken and those that were not, as a diagnosis tells them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.certainty.uncertainty import Interval
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Share
from feeddrive.diagnosis.judging.physical_reading import physical_reading
from feeddrive.diagnosis.judging.result import EffectResult, ParameterResult, RefusedEffect, Trial, error_without
from feeddrive.diagnosis.likelihood.cross_validation import LEAST_GAIN, SIGNIFICANCE
from feeddrive.effects.base import Effect
from feeddrive.units.quantity import percent


def effect_results(
    found: Search, shares: Sequence[Share], spans: Sequence[dict[str, list[Interval] | None]], odds: Sequence[float]
) -> tuple[EffectResult, ...]:
    """What was found: values with intervals, what each explains on data not fitted, and its reading."""
    results = []
    for effect, share, ends, own in zip(found.fit.effects, shares, spans, odds, strict=False):  # shifts come last
        results.append(
            EffectResult(
                effect.name,
                _parameters(effect, ends),
                share.explains,
                share.carries,
                _evidence(effect, share),
                physical_reading(effect),
                own,
            )
        )
    return tuple(results)


def _parameters(effect: Effect, known: dict[str, list[Interval] | None]) -> dict[str, ParameterResult]:
    """Values and intervals in SI; the summary of a tabulated curve is read off the table."""
    result: dict[str, ParameterResult] = {}
    if effect.name == "friction_deviation":
        result["port"] = ParameterResult(str(effect.port), "")
    if effect.place != effect.default_place:
        result[effect.place_key] = ParameterResult(effect.place, "")
    for key, value in effect.values.items():
        unit, ends = effect.parameter(key).unit, known[key]
        if isinstance(value, tuple):
            result[key] = ParameterResult(list(value), unit, ends)
        else:
            result[key] = ParameterResult(value, unit, ends[0] if ends else None)
    if effect.name == "friction_vs_position":
        result.update(_curve_and_bump(effect))
    return result


def _curve_and_bump(effect: Effect) -> dict[str, ParameterResult]:
    """The form that was not fitted: a table of a bump, or peak, centre and half width of a table."""
    position, level = effect.values["position"], effect.values["delta_force"]
    if isinstance(position, tuple) and isinstance(level, tuple):
        x, force = np.array(position), np.array(level)
        above = force - np.median(force)
        top = int(np.argmax(np.abs(above)))
        wide = np.abs(above) > np.abs(above[top]) / np.e
        half = max(0.5 * float(np.ptp(x[wide])), float(np.min(np.diff(x))))
        summary = {"peak": (float(above[top]), "N"), "centre": (float(x[top]), "m"), "half_width": (half, "m")}
        return {key: ParameterResult(value, unit) for key, (value, unit) in summary.items()}
    peak, centre, width = (float(effect.values[key]) for key in ("peak", "centre", "half_width"))  # type: ignore[arg-type]
    x = centre + width * np.linspace(-2.5, 2.5, 11)
    force = peak * np.exp(-(((x - centre) / width) ** 2))
    return {"position": ParameterResult(x.tolist(), "m"), "delta_force": ParameterResult(force.tolist(), "N")}


def _evidence(effect: Effect, share: Share) -> str:
    times = {name: f"{error_without(value):.3g}" for name, value in share.explains.items()}
    larger = {name: factor for name, factor in times.items() if float(factor) > 1}  # "1 times larger" says nothing
    channels = ", ".join(f"that of {name.replace('_', ' ')} {factor} times" for name, factor in larger.items())
    seen = f"Without it the error on data not fitted is larger: {channels}" if channels else "It lowers no judged error"
    idle = "; it does not carry to them" if share.shows else "; they could hardly show it"
    more = "" if share.carries else idle
    return f"{seen}{more}. It shows as a function of {effect.signature.variable.replace('_', ' ')}."


def refused_effects(found: Search) -> tuple[RefusedEffect, ...]:
    """Candidates that were not taken, with the reason: the recording cannot show them, or they did not pay."""
    taken = {effect.name for effect in found.fit.effects}
    best = {trial.name: trial for trial in found.trials}  # the last round counts: everything else was in by then
    refused = []
    for candidate in found.problem.predictor.candidates:
        if candidate.name in taken:
            continue
        if candidate.name in found.reasons:
            refused.append(RefusedEffect(candidate.name, found.reasons[candidate.name]))
        elif candidate.name in best:
            trial = best[candidate.name]
            refused.append(RefusedEffect(candidate.name, _why_not(trial, found.trials)))
        else:
            refused.append(RefusedEffect(candidate.name, "it could not be fitted to these recordings"))
    return tuple(refused)


def _why_not(trial: Trial, trials: Sequence[Trial]) -> str:
    """Why a candidate was not kept, from its last round."""
    lowers = f"it lowers the squared error on data not fitted by {percent(trial.gain, 2)}"
    winner = next((one for one in trials if one.round == trial.round and one.taken), None)
    if trial.gain <= 0:
        return "it does not lower the error on data not fitted"
    if trial.gain <= LEAST_GAIN:
        return f"{lowers}, less than the {percent(LEAST_GAIN, 1)} asked for"
    if trial.taken:
        return f"it was taken in round {trial.round} and no longer paid beside what was found after it"
    if winner is not None:
        return f"{lowers}, {winner.name} by {percent(winner.gain, 2)}; after that it was worth no further trial"
    if trial.gain <= SIGNIFICANCE * trial.standard_error:
        return f"{lowers}, within the scatter of the blocks ({SIGNIFICANCE:g} times {percent(trial.standard_error, 2)})"
    return f"{lowers}, but it is too small to matter on this machine, or chance gives the best of many as much"
