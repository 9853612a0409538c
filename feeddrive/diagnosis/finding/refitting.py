"""A set fitted beside the declared values: in turn with them, channels balanced, from those declared, beyond one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from feeddrive.diagnosis.calibration.beyond import beyond_from_declared, beyond_tolerance, is_beyond, with_torque_scale
from feeddrive.diagnosis.calibration.calibrate import (
    PASSES,
    at_declared,
    of_hours,
    recalibrated_by_rest,
    showing_encoder,
)
from feeddrive.diagnosis.calibration.known import TOLERANCE
from feeddrive.diagnosis.calibration.stated import is_within_tolerance, said_by_effects, without_effects
from feeddrive.diagnosis.calibration.together import cost, fitted_together, stepped_together
from feeddrive.diagnosis.calibration.value_slopes import with_new_slopes, with_slopes
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.members import rest_of
from feeddrive.diagnosis.likelihood.coordinates import absent_coordinates, read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.fit import Fit, fit, linear_step
from feeddrive.diagnosis.likelihood.problem import UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.standing import Standing, gain_between
from feeddrive.diagnosis.motion.predictability import has_play
from feeddrive.diagnosis.motion.preparing import beside_machine
from feeddrive.diagnosis.motion.row_steps import in_told_steps
from feeddrive.effects.base import ChainEffect, Effect, FrictionEffect, TransmissionEffect, number
from feeddrive.effects.chain.stiffness_deviation import WHOLE, StiffnessDeviation
from feeddrive.effects.transmission.preload_loss import PreloadLoss

HALVINGS = 8
"""Of the size of friction that pushes, and of a step that led too far, at most: of a two-hundredth nothing is told."""


def refitted(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Declared values and effects fitted in turn, with new slopes of the values.

    Values gone beyond their tolerances may have stood in for what was missing: they begin as declared as well.
    """
    if problem.calibration is None:
        return balanced(problem, found if not found.held else fit(problem, found.effects, iterations=0))
    there = recalibrated_by_rest(problem, found.effects)
    result = there, fit(there, found.effects, iterations=JOINT_ITERATIONS)
    assert there.calibration is not None
    # That of hours has begun as declared, and other weights are no lower error.
    begun = of_hours(there) or not problem.calibration.coordinates.any()
    if not begun and np.max(np.abs(there.calibration.coordinates), initial=0.0) > TOLERANCE:
        other, effects = stepped_together(at_declared(problem), found.effects, JOINT_ITERATIONS)
        both, variance = ((there, result[1].effects), (other, effects)), there.calibration.variance
        here, from_declared = (cost(one.settled(some), some, variance) for one, some in both)
        result = result if here <= from_declared else (other, fit(other, effects, iterations=0))
    return balanced(*result)


