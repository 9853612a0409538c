"""Terms of no known name carried in the plant: as which effect, with which values, and whether that pays.

A term of the torque becomes a force, a friction or a torque; the table of the residual gives the first values, one
linear step on all channels the final ones. It is carried when it lowers the error on the judged data by as much as is
asked of a named effect.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.judging.judge import Judged, error_series, judged_residual
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.slopes import jacobian_of
from feeddrive.diagnosis.unexplained.analysis import Analysis, analyse, table_of
from feeddrive.diagnosis.unexplained.functional_anova import Found
from feeddrive.diagnosis.unexplained.terms import Form
from feeddrive.diagnosis.unexplained.unexplained_result import Carried, Table, no_gain
from feeddrive.diagnosis.unexplained.view import views_of
from feeddrive.effects.base import Effect, Port
from feeddrive.effects.tabulated import Tabulated, TabulatedForce, TabulatedFriction, TabulatedTorque, TabulatedTravel
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray

DAMPING = 0.01
"""Damping of the step on all channels: breakpoints that the recordings hardly see keep the value of the residual."""

WORSE = 1.02
"""Factor by which the error of another channel may rise."""

DEAR = 3.0
"""Squared error, in units of the noise, that a further breakpoint must take away."""

MOTION = {"table_position": "position", "table_velocity": "velocity", "time": "time", "motor_angle": "position"}
"""Variable to the word of a table at the table."""

SHAFT = {"table_position": "angle", "table_velocity": "speed", "time": "time", "motor_angle": "angle"}
"""Variable to the word of a table at the motor."""

NO_EFFECT = "not carried, since no tabulated effect stands for it"


def analyses_of(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channels: Sequence[ChannelResult]
) -> dict[str, Analysis]:
    """What is left of channels with these effects in the plant, taken apart; `judged` have them in the plant after."""
    plant, names = problem.machine(effects), [channel.name for channel in channels]
    fitted = views_of(problem, [(plant, evidence) for evidence in problem.evidence], names, False)
    seen = views_of(problem, [(j.after, j.evidence) for j in judged], names, True)
    radius = plant.chain.motor_radius if plant.has_motion else 0.0
    return {one.name: analyse(fitted[one.name], seen[one.name], one.unit, radius) for one in channels}


def tried(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], carried: Sequence[Carried],
    forms: Sequence[Found], channel: ChannelResult,
) -> Carried | str:  # fmt: skip
    """The term as an effect that pays on the judged data, or why there is none."""
    if not problem.predictor.of_motion:
        return NO_EFFECT
    own = [one.effect for one in carried]
    options = []
    try:
        for start in [one for form in forms for one in effects_of(form, channel.name, channel.unit, problem.plant)]:
            (fitted,), error = joint_step(problem, [*effects, *own], [start])
            options.append((fitted, error + DEAR * len(fitted.breakpoints)))
    except InputError as wrong:  # nothing there to act on, as friction that is not declared, or beyond what is physical
        return f"not carried: {wrong.what}"
    if not options:
        return NO_EFFECT
    best, _ = min(options, key=lambda option: option[1])
    found = judged_with(problem, with_carried(judged, *own), best, channel.name)
    return found if found.pays else no_gain(found.explains)


def forms_of(found: Found, analyses: Iterable[Analysis]) -> list[Found]:
    """The found term, and it with the breakpoints that another channel shows, where these are more."""
    term, forms = found.term, [found]
    if term.form is not Form.CURVE:
        return forms
    for other in [one.term for analysis in analyses for one in analysis.found]:
        same = (other.form, other.variable, other.times) == (term.form, term.variable, term.times)
        if same and other.size > term.size:
            values, errors = (np.interp(other.nodes, term.nodes, series) for series in (found.values, found.errors))
            forms.append(replace(found, term=other, values=values, errors=errors))
    return forms


def effects_of(found: Found, channel: str, unit: str, plant: Plant) -> list[Tabulated]:
    """The effects that a term may stand for, with the values of the residual; none where there is no such effect."""
    table, term, radius = table_of(found, unit), found.term, plant.chain.motor_radius
    values, word = np.array(table.values), MOTION.get(term.variable, "")
    if channel == "table_position":
        if term.times or word not in ("position", "time"):
            return []
        return [_made(TabulatedTravel, Port.TRANSMISSION, word, table, values - values.mean(), radius)]
    if term.form is Form.LEVEL:  # friction whose level turns with the direction
        if not word and term.variable != "direction":
            return []
        return [TabulatedFriction.of(Port.TABLE, "position", position=(0.0,), force=(float(values[0] / radius),))]
    if term.times:  # a level of friction, or its viscous coefficient
        if word in ("", "velocity"):
            return []
        key = "viscous" if term.times == "table_velocity" else "force"
        return [_made(TabulatedFriction, Port.TABLE, word, table, values / radius, radius, key)]
    if not word:
        return []
    return [
        _made(TabulatedForce, Port.TABLE, word, table, values / radius, radius),
        _made(TabulatedTorque, Port.MOTOR, SHAFT[term.variable], table, values, radius),
    ]


def _made(
    kind: type[Tabulated], port: Port, word: str, table: Table, values: FloatArray, radius: float, key: str = ""
) -> Tabulated:
    """An effect with a table over `word`, its breakpoints brought from the variable's unit to the port's."""
    at, period = np.array(table.breakpoints), table.period
    to_travel, to_angle = table.breakpoint_unit == "rad" and word == "position", word in ("angle", "speed")
    scale = radius if to_travel else 1 / radius if to_angle and table.breakpoint_unit != "rad" else 1.0
    at, period = scale * at, scale * period
    place = f"periodic_{word}" if period else word
    given = {word: tuple(at.tolist()), key or kind.value_keys[0]: tuple(values.tolist())}
    return kind.of(port, place, **given, **({"period": period} if period else {}))


def joint_step(
    problem: Problem, before: Sequence[Effect], tables: Sequence[Tabulated]
) -> tuple[list[Tabulated], float]:
    """Tables after one damped linear step on all channels, and the squared error; as they are where it does not help.

    The other effects stay as they are.

    Raises:
        InputError: the plant cannot be simulated with them.
    """
    free = [*[False] * len(before), *[True] * len(tables)]
    residual = problem.residual((*before, *tables))
    base = problem.measured - residual
    jacobian = jacobian_of(problem, (*before, *tables), free, base)
    here = float(residual @ residual)
    if not (np.isfinite(here) and np.all(np.isfinite(jacobian))):
        raise InputError(f"{tables[-1].name} could not be simulated", tables[-1].name)
    normal = jacobian.T @ jacobian
    scale = np.diag(normal) + 1e-9 * np.trace(normal) + 1e-300
    step = np.linalg.solve(normal + DAMPING * np.diag(scale), jacobian.T @ residual)
    moved = write_coordinates(tables, problem.plant, read_coordinates(tables, problem.plant) + step)
    left = problem.residual((*before, *moved))
    there = float(left @ left)
    if not there < here:
        return list(tables), here
    return [one for one in moved if isinstance(one, Tabulated)], there


def judged_with(problem: Problem, judged: Sequence[Judged], new: Tabulated, channel: str) -> Carried:
    """What a further effect, for a term of a channel, does on the judged data."""
    having = with_carried(judged, new)
    before, after = (_rms(problem, group) for group in (judged, having))
    without, blocks = judged_residual(problem, [(j.after, j.evidence) for j in judged])
    there, _ = judged_residual(problem, [(j.after, j.evidence) for j in having])
    harmless = all(after[name] <= WORSE * before[name] for name in before)
    explains = {name: 1 - (after[name] / before[name]) ** 2 for name in before}
    return Carried(channel, new, explains, before, after, compare_left_out(without, there, blocks).pays and harmless)


def with_carried(judged: Sequence[Judged], *effects: Effect) -> list[Judged]:
    """The judged recordings with further effects in the plant after."""
    return [replace(j, after=j.after.with_effects(*effects)) for j in judged]


def _rms(problem: Problem, judged: Sequence[Judged]) -> dict[str, float]:
    """Channel to the rms of the error after, all recordings together."""
    squares: dict[str, list[FloatArray]] = {}
    for j in judged:
        for name, error in error_series(problem, j.after, j.evidence).items():
            squares.setdefault(name, []).append(error[np.isfinite(error)] ** 2)
    return {name: float(np.sqrt(np.mean(np.concatenate(parts)))) for name, parts in squares.items()}
