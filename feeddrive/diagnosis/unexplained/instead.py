"""Named effects that may stand in for one of no name: one table that does as well as all of them, or better.

A drag with the square of the velocity looks like another viscous friction, another Coulomb level and a Stribeck curve
together; friction that sets in at a time looks like a little of anything. One tabulated term in the declared plant is
held against all named effects together on the judged data. Does it do as well as two or more of them, that is reported.
Does it do better, the named ones that do not pay beside it are dropped: a name is worse than none where it is wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, channel_results, judged_residual
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.likelihood.cross_validation import (
    LEAST_GAIN,
    compare_left_out,
    least_gain,
    left_out_residual,
)
from feeddrive.diagnosis.likelihood.fit import Problem, fit
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.unexplained.carry import Judgement, carried_result, with_carried
from feeddrive.diagnosis.unexplained.floor import excess
from feeddrive.diagnosis.unexplained.trial import analyses_of, finer_forms, tried
from feeddrive.diagnosis.unexplained.unexplained_result import Instead
from feeddrive.diagnosis.unexplained.view import views_of
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.tabulated import Tabulated

FEWEST = 2
"""Named effects from which a table that does as well is reported."""

ITERATIONS = 4
"""Steps of a fit of what is kept beside a table."""


@dataclass(frozen=True)
class Rival:
    """One table in the declared plant against the named effects: whether it does as well on the judged data, or better.

    Attributes:
        channel: where it was found.
        judgement: of the table in the declared plant.
        as_good: whether the judged data do not speak for the named effects.
        better: whether they speak for the table by as much as is asked of an effect.
    """

    channel: str
    judgement: Judgement
    as_good: bool
    better: bool


def instead_of(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channels: Sequence[ChannelResult]
) -> Instead | None:
    """One table that does as well as two or more named effects, or None.

    Args:
        problem: the fitted recordings.
        effects: named ones that were found.
        judged: recordings that were not fitted.
        channels: of the recordings.
    """
    if len(effects) < FEWEST:
        return None
    rival = table_against(problem, effects, judged, channels)
    if rival is None or not rival.as_good:
        return None
    return Instead(rival.channel, carried_result(rival.judgement), tuple(effect.name for effect in effects))


def without_stand_ins(found: Search, judged: Sequence[Judged]) -> Search:
    """The search without the named effects that do not pay beside a table which beats all of them; else the same.

    Asked only where there are two named effects or more, or where they leave something above the noise.

    Args:
        found: what the search took.
        judged: recordings with the found effects in.
    """
    effects = found.fit.effects
    if not effects or (len(effects) < FEWEST and not _is_left(found.problem, judged)):
        return found
    rival = table_against(found.problem, effects, judged, channel_results(found.problem, judged))
    if rival is None or not rival.better:
        return found
    table = rival.judgement.effect
    kept = _needed_beside(found.problem, effects, table)
    if len(kept) == len(effects):
        return found
    reason = (
        f"beside a table over {table.place.replace('_', ' ')}, which predicts data not fitted better, it does not pay"
    )
    names = {effect.name for effect in effects} - {effect.name for effect in kept}
    return replace(
        found,
        fit=fit(found.problem, kept, iterations=0),
        impossible={**found.impossible, **dict.fromkeys(names, reason)},
    )


def table_against(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channels: Sequence[ChannelResult]
) -> Rival | None:
    """The best single table in the declared plant, against the named effects; None where there is none."""
    if not problem.predictor.of_motion or any(effect.name not in EFFECTS for effect in effects):
        return None
    bare = [replace(j, after=j.before) for j in judged]
    analyses = analyses_of(problem, (), bare, channels)
    for channel in sorted(channels, key=lambda one: one.name != "motor_torque"):
        for found in analyses[channel.name].found[:1]:
            forms = [found, *finer_forms(found, analyses)]
            judgement = tried(problem, (), bare, (), forms, channel)
            if isinstance(judgement, Judgement):
                return _rival(problem, judged, with_carried(bare, judgement.effect), channel.name, judgement)
    return None


def _rival(
    problem: Problem, named: Sequence[Judged], table: Sequence[Judged], channel: str, judgement: Judgement
) -> Rival:
    by_names, blocks = judged_residual(problem, [(j.after, j.evidence) for j in named])
    by_table, _ = judged_residual(problem, [(j.after, j.evidence) for j in table])
    # each way round: the chance part of a gain is taken at the better one
    names_gain = compare_left_out(by_table, by_names, blocks)
    table_gain = compare_left_out(by_names, by_table, blocks)
    as_good = names_gain.gain < max(LEAST_GAIN, 2 * names_gain.standard_error)
    return Rival(channel, judgement, as_good, table_gain.pays)


def _is_left(problem: Problem, judged: Sequence[Judged]) -> bool:
    """Whether any channel stands above the noise with what was found."""
    plants = [(j.after, j.evidence) for j in judged]
    names = list(dict.fromkeys(name for j in judged for name in j.evidence.channels))
    for name, views in views_of(problem, plants, names, True).items():
        residuals = [view.residual[view.rows] for view in views]
        about = [r - r.mean() if name in v.evidence.floating else r for r, v in zip(residuals, views, strict=True)]
        if excess(about, [view.blocks for view in views], [view.floor for view in views]).is_left:
            return True
    return False


def _needed_beside(problem: Problem, effects: Sequence[Effect], table: Tabulated) -> tuple[Effect, ...]:
    """The named effects that still pay beside a table, all fitted together."""
    kept = fit(problem, (*effects, table), iterations=ITERATIONS)
    blocks, place = block_numbers(problem), 0
    while place < len(kept.effects) - 1:
        rest = fit(problem, kept.effects[:place] + kept.effects[place + 1 :], iterations=ITERATIONS)
        without = left_out_residual(problem, rest, blocks)
        having = left_out_residual(problem, kept, blocks)
        if compare_left_out(without, having, blocks, least_gain(problem, without, having)).pays:
            place += 1
        else:
            kept = rest
    return kept.effects[:-1]
