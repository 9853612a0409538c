"""The set that a search ends with: at rest, all that is left counting, without what is too small to matter."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.diagnosis.calibration.stated import without_effects
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.materiality import is_material_here
from feeddrive.diagnosis.finding.members import rest_of
from feeddrive.diagnosis.finding.open_map import with_curves_of
from feeddrive.diagnosis.finding.refitting import at_rest, in_steps_told, refitted, where_friction_brakes
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import LEVEL, Problem
from feeddrive.diagnosis.likelihood.set_evidence import LEVEL_KNOWN, Standing
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.effects.base import Effect


def ended(problem: Problem, found: Fit) -> tuple[tuple[Problem, Fit] | None, Problem, Fit, list[Effect]]:
    """The set that is left at the end, all that is left counting again; and effects too small to be reported.

    Before it the set beside the curves of its laws, where any is open.

    One that is small on this machine is reported where the error of a channel shows it: a fine scale sees a part that
    shakes which is a ten-thousandth of the table.
    """
    there = in_steps_told(*refitted(problem, fit(problem, found.effects)))
    problem, found = where_friction_brakes(*at_rest(*there))
    closed = with_curves_of(problem, ())  # names are weighed, and rivals tried, against all that is left
    opened = None if closed is problem else (problem, found)
    if closed is not problem:
        problem, found = closed, fit(closed, found.effects, iterations=JOINT_ITERATIONS)
    small = [one for one in found.effects if not is_material_here(one, problem)]
    if small:
        rest = rest_of(found.effects, small)
        fewer = without_effects(problem, small, rest)
        without = fit(fewer, rest)
        if not _is_seen(Standing(fewer, without), Standing(problem, found)):
            return None, fewer, without, small
    return opened, problem, found, []


def _is_seen(without: Standing, found: Standing) -> bool:
    """Whether the square left of a channel is lower with a set than without some of it, by more than it is known to.

    What rows do not tell counts here, since the error that is told holds it. Nothing is seen where less than the noise
    is left without the set: what a recording without noise holds is then a share of what the simulation misses.
    """
    for e, before, after in zip(found.problem.evidence, _squares(without), _squares(found), strict=True):
        for name, square in after.items():
            if before[name] > LEVEL**2 * e.kept and square < (1 - LEVEL_KNOWN) * before[name]:
                return True
    return False


def _squares(one: Standing) -> list[dict[str, float]]:
    """Per recording, channel to the mean square of its error over the noise, what rows do not tell included."""
    whole = [replace(e, between_rows=()) if isinstance(e, AxisEvidence) else e for e in one.problem.evidence]
    settled = one.problem.settled(one.fit.effects)
    return replace(settled, evidence=tuple(whole)).plain_squares(one.fit.effects)
