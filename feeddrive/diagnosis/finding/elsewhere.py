"""An effect that may act at several places: where else it may, and a set with one at the likelier place.

A law at another place of the machine is another set of as many values. What one round takes is the likeliest beside
what was found before; beside the rest of a set, declared values fitted anew, another place may be likelier. An effect
that a search finds once is no candidate any more, so that its other places are asked here.
"""

from __future__ import annotations

from feeddrive.diagnosis.calibration.stated import given_back, without_effects
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.finding.sets import members_weighed
from feeddrive.diagnosis.friction_at_port import declared_level, declared_viscous
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between, same_samples
from feeddrive.diagnosis.recordings.recordings import is_shift
from feeddrive.effects.base import Effect, FrictionEffect, number
from feeddrive.effects.chain.stiffness_deviation import PARTS, StiffnessDeviation, parts_of
from feeddrive.effects.friction.viscous_warmup import ViscousWarmup
from feeddrive.effects.tabulated import Tabulated
from feeddrive.errors import InputError
from feeddrive.plant.analysis.stiffness_budget import participation
from feeddrive.plant.plant import Plant


def where(effect: Effect) -> str:
    """The word that says where an effect acts: its place, or else its port."""
    return effect.place or str(effect.port)


def elsewhere(effect: Effect, plant: Plant) -> tuple[Effect, ...]:
    """An effect at every other place that it may have on a machine; none for most.

    Args:
        effect: with the values that the others begin from.
        plant: as declared.
    """
    kind = type(effect)
    if isinstance(effect, Tabulated):  # its places are what it is over
        return ()
    if isinstance(effect, StiffnessDeviation):
        parts = [part for part in parts_of(plant.chain.values) if part != effect.place]
        return tuple(_other_part(effect, part, plant) for part in parts)
    if kind.place_key:
        return tuple(kind.of(None, place, **effect.values) for place in kind.places if place != effect.place)
    if not isinstance(effect, FrictionEffect):
        return ()
    drag = declared_viscous if isinstance(effect, ViscousWarmup) else declared_level
    ports = [
        port for port in kind.ports if port != effect.port and (drag(plant, port) or declared_viscous(plant, port))
    ]
    return tuple(kind.of(port, "", **effect.values) for port in ports)


def _other_part(effect: StiffnessDeviation, place: str, plant: Plant) -> Effect:
    """A stiffness of another part: it begins where the table gives way as much as here."""
    moved = StiffnessDeviation.of(None, place, **effect.values)
    if not {effect.place, place} <= set(PARTS):
        return moved
    here, there = (participation(plant, PARTS[part], plant.middle) for part in (effect.place, place))
    softer = 1 + (1 / number(effect.values["factor"]) - 1) * here / there
    ends = effect.parameter("factor")
    return moved.with_values(factor=min(max(1 / max(softer, 1 / ends.maximum), ends.minimum), ends.maximum))


def at_likelier_place(problem: Problem, found: Fit, count: int) -> tuple[Problem, Fit] | None:
    """A set with one of its effects at the place that makes the recordings likeliest; None where all are there.

    At another place another effect of the set may say nothing any more, and leaves it.

    Where an effect says that a fitted declared value is other, the question which value it is has its own answer
    (`calibration.beyond`).

    Args:
        problem: recordings.
        found: the set.
        count: candidates and starts that were tried.
    """
    if any(is_shift(effect) for effect in found.effects):  # what one recording has otherwise belongs to its place
        return None
    best, chosen = 0.0, None
    for place, effect in enumerate(found.effects):
        if _states_a_value(problem, effect):
            continue
        taken = {where(one) for one in found.effects if one.name == effect.name}
        for other in elsewhere(effect, problem.plant):
            if where(other) in taken or problem.budget.skips("other places of", effect.name):
                continue
            effects = (*found.effects[:place], other, *found.effects[place + 1 :])
            try:
                there = Standing(*refitted(problem, fit(problem, effects, iterations=JOINT_ITERATIONS)))
                if not same_samples(there.problem, problem) or not there.problem.possible(there.fit.effects):
                    continue
                fewer = _without_one(there, count)
            except InputError:
                continue
            for one in (there, *fewer):
                odds = odds_between(Standing(problem, found), one, count)
                if odds > best:
                    best, chosen = odds, (one.problem, one.fit)
    return chosen


def _without_one(there: Standing, count: int) -> list[Standing]:
    """The sets without one of the members that the data are likelier without, as far as slopes tell.

    What one effect leaves at the wrong place another may have taken: a drag at the screw, and a table position that
    comes late, are together a drag at the table.
    """
    problem, effects, result = there.problem, there.fit.effects, []
    gains = [one.gain for one in members_weighed(problem, there.fit, count)] if len(effects) > 1 else []
    for place, gain in enumerate(gains):
        if gain > 0:
            rest = [*effects[:place], *effects[place + 1 :]]
            given = without_effects(problem, [effects[place]], rest)
            result.append(Standing(*refitted(given, fit(given, rest, iterations=JOINT_ITERATIONS))))
    return result


def _states_a_value(problem: Problem, effect: Effect) -> bool:
    """Whether a declared value would be fitted within its tolerance again without an effect."""
    before, after = problem.calibration, given_back(problem, effect).calibration
    return before is not None and after is not None and len(after.values) > len(before.values)
