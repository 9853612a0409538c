"""What the named effects leave: how much above the noise, what it depends on, and what of it the plant can carry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.judging.judge import Judged
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.unexplained.analysis import Analysis
from feeddrive.diagnosis.unexplained.carry import Judgement, carried_result, joint_step, judged_with, with_carried
from feeddrive.diagnosis.unexplained.instead import instead_of
from feeddrive.diagnosis.unexplained.trial import analyses_of, finer_forms, tried
from feeddrive.diagnosis.unexplained.unexplained_result import Above, Dependence, Instead, Unexplained
from feeddrive.diagnosis.unexplained.unexplained_words import rest_in_words, term_in_words
from feeddrive.effects.base import Effect
from feeddrive.effects.tabulated import Tabulated

EVENT = 0.1
"""Share of the squared residual from which something that happened once is reported, though the judged data lack it."""


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
    first = analyses_of(problem, effects, judged, channels)
    carried: list[tuple[str, Judgement]] = []
    reasons: dict[str, list[str]] = {channel.name: [] for channel in channels}
    for channel in sorted(channels, key=lambda one: one.name != "motor_torque"):
        own = [judgement.effect for _, judgement in carried]
        now = with_carried(judged, *own)
        analyses = analyses_of(problem, (*effects, *own), now, [channel]) if own else first
        analysis = analyses[channel.name]
        for found, seen in zip(analysis.found, analysis.dependences, strict=True):
            forms = [found, *finer_forms(found, first)]
            judgement = tried(problem, effects, judged, carried, forms, channel)
            if isinstance(judgement, Judgement):
                carried.append((channel.name, judgement))
            else:
                reasons[channel.name].append(f"{term_in_words(seen)}: {judgement}")
    carried = _together(problem, effects, judged, carried)
    own = [judgement.effect for _, judgement in carried]
    after = with_carried(judged, *own)
    other = instead_of(problem, effects, judged, channels)
    by_channel = {
        c.name: _unexplained(
            c, first[c.name], carried, reasons[c.name], other if other and other.channel == c.name else None
        )
        for c in channels
    }
    return Rest(by_channel, tuple(own), tuple(after))


def _together(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], carried: list[tuple[str, Judgement]]
) -> list[tuple[str, Judgement]]:
    """Several tables fitted together, since each was found while the others were not there."""
    if len(carried) < 2:
        return carried
    tables, _ = joint_step(problem, effects, [judgement.effect for _, judgement in carried])
    result = []
    for place, (channel, _) in enumerate(carried):
        others = [*tables[:place], *tables[place + 1 :]]
        result.append((channel, judged_with(problem, with_carried(judged, *others), tables[place])))
    return result if all(judgement.pays for _, judgement in result) else carried


def _happened(one: Dependence) -> bool:
    """Whether a term is an event of the fitted recording, which need not come again in another one."""
    return one.variable == "time" and one.share > EVENT and not one.alike


def _unexplained(
    channel: ChannelResult, analysis: Analysis, carried: Sequence[tuple[str, Judgement]], reasons: Sequence[str],
    other: Instead | None,
) -> Unexplained:  # fmt: skip
    measured = channel.after.rms / channel.after.relative if channel.after.relative > 0 else float("inf")
    seen = analysis.above
    assert seen is not None
    above = Above(seen.share, seen.standard_error, seen.rms, seen.floor, seen.is_left)
    kept = tuple(one for one in analysis.dependences if one.confirmed or _happened(one))
    lost = tuple(one for one in analysis.dependences if one not in kept)
    mine = tuple(carried_result(judgement) for name, judgement in carried if name == channel.name)
    last = carried[-1][1].after[channel.name] if carried else None
    share_after = max(last**2 - seen.floor**2, 0.0) / measured**2 if last is not None else None
    result = Unexplained(
        max(seen.rms**2 - seen.floor**2, 0.0) / measured**2, kept, above, "", mine, tuple(reasons), share_after, other
    )
    return replace(result, statement=rest_in_words(channel, result, lost, last))