def in_steps_told(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """A set fitted where its machine is simulated in steps that nothing tells from the rows of the recordings.

    Beside it the encoder's error counts as that machine shows it.
    """
    machine = problem.machine(found.effects)
    evidence = tuple(beside_found(e, problem, found.effects) for e in problem.evidence)
    evidence = tuple(in_told_steps(e, machine, problem.predictor) for e in evidence)
    if all(one is other for one, other in zip(evidence, problem.evidence, strict=True)):
        return problem, found
    there = replace(problem, evidence=evidence)
    return refitted(there, fit(there, found.effects, iterations=JOINT_ITERATIONS))


def beside_found(evidence: Evidence, problem: Problem, effects: Sequence[Effect]) -> Evidence:
    """A recording with the encoder's error as the machine of a set shows it, where the set moves resonances.

    A play that is open holds the load by no spring: the machine without it shows what the error makes at its flanks.
    """
    if not any(isinstance(effect, (ChainEffect, TransmissionEffect)) for effect in effects):
        return evidence
    held = [effect for effect in effects if not has_play([effect])]
    return beside_machine(evidence, showing_encoder(problem, held), plays=len(held) < len(effects))


def at_rest(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Declared values and effects from which no step leads to a likelier plant; `PASSES` steps at most.

    A set that is new moves values that stood in for it, and slopes are those of where they stood: the first step is
    rarely the last, and every one here has slopes of its own. A step counts that makes the recordings likelier by half
    a nat, as one value off by a deviation; one that promises less is not taken. The slopes at the end are those of
    where it ends: masses, stiffnesses and the torque constant that all grow alike change no prediction, and slopes of
    elsewhere would tell them apart.
    """
    for there in to_rest(problem, found):
        problem, found = there.problem, there.fit
    return problem, found


class OnTheWay(NamedTuple):
    """A set on its way to rest, with slopes of where it is, and what the next step promises [nats]."""

    problem: Problem
    fit: Fit
    promised: float


def to_rest(problem: Problem, found: Fit) -> Iterator[OnTheWay]:
    """The steps of a set to rest (`at_rest`); only where it is, where that is rest or no value is fitted."""
    known = problem.calibration
    if known is None or not known.values or of_hours(problem):
        yield OnTheWay(problem, found, 0.0)
        return
    problem, variance, moved_on = with_new_slopes(problem, found.effects), known.variance, False
    for _ in range(PASSES):
        before = cost(problem, found.effects, variance)
        there, effects = stepped_together(problem, found.effects, JOINT_ITERATIONS)
        there = there.settled(effects)
        after = cost(there, effects, variance)
        for _ in range(HALVINGS):
            if after <= before:
                break
            there, effects = _half_way(problem, found.effects, there, effects)
            after = cost(there, effects, variance)
        if before - after <= variance:
            break
        problem = with_new_slopes(there, effects)
        found, moved_on = fit(problem, effects, iterations=0), True
        promised = _promised(problem, found)
        yield OnTheWay(problem, found, promised)
        if promised <= 0.5:
            break
    if not moved_on:
        yield OnTheWay(problem, fit(problem, found.effects, iterations=0), 0.0)


def _promised(problem: Problem, found: Fit) -> float:
    """What one linear step of the declared values and the effects takes from `cost` [nats]."""
    assert problem.calibration is not None
    variance = problem.calibration.variance
    left = found.residual - found.jacobian @ linear_step(found.jacobian, found.residual)
    return 0.5 * (cost(problem, found.effects, variance) - float(left @ left)) / variance


def _half_way(
    problem: Problem, effects: Sequence[Effect], there: Problem, others: Sequence[Effect]
) -> tuple[Problem, tuple[Effect, ...]]:
    """Declared values and effects in the middle between two places, one of them as far as a step that led too far."""
    assert problem.calibration is not None and there.calibration is not None
    middle = there.at_values(0.5 * (problem.calibration.coordinates + there.calibration.coordinates))
    first, last = (read_coordinates(some, problem.plant) for some in (effects, others))
    return middle, tuple(write_coordinates(others, problem.plant, 0.5 * (first + last)))


def balanced(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Each channel weighed by what is left of it, and the set fitted so."""
    if of_hours(problem):
        return problem, found
    for _ in range(JOINT_ITERATIONS):
        there = problem.balanced(found.effects)
        if there is problem:
            break
        problem, found = there, fit(there, found.effects, iterations=JOINT_ITERATIONS)
    return problem, found


def where_friction_brakes(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """A set beside values with which friction takes power; begun as declared where it would push the axis.

    A drag that stood in for what a name now takes leaves nothing to take it from, and steps stay where friction takes
    power only from where it does: so friction begins as small as that asks for. A law that is other than ours may push
    at a speed that nothing recorded has met, and is told by as much of it as does not.
    """
    if problem.calibration is None or of_hours(problem) or problem.possible(found.effects):
        return problem, found
    there, effects = at_declared(problem), list(found.effects)
    absent, _ = absent_coordinates(effects, problem.plant)
    rubs = np.array([isinstance(e, FrictionEffect) for e in effects for _ in read_coordinates([e], problem.plant)])
    sized = rubs & ~np.isnan(absent)
    for _ in range(HALVINGS):
        if there.possible(effects):
            break
        now = read_coordinates(effects, problem.plant)
        effects = write_coordinates(effects, problem.plant, np.where(sized, 0.5 * (now + absent), now))
    there, fitted = fitted_together(there, effects)
    return there, fit(there, fitted)


def begun_as_declared(problem: Problem, found: Fit) -> tuple[Problem, Fit] | None:
    """A set beside the values as declared, where one has gone beyond its tolerance and much is left; else None.

    Such values stand in for what is missing, which hides beside them. Or one of them is beyond its tolerance, and then
    all that is missing beside the declared ones is that: so both are asked, and the likelier goes on.
    """
    known = problem.calibration
    if known is None or of_hours(problem) or np.max(np.abs(known.coordinates), initial=0.0) <= TOLERANCE:
        return None
    if problem.plain_error(found.effects) < UNEXPLAINED or problem.budget.skips("rounds beside the declared values"):
        return None
    there = with_slopes(at_declared(problem), found.effects)
    return there, fit(there, found.effects, iterations=JOINT_ITERATIONS)


def with_scale_beyond(problem: Problem, found: Fit) -> tuple[Problem, Fit] | None:
    """A set beside a scale of the torque that is free of its tolerance, where that explains all; else None."""
    freed = with_torque_scale(problem, found)
    return None if freed is None else refitted(freed, fit(freed, found.effects))


def with_value_from_declared(problem: Problem, found: Fit) -> tuple[Problem, Fit] | None:
    """A set with the declared value as an effect that is off by far, begun from the declared machine; else None.

    Asked where values have gone beyond their tolerances: there they stand in for what is missing.
    """
    known = problem.calibration
    if known is None or of_hours(problem) or np.max(np.abs(known.coordinates), initial=0.0) <= TOLERANCE:
        return None
    begun = beyond_from_declared(problem, found)
    if begun is None:
        return None
    freed, effect = begun
    return refitted(freed, fit(freed, (*found.effects, effect)))


def with_value_back(problem: Problem, found: Fit) -> tuple[Problem, Fit] | None:
    """A set without an effect on declared values that nothing puts beyond their tolerances any more; else None.

    Such a value stood in for what was named after it.
    """
    if problem.calibration is None or of_hours(problem):
        return None
    for place, effect in enumerate(found.effects):
        rest = [other for i, other in enumerate(found.effects) if i != place]
        if is_within_tolerance(effect, problem.plant) is not None and not is_beyond(problem, rest, effect):
            there = without_effects(problem, [effect], rest)
            return refitted(there, fit(there, rest))
    return None


def with_softer_spring(problem: Problem, found: Fit, gone: Sequence[Effect]) -> tuple[Problem, Fit] | None:
    """The set with a spring as soft under every force in the place of a lost preload; None where that is not asserted.

    Args:
        problem: recordings.
        found: the set.
        gone: those of its effects that are out, the lost preload among them.
    """
    soft = next((one for one in gone if isinstance(one, PreloadLoss)), None)
    if soft is None:
        return None
    place = "nut" if "nut_stiffness" in problem.plant.chain_values() else WHOLE
    factor = StiffnessDeviation.parameter("factor")
    ratio = min(max(number(soft.values["ratio"]), factor.minimum), factor.maximum)
    rest = rest_of(found.effects, gone)
    own, effects = said_by_effects(problem, [*rest, StiffnessDeviation.of(None, place, factor=ratio)])
    there, result = refitted(own, fit(own, effects, iterations=JOINT_ITERATIONS))
    *others, softer = result.effects
    return (there, result) if is_beyond(there, others, softer) else None


def with_value_beyond(problem: Problem, found: Fit) -> tuple[Problem, Fit, Comparison] | None:
    """A set with the declared value as an effect that is beyond its tolerance, and what it brings; None where none is.

    Free of its tolerance a value can only lower the error, a row being worth as much in both sets. Where it does not,
    slopes alone said so: beside a free play a step of a value moves the contacts, and what the slope then tells holds
    for that step.
    """
    beyond = beyond_tolerance(problem, found)
    if beyond is None:
        return None
    freed, effect = beyond
    there, result = refitted(freed, fit(freed, (*found.effects, effect)))
    alike = there.weighed(problem.evidence[0].left)
    same = result if alike is there else fit(alike, result.effects, iterations=0)
    assert problem.calibration is not None and there.calibration is not None
    before = problem.at_values(problem.calibration.coordinates, there.calibration.variance)
    without = fit(before, found.effects, iterations=0)
    if same.squared_error >= without.squared_error:
        return None
    return there, result, gain_between(Standing(before, without), Standing(alike, same))
