"""What the named effects leave: how much above the noise, what it depends on, and what of it the plant can carry.

Named effects may stand in for one of no name. A drag with the square of the velocity looks like another viscous
friction, another Coulomb level and a Stribeck curve together; friction that sets in at a time looks like a little of
anything. One tabulated term in the declared plant is held against all named effects together on the judged data. Does
it do as well as two or more of them, that is reported. Does it do better, the named ones that do not pay beside it are
dropped: a name is worse than none where it is wrong. A table over the variable of a law is that law drawn point by
point, and nothing else than it: it denies no name that takes most of what it takes, but is carried beside it for the
form that the law misses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.judging.judge import Judged, channel_results, judged_residual
from feeddrive.diagnosis.judging.result import ChannelResult
from feeddrive.diagnosis.judging.where_fitted import where_fitted
from feeddrive.diagnosis.likelihood.cross_validation import LEAST_GAIN, compare_left_out, least_gain, left_out_residual
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.folds import block_numbers
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.standing import regained
from feeddrive.diagnosis.unexplained.analysis import Analysis
from feeddrive.diagnosis.unexplained.carry import analyses_of, forms_of, joint_step, judged_with, tried, with_carried
from feeddrive.diagnosis.unexplained.unexplained_result import Carried, Instead, Unexplained, rest_in_words
from feeddrive.diagnosis.unexplained.view import above_noise, views_of
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.tabulated import Tabulated, TabulatedTravel

EVENT = 0.1
"""Share of the squared residual from which something that happened once is reported, though the judged data lack it."""

FEWEST = 2
"""Named effects from which a table that does as well is reported."""

CURVES = {
    ("tabulated_force", "position"): ("position_spring",),
    ("tabulated_force", "velocity"): ("stribeck", "viscous_asymmetry", "coulomb_asymmetry"),
    ("tabulated_friction", "position"): ("friction_vs_position",),
    ("tabulated_friction", "periodic_position"): ("ball_pass_ripple",),
    ("tabulated_friction", "time"): ("viscous_warmup",),
    ("tabulated_torque", "periodic_angle"): ("torque_ripple",),
    ("tabulated_torque", "speed"): ("stribeck", "viscous_asymmetry", "coulomb_asymmetry"),
    ("tabulated_travel", "position"): ("lead_error_cumulative",),
    ("tabulated_travel", "periodic_position"): ("lead_error_periodic",),
    ("tabulated_travel", "time"): ("thermal_growth",),
}
"""Tables by what they give and over what, and the laws that are such a curve."""

ITERATIONS = 4
"""Steps of a fit of what is kept beside a table."""


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
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channels: Sequence[ChannelResult],
    tables: Mapping[str, Sequence[Effect]] | None = None,
) -> Rest:  # fmt: skip
    """Say what is left of every channel, and carry what pays.

    Args:
        problem: the fitted recordings.
        effects: named ones that were found.
        judged: recordings that were not fitted.
        channels: errors with the named effects.
        tables: name of a law of another form to its curve, which is carried in any case.
    """
    begun = _begun(problem, judged, tables or {})
    names_alone = problem, with_carried(judged, *(one.effect for one in begun))
    problem = replace(problem, evidence=tuple(e.with_map(False) for e in problem.evidence))
    judged = [replace(j, evidence=j.evidence.with_map(False)) for j in judged]
    first = analyses_of(problem, effects, judged, channels)
    carried = begun
    reasons: dict[str, list[str]] = {channel.name: [] for channel in channels}
    for channel in _torque_first(channels):
        analysis = first[channel.name]
        if carried:
            own = [one.effect for one in carried]
            again = analyses_of(problem, (*effects, *own), with_carried(judged, *own), [channel])
            analysis = again[channel.name]
        for found, seen in zip(analysis.found, analysis.dependences, strict=True):
            if channel.after.rms < LEVEL * channel.noise_rms:
                reasons[channel.name].append(f"{seen.words}: not carried: less is left than the noise of the sensor")
                continue
            if problem.budget.skips("tables of what no name explains", f"{channel.name} over {found.term.variable}"):
                reasons[channel.name].append(f"{seen.words}: not carried: there was no time to try")
                continue
            table = tried(problem, effects, judged, carried, forms_of(found, first.values()), channel)
            if isinstance(table, Carried):
                carried.append(table)
            else:
                reasons[channel.name].append(f"{seen.words}: {table}")
    if len(carried) > 1:
        carried = _together(problem, effects, judged, carried)
    asked = len(effects) >= FEWEST and not problem.budget.skips("a table in place of the names")
    other = table_against(names_alone[0], effects, names_alone[1], channels) if asked else None
    left = {}
    for c in channels:
        instead = other if other is not None and other.as_good and other.carried.channel == c.name else None
        left[c.name] = _unexplained(c, first[c.name], carried, reasons[c.name], instead)
    own = [one.effect for one in carried]
    return Rest(left, tuple(own), tuple(with_carried(judged, *own)))


def _begun(problem: Problem, judged: Sequence[Judged], tables: Mapping[str, Sequence[Effect]]) -> list[Carried]:
    """Curves of laws, one beside the other."""
    carried: list[Carried] = []
    for law, table in [(law, table) for law, own in tables.items() for table in own]:
        if isinstance(table, Tabulated):
            channel = "table_position" if isinstance(table, TabulatedTravel) else "motor_torque"
            beside = with_carried(judged, *(one.effect for one in carried))
            carried.append(replace(judged_with(problem, beside, table, channel), curve_of=law))
    return carried


def _torque_first(channels: Sequence[ChannelResult]) -> list[ChannelResult]:
    return sorted(channels, key=lambda one: one.name != "motor_torque")


def _together(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], carried: list[Carried]
) -> list[Carried]:
    """Several tables fitted together, since each was found while the others were not there."""
    tables, _ = joint_step(problem, effects, [one.effect for one in carried])
    result = []
    for place, one in enumerate(carried):
        others = [*tables[:place], *tables[place + 1 :]]
        there = judged_with(problem, with_carried(judged, *others), tables[place], one.channel)
        result.append(replace(there, curve_of=one.curve_of))
    return result if all(one.pays for one in result) else carried


def _unexplained(
    channel: ChannelResult, analysis: Analysis, carried: Sequence[Carried], reasons: Sequence[str],
    other: Instead | None,
) -> Unexplained:  # fmt: skip
    measured = channel.after.rms / channel.after.relative if channel.after.relative > 0 else float("inf")
    above = analysis.above
    assert above is not None
    # an event of the fitted recording need not come again in another one
    kept = tuple(
        one
        for one in analysis.dependences
        if one.confirmed or (one.variable == "time" and one.share > EVENT and not one.alike)
    )
    lost = tuple(one for one in analysis.dependences if one not in kept)
    last = carried[-1].after[channel.name] if carried else None
    result = Unexplained(
        share=max(above.rms**2 - above.floor**2, 0.0) / measured**2,
        depends_on=kept,
        above=above,
        carried=tuple(one for one in carried if one.channel == channel.name),
        not_carried=tuple(reasons),
        share_after=max(last**2 - above.floor**2, 0.0) / measured**2 if last is not None else None,
        instead=other,
    )
    return replace(result, statement=rest_in_words(channel.unit, result, lost, last))


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
    if found.problem.budget.skips("a table in place of the names"):
        return found
    rival = table_against(found.problem, effects, judged, channel_results(found.problem, judged))
    if rival is None or not rival.better:
        return found
    table = rival.carried.effect
    its_own = CURVES.get((table.name, table.place), ()) if rival.mostly else ()
    # a table over position says a lead map as well: names are to pay beside all that it says
    counting = replace(found.problem, evidence=tuple(e.with_map(False) for e in found.problem.evidence))
    kept = _needed_beside(counting, effects, table, its_own)
    if len(kept) == len(effects):
        return found
    reason = (
        f"beside a table over {table.place.replace('_', ' ')}, which predicts data not fitted better, it does not pay"
    )
    names = {effect.name for effect in effects} - {effect.name for effect in kept}
    problem = regained(found.problem, kept)
    return replace(
        found,
        problem=problem,
        fit=fit(problem, kept, iterations=0),
        denied={**found.denied, **dict.fromkeys(names, reason)},
    )


def table_against(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], channels: Sequence[ChannelResult]
) -> Instead | None:
    """The best single table in the declared plant, against the named effects; None where there is none."""
    if not problem.predictor.of_motion or any(effect.name not in EFFECTS for effect in effects):
        return None
    bare = [replace(j, after=j.before) for j in judged]
    analyses = analyses_of(problem, (), bare, channels)
    for channel in _torque_first(channels):
        for found in analyses[channel.name].found[:1]:
            table = tried(problem, (), bare, (), forms_of(found, analyses.values()), channel)
            if isinstance(table, Carried):
                judged = _where_laws_were_fitted(problem, effects, judged, table.effect)
                if not judged:
                    return None
                having = with_carried([replace(j, after=j.before) for j in judged], table.effect)
                by_names, blocks = judged_residual(problem, [(j.after, j.evidence) for j in judged])
                by_table, _ = judged_residual(problem, [(j.after, j.evidence) for j in having])
                # each way round: the chance part of a gain is taken at the better one
                names_gain = compare_left_out(by_table, by_names, blocks)
                as_good = names_gain.gain < max(LEAST_GAIN, 2 * names_gain.standard_error)
                better = compare_left_out(by_names, by_table, blocks).pays
                declared, _ = judged_residual(problem, [(j.before, j.evidence) for j in judged])
                squares = [float(one @ one) for one in (declared, by_names, by_table)]
                # what another form takes beyond a law is less than what the law takes
                mostly = squares[0] - squares[1] > squares[1] - squares[2]
                return Instead(table, tuple(effect.name for effect in effects), as_good, better, mostly)
    return None


def _where_laws_were_fitted(
    problem: Problem, effects: Sequence[Effect], judged: Sequence[Judged], table: Tabulated
) -> Sequence[Judged]:
    """The judged samples that laws and the table over their variable are held against each other on.

    Beyond what was fitted the law is a guess and the table goes on level: what either misses there tells of neither.
    """
    for law in effects:
        if law.name in CURVES.get((table.name, table.place), ()):
            judged = where_fitted(problem, effects, judged, law)
    return judged


def _is_left(problem: Problem, judged: Sequence[Judged]) -> bool:
    """Whether any channel stands above the noise with what was found."""
    plants = [(j.after, j.evidence) for j in judged]
    names = list(dict.fromkeys(name for j in judged for name in j.evidence.channels))
    return any(above_noise(views).is_left for views in views_of(problem, plants, names, True).values())


def _needed_beside(
    problem: Problem, effects: Sequence[Effect], table: Tabulated, its_own: Sequence[str]
) -> tuple[Effect, ...]:
    """The named effects that still pay beside a table, all fitted together, or whose curve the table is."""
    if all(effect.name in its_own for effect in effects):
        return tuple(effects)
    kept = fit(problem, (*effects, table), iterations=ITERATIONS)
    blocks, place = block_numbers(problem), 0
    while place < len(kept.effects) - 1:
        if kept.effects[place].name in its_own:
            place += 1
            continue
        rest = fit(problem, kept.effects[:place] + kept.effects[place + 1 :], iterations=ITERATIONS)
        without = left_out_residual(problem, rest, blocks)
        having = left_out_residual(problem, kept, blocks)
        if compare_left_out(without, having, blocks, least_gain(problem, without, having)).pays:
            place += 1
        else:
            kept = rest
    return kept.effects[:-1]
