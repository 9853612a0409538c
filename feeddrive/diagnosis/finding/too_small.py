"""What is too small to be reported: of no size that matters on the machine, and of none that a channel shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.materiality import is_material_here
from feeddrive.diagnosis.finding.members import member, members_of
from feeddrive.diagnosis.likelihood.coordinates import coordinate_ends, write_coordinates
from feeddrive.diagnosis.likelihood.fit import Fit
from feeddrive.diagnosis.likelihood.problem import LEVEL, UNEXPLAINED, Problem
from feeddrive.diagnosis.likelihood.set_evidence import LEVEL_KNOWN
from feeddrive.diagnosis.likelihood.standing import Standing
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.effects.base import Effect


def too_small(at_hand: Standing, taken: Standing) -> list[Effect]:
    """Effects that a likelier set adds which the end of a search would leave out; none where one of them stays.

    Asked where little is left, as at the end: beside an effect that is missing nobody sees what a small one takes. What
    takes another's place is not asked, since without it the other is back.
    """
    before, after = (members_of(one.fit.effects) for one in (at_hand, taken))
    if not _little_is_left(at_hand.problem, at_hand.fit) or not set(before) < set(after):
        return []
    added = [one for one in taken.fit.effects if member(one) not in before]
    if any(is_material_here(one, taken.problem) for one in added) or is_seen(at_hand, taken):
        return []
    return added


def with_what_matters(problem: Problem, found: Fit, attempts: Sequence[Attempt]) -> list[Attempt]:
    """What was started beside a set, each said to matter or not by the size that its first step promises.

    One that takes half of what is asked of a channel, of all channels together, may be seen, and matters until it is
    fitted. All matter where much is left.
    """
    if not _little_is_left(problem, found):
        return [*attempts]
    channels = len({name for e in problem.evidence for name in e.channels})
    least = (1 - 0.5 * LEVEL_KNOWN / channels) * found.squared_error
    return [
        replace(one, matters=one.fit.squared_error < least or is_material_here(_as_stepped(one, problem), problem))
        for one in attempts
    ]


def is_seen(without: Standing, found: Standing) -> bool:
    """Whether the square left of a channel is lower with a set than without some of it, by more than it is known to.

    What rows do not tell counts here, since the error that is told holds it. Nothing is seen where less than the noise
    is left without the set: what a recording without noise holds is then a share of what the simulation misses.
    """
    for e, before, after in zip(found.problem.evidence, _squares(without), _squares(found), strict=True):
        for name, square in after.items():
            if before[name] > LEVEL**2 * e.kept.get(name, 1.0) and square < (1 - LEVEL_KNOWN) * before[name]:
                return True
    return False


def _squares(one: Standing) -> list[dict[str, float]]:
    """Per recording, channel to the mean square of its error over the noise, what rows do not tell included."""
    whole = [replace(e, between_rows=()) if isinstance(e, AxisEvidence) else e for e in one.problem.evidence]
    settled = one.problem.settled(one.fit.effects)
    return replace(settled, evidence=tuple(whole)).plain_squares(one.fit.effects)


def _little_is_left(problem: Problem, found: Fit) -> bool:
    return problem.plain_error(found.effects) < UNEXPLAINED


def _as_stepped(attempt: Attempt, problem: Problem) -> Effect:
    """The effect that was tried, as the last step of its fit leaves it."""
    effect = attempt.fit.effects[-1]
    low, high = coordinate_ends([effect], problem.plant)
    (there,) = write_coordinates([effect], problem.plant, np.clip(attempt.fit.coordinates[-len(low) :], low, high))
    return there
