"""Terms of no known name carried in the plant: as which effect, with which values, and whether that pays.

A term of the torque becomes a force, a friction or a torque; the table of the residual gives the first values, one
linear step on all channels the final ones. It is carried when it lowers the error on the judged data by as much as is
asked of a named effect.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.certainty.uncertainty import score_variances
from feeddrive.diagnosis.judging.judge import Judged, error_series, judged_residual
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates, write_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import compare_left_out
from feeddrive.diagnosis.likelihood.fit import linear_step
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

DIGITS = 4
"""Digits that a table is written with, of its largest value and of its shortest distance between breakpoints: far less
than what is known of it."""

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
    shown = rounded(values, float(np.abs(values).max()))
    given = {word: tuple(rounded(at, _shortest(at))), key or kind.value_keys[0]: tuple(shown)}
    return kind.of(port, place, **given, **({"period": period} if period else {}))


def joint_step(
    problem: Problem, before: Sequence[Effect], tables: Sequence[Tabulated]
) -> tuple[list[Tabulated], float]:
    """Tables after one linear step on all channels, and the squared error; as they are where it does not help.

        |r - J d|^2 / c + |d|^2 / s^2  least

    d is the step from the values y0 that the residual of one channel gave, r and J residual and slopes there, s the rms
    of a table's y0, and c the variance that the residual's colour leaves along a slope, over that of white noise. What
    the channels hardly see of a table, a breakpoint or several that cancel, moves by no more than the table is large.
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
    values = [read_coordinates([table], problem.plant) for table in tables]
    size = np.concatenate([np.full(len(one), np.sqrt(np.mean(one**2))) for one in values])
    seen = np.linalg.norm(jacobian, axis=0)
    left = np.sqrt(score_variances(problem, residual, jacobian)) / np.where(seen > 0, seen, 1.0)
    prior = np.where(seen > 0, left, 1.0) / np.where(size > 0, size, 1.0)
    step = linear_step(np.vstack([jacobian, np.diag(prior)]), np.concatenate([residual, np.zeros(len(prior))]))
    there = write_coordinates(tables, problem.plant, np.concatenate(values) + step)
    moved = [_rounded(one) for one in there if isinstance(one, Tabulated)]
    after = problem.residual((*before, *moved))
    error = float(after @ after)
    return (moved, error) if error < here else (list(tables), here)


def rounded(values: FloatArray, largest: float) -> list[float]:
    """Values, (n,), rounded to `DIGITS` of the largest one: a table is read by people; as they are where that is 0."""
    if not 0 < largest < np.inf:
        return [float(one) for one in values]
    places = DIGITS - 1 - math.floor(math.log10(largest))
    return [round(float(one), places) for one in values]


def _rounded(table: Tabulated) -> Tabulated:
    """A table with its values rounded as they are written."""
    lists = {key: np.array(table.table(key)) for key in table.tables}
    return table.with_values(**{key: tuple(rounded(one, float(np.abs(one).max()))) for key, one in lists.items()})


def _shortest(at: FloatArray) -> float:
    """Shortest distance between breakpoints; 0 where there is one."""
    return float(np.min(np.diff(at), initial=np.inf)) if len(at) > 1 else 0.0


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
