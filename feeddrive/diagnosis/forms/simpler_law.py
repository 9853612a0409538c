"""A law that the recordings do not tell from a simpler one: the simpler stands for both.

Near a law that has run far from where it is none no slope tells of the simpler one: a spring has a force of some
thousand newtons with it, a mode beyond the band a mass. So the simpler one is fitted in its place, and odds decide. A
Stribeck friction that falls beyond all speeds, or a bump wider than what was travelled, is a level: a declared value,
which is fitted in every set. A sine of less than a period is a curve over the stroke.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.calibration.stated import said_by_effects
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.refitting import refitted
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.spring_law import TOLD
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.set_evidence import variance_along
from feeddrive.diagnosis.likelihood.standing import Standing, odds_between
from feeddrive.diagnosis.starts.sines import SKIRT
from feeddrive.effects.base import Effect, Port, number
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.structural_mode import StructuralMode, resonates_within
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.stribeck import Stribeck
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.simulate.driven import LoadMotion


def as_payload(problem: Problem, found: Fit, count: int) -> tuple[Problem, Fit]:
    """A set with a payload where it has a mode, unless the mode is told from it, as surely as names are; else as it is.

    A mode that does not resonate in the band is a payload of its mass, and what its form takes beside is the model's
    error. Where the table's mass is fitted within its tolerance a payload is no candidate, so that the mode is there
    compared with none.

    Args:
        problem: recordings.
        found: the set.
        count: candidates and starts that were tried.
    """
    names = [effect.name for effect in found.effects]
    if StructuralMode.name not in names or Payload.name in names:
        return problem, found
    mode, rest = _apart(found, StructuralMode.name)
    payload = Payload.of(mass=number(mode.values["mass"]))
    there, effects = said_by_effects(problem, (*rest, payload))
    other = refitted(there, fit(there, effects, iterations=JOINT_ITERATIONS))
    resonates = resonates_within(mode, highest_seen(problem))
    told = resonates and odds_between(Standing(*other), Standing(problem, found), count) > TOLD
    return (problem, found) if told else other


def as_force(problem: Problem, found: Fit, count: int) -> tuple[Problem, Fit]:
    """A set with a constant force where it has a spring, where that is likelier; else as it is.

    A spring is a force that also changes along the stroke, and near one no slope tells of a set without it: the force
    of some thousand newtons that goes with it is too far. Beside a spring a constant force says where that pulls
    nowhere, which is a value of the spring's: k (x - x0) + F0 = k (x - (x0 - F0 / k)).

    Args:
        problem: recordings.
        found: the set.
        count: candidates and starts that were tried.
    """
    names = [effect.name for effect in found.effects]
    if PositionSpring.name not in names:
        return problem, found
    if ConstantForce.name in names:
        problem, found = _with_force_in_spring(problem, found)
        if any(effect.name == ConstantForce.name for effect in found.effects):
            return problem, found
    spring, rest = _apart(found, PositionSpring.name)
    way = problem.plant.middle - number(spring.values["zero"])
    force = ConstantForce.of(force=number(spring.values["stiffness"]) * way)
    other = refitted(problem, fit(problem, (*rest, force), iterations=JOINT_ITERATIONS))
    return other if odds_between(Standing(problem, found), Standing(*other), count) > 0 else (problem, found)


def _with_force_in_spring(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """A set whose spring pulls nowhere where it did together with a force; as it is beside a spring of no stiffness."""
    force, others = _apart(found, ConstantForce.name)
    place = [effect.name for effect in others].index(PositionSpring.name)
    stiffness, zero = (number(others[place].values[key]) for key in ("stiffness", "zero"))
    if not stiffness:
        return problem, found
    spring = others[place].with_values(zero=zero - number(force.values["force"]) / stiffness)
    effects = (*others[:place], spring, *others[place + 1 :])
    return refitted(problem, fit(problem, effects, iterations=JOINT_ITERATIONS))


def level_everywhere(problem: Problem, found: Fit) -> list[Effect]:
    """Frictions of a set whose fall no recorded speed or place tells: each is another level of friction.

    The fall of a Stribeck friction, or of a bump over the stroke, is not told where one beyond the speed or the travel
    of any table leaves as much as the fitted one does.
    """
    result: list[Effect] = []
    for place, effect in enumerate(found.effects):
        beyond = _without_fall(effect, scene_of(problem, found.effects).runs)
        if beyond is None:
            continue
        rest = (*found.effects[:place], beyond, *found.effects[place + 1 :])
        before, here = (len(read_coordinates(found.effects[:end], problem.plant)) for end in (place, place + 1))
        flat = fit(problem, rest, iterations=JOINT_ITERATIONS, still=[*range(before + 1, here)])  # all but its force
        left = min(flat, found, key=lambda one: one.squared_error)
        if flat.squared_error - found.squared_error < 2 * TOLD * variance_along(problem, left, found, flat):
            result.append(effect)
    return result


def _without_fall(effect: Effect, runs: Sequence[LoadMotion]) -> Effect | None:
    """A friction with its fall beyond every table; None for another law, or one that falls within what was recorded."""
    if isinstance(effect, Stribeck):
        key, seen = "velocity", max(float(np.max(np.abs(run.table_velocity))) for run in runs)
    elif isinstance(effect, FrictionVsPosition) and number(effect.values["peak"]):
        key, seen = "half_width", max(float(np.ptp(run.table_position)) for run in runs)
    else:
        return None
    return None if number(effect.values[key]) < seen else effect.with_values(**{key: effect.parameter(key).maximum})


def less_than_a_period(problem: Problem, found: Fit) -> list[Effect]:
    """Sines over an angle of which the recorded travel shows less than a period: nothing comes again there.

    Such a one is a curve over the stroke, and that is the form of another law.
    """
    sines = [effect for effect in found.effects if {"order", "phase"} <= effect.values.keys()]
    if not sines:
        return []
    runs, chain = scene_of(problem, found.effects).runs, problem.plant.chain
    travel = max(float(np.ptp(run.table_position)) for run in runs)

    def periods(sine: Effect) -> float:
        radius = chain.motor_radius if sine.port is Port.MOTOR else chain.radius
        return number(sine.values["order"]) * travel / (2 * np.pi * radius)

    return [sine for sine in sines if periods(sine) < 1]


def without_resonance(problem: Problem, found: Fit) -> list[Effect]:
    """Modes of a set that do not resonate in the band, beside a payload: it says as much of the table's mass."""
    if all(effect.name != Payload.name for effect in found.effects):
        return []
    modes = [effect for effect in found.effects if isinstance(effect, StructuralMode)]
    return [mode for mode in modes if not resonates_within(mode, highest_seen(problem))]


def highest_seen(problem: Problem) -> float:
    """Frequency up to which a resonance shows [Hz]: at the edge of the band m / (1 - r^2) is twice the mass still."""
    return SKIRT * max(e.edge for e in problem.evidence)


def _apart(found: Fit, name: str) -> tuple[Effect, tuple[Effect, ...]]:
    """The first effect of a name, and the others of a set."""
    place = [effect.name for effect in found.effects].index(name)
    return found.effects[place], (*found.effects[:place], *found.effects[place + 1 :])
