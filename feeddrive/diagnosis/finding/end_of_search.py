"""The set that a search ends with: at rest, all that is left counting, without what is too small to matter."""

from __future__ import annotations

from feeddrive.diagnosis.calibration.stated import without_effects
from feeddrive.diagnosis.finding.attempt import JOINT_ITERATIONS
from feeddrive.diagnosis.finding.materiality import is_material_here
from feeddrive.diagnosis.finding.members import rest_of
from feeddrive.diagnosis.finding.refitting import at_rest, in_steps_told, refitted, where_friction_brakes
from feeddrive.diagnosis.finding.too_small import is_seen
from feeddrive.diagnosis.forms.open_map import with_curves_of
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing
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
        if not is_seen(Standing(fewer, without), Standing(problem, found)):
            return None, fewer, without, small
    return opened, problem, found, []
