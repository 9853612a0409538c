"""What the named effects leave: how much above the noise, what it depends on, and what of it the plant can carry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnose.fit import Problem
from feeddrive.diagnose.functional_anova import Found
from feeddrive.diagnose.judge import Judged
from feeddrive.diagnose.result import ChannelResult
from feeddrive.diagnose.unexplained_analysis import Analysis, analyse
from feeddrive.diagnose.unexplained_carry import (
    DEAR,
    Judgement,
    carried_result,
    effects_of,
    fitted_step,
    judged_with,
    resampled,
    with_carried,
)
from feeddrive.diagnose.unexplained_result import Above, Dependence, Unexplained
from feeddrive.diagnose.unexplained_term import Form
from feeddrive.diagnose.unexplained_view import views_of
from feeddrive.diagnose.unexplained_words import no_effect, no_gain, rest_in_words, term_in_words
from feeddrive.effects.base import Effect
from feeddrive.effects.tabulated import Tabulated
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant


@dataclass(frozen=True)
class Rest:
    """What the named effects leave.

    Attributes:
        unexplained: per channel.
        effects: tabulated terms that the plant carries for it.
        judged: the judged recordings with these in the plant after.
    """

    unexplained: dict[str, Unexplained]
    effects: tuple[Tabulated, ...]
    judged: tuple[Judged, ...]


def explain_rest(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channels: Sequence[ChannelResult]
) -> Rest:
    """Say what is left of every channel, and carry what pays.

    Args:
        problem: the fitted recordings.
        effects: named ones that were found.
        judged: recordings that were not fitted.
        channels: errors with the named effects.
    """
    first = {channel.name: _analysis(problem, effects, judged, channel) for channel in channels}
    carried: list[tuple[str, Judgement]] = []
    reasons: dict[str, list[str]] = {channel.name: [] for channel in channels}
    for channel in sorted(channels, key=lambda one: one.name != "motor_torque"):
        own = [judgement.effect for _, judgement in carried]
        now = with_carried(judged, *own)
        analysis = _analysis(problem, (*effects, *own), now, channel) if own else first[channel.name]
        for found, seen in zip(analysis.found, analysis.dependences, strict=True):
            forms = [found, *_finer(found, first)]
            judgement = _tried(problem, effects, judged, carried, forms, channel)
            if isinstance(judgement, Judgement):
                carried.append((channel.name, judgement))
            else:
                reasons[channel.name].append(f"{term_in_words(seen)}: {judgement}")
    own = [judgement.effect for _, judgement in carried]
    after = with_carried(judged, *own)
    said = {c.name: _said(c, first[c.name], carried, reasons[c.name]) for c in channels}
    return Rest(said, tuple(own), tuple(after))


def _analysis(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channel: ChannelResult
) -> Analysis:
    plant = problem.plant.with_effects(*effects)
    fitted = views_of(problem, [(plant, evidence) for evidence in problem.evidence], channel.name, False)
    seen = views_of(problem, [(j.after, j.evidence) for j in judged], channel.name, True)
    radius = plant.chain.motor_radius if isinstance(plant, Plant) else 0.0
    return analyse(fitted, seen, channel.unit, radius)


def _tried(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], carried: Sequence[tuple[str, Judgement]],
    forms: Sequence[Found], channel: ChannelResult,
) -> Judgement | str:  # fmt: skip
    """The term as an effect that pays on the judged data, or why there is none."""
    if not isinstance(problem.plant, Plant):
        return no_effect()
    before = [*effects, *(judgement.effect for _, judgement in carried)]
    options = []
    for start in [one for form in forms for one in effects_of(form, channel.name, channel.unit, problem.plant)]:
        try:
            fitted, error = fitted_step(problem, before, start)
        except InputError as wrong:  # nothing there to act on, as friction that is not declared
            return f"not carried: {wrong.what}"
        options.append((fitted, error + DEAR * len(fitted.breakpoints)))
    if not options:
        return no_effect()
    best, _ = min(options, key=lambda option: option[1])
    judgement = judged_with(problem, with_carried(judged, *(j.effect for _, j in carried)), best)
    return judgement if judgement.pays else no_gain(judgement.explains)


def _finer(found: Found, analyses: Mapping[str, Analysis]) -> list[Found]:
    """The same term with the breakpoints that another channel shows, where these are more."""
    if found.term.form is not Form.CURVE:
        return []
    others = [one for analysis in analyses.values() for one in analysis.found]
    alike = [
        o
        for o in others
        if (o.term.form, o.term.variable, o.term.times) == (Form.CURVE, found.term.variable, found.term.times)
    ]
    return [resampled(found, other) for other in alike if other.term.size > found.term.size]


def _said(
    channel: ChannelResult, analysis: Analysis, carried: Sequence[tuple[str, Judgement]], reasons: Sequence[str]
) -> Unexplained:
    measured = channel.after.rms / channel.after.relative if channel.after.relative > 0 else float("inf")
    seen = analysis.above
    assert seen is not None
    above = Above(seen.share, seen.standard_error, seen.rms, seen.floor, seen.is_left)
    # what time brings need not come again in another recording; the other variables must
    kept = tuple(one for one in analysis.dependences if one.confirmed or one.variable == "time")
    lost = tuple(one for one in analysis.dependences if one not in kept)
    mine = tuple(carried_result(judgement) for name, judgement in carried if name == channel.name)
    last = carried[-1][1].after[channel.name] if carried else None
    share_after = max(last**2 - seen.floor**2, 0.0) / measured**2 if last is not None else None
    result = Unexplained(
        max(seen.rms**2 - seen.floor**2, 0.0) / measured**2, kept, above, "", mine, tuple(reasons), share_after
    )
    return replace(result, statement=rest_in_words(channel, result, lost, last))


__all__ = ["Dependence", "Rest", "Unexplained", "explain_rest"]
