"""A tabulated drift of the surroundings with its size in the amplitude: the shape's largest value is one."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.effects.base import Effect, listed, number


def normalised(found: Search) -> Search:
    """The search with tabulated drifts scaled; the same drift, its fit taken again where it stands."""
    effects = [_scaled(effect) for effect in found.fit.effects]
    if tuple(effects) == found.fit.effects:
        return found
    return replace(found, fit=fit(found.problem, effects, iterations=0))


def _scaled(effect: Effect) -> Effect:
    if effect.name != "ambient_drift" or not isinstance(effect.values["time"], tuple):
        return effect
    shape = listed(effect.values["shape"])
    largest = max(shape, key=abs)
    if largest == 0:
        return effect
    amplitude = number(effect.values["amplitude"]) * largest
    return effect.with_values(amplitude=amplitude, shape=tuple(s / largest for s in shape))
