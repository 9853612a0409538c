"""A term that was found, tried as an effect of the plant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.unexplained.analysis import Analysis, analyse
from feeddrive.diagnosis.unexplained.carry import (
    DEAR,
    Judgement,
    effects_of,
    fitted_step,
    judged_with,
    resampled,
    with_carried,
)
from feeddrive.diagnosis.unexplained.functional_anova import Found
from feeddrive.diagnosis.unexplained.term import Form
from feeddrive.diagnosis.unexplained.unexplained_words import no_effect, no_gain
from feeddrive.diagnosis.unexplained.view import views_of
from feeddrive.effects.base import Effect
from feeddrive.errors import InputError


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
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], carried: Sequence[tuple[str, Judgement]],
    forms: Sequence[Found], channel: ChannelResult,
) -> Judgement | str:  # fmt: skip
    """The term as an effect that pays on the judged data, or why there is none."""
    if not problem.predictor.of_motion:
        return no_effect()
    before = [*effects, *(judgement.effect for _, judgement in carried)]
    options = []
    try:
        for start in [one for form in forms for one in effects_of(form, channel.name, channel.unit, problem.plant)]:
            fitted, error = fitted_step(problem, before, start)
            options.append((fitted, error + DEAR * len(fitted.breakpoints)))
    except InputError as wrong:  # nothing there to act on, as friction that is not declared, or beyond what is physical
        return f"not carried: {wrong.what}"
    if not options:
        return no_effect()
    best, _ = min(options, key=lambda option: option[1])
    judgement = judged_with(problem, with_carried(judged, *(j.effect for _, j in carried)), best)
    return judgement if judgement.pays else no_gain(judgement.explains)


def finer_forms(found: Found, analyses: Mapping[str, Analysis]) -> list[Found]:
    """The found term with the breakpoints that another channel shows, where these are more."""
    if found.term.form is not Form.CURVE:
        return []
    others = [one for analysis in analyses.values() for one in analysis.found]
    alike = [
        o
        for o in others
        if (o.term.form, o.term.variable, o.term.times) == (Form.CURVE, found.term.variable, found.term.times)
    ]
    return [resampled(found, other) for other in alike if other.term.size > found.term.size]
