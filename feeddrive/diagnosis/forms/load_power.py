"""Friction that goes with another power of the load than the first, begun from the one that does.

    level = Tc + c |F| (|F| / F0)^b r    (`effects.friction.load_dependent_friction`)

What a power leaves beside the first is a function of the force, which no channel records: neither a further name nor a
table over what is recorded takes it. Declared values may take it on the fitted recording, and one of other loads then
has four times its noise left. So the power is asked for wherever this friction is found, F0 being the rms of the force
that was met, so that c stays what it is there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.begun_anew import begun_anew, likeliest
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing
from feeddrive.effects.base import Effect, number
from feeddrive.effects.friction.load_dependent_friction import LoadDependentFriction

BEGUN = (1 / 3, -1 / 3)
"""Powers beyond the first that fits begin with: rolling contacts, and a friction that the load saturates."""


def with_power_of_load(here: Standing, count: int) -> Standing | None:
    """A likelier set whose friction goes with another power of the load; None where none is.

    Args:
        here: a set.
        count: candidates and starts that were tried.
    """
    problem, found = here.problem, here.fit
    places = [i for i, e in enumerate(found.effects) if isinstance(e, LoadDependentFriction) and not _is_bent(e)]
    if not places or problem.budget.skips("powers of the load"):
        return None
    (place,), force = places, _force_met(problem, found.effects)
    if not force > 0:
        return None
    law = found.effects[place]
    bent = (law.with_values(bend=bend, at_force=force) for bend in BEGUN)
    return likeliest(here, (begun_anew(problem, found.effects, place, one) for one in bent), count)


def _is_bent(law: Effect) -> bool:
    return number(law.values["bend"]) != 0


def _force_met(problem: Problem, effects: Sequence[Effect]) -> float:
    """Rms of the force of the nut at the fitted rows of all recordings [N]; of three digits, as it is a name's part."""
    runs = scene_of(problem, effects).runs
    forces = np.concatenate([run.force[e.fit_rows] for run, e in zip(runs, problem.evidence, strict=True)])
    return float(f"{float(np.sqrt(np.mean(forces**2))):.3g}")
