"""Effects that say the same of these recordings by their laws alone, whatever the noise: named without a trial.

    drive_delay d = channel_delay d of motor_angle               where no table position is recorded
    payload m = inertia_deviation m r^2, at motor or screw       in a rigid structure that moves level
    constant_force F = channel_offset F r of the torque          where nothing is declared to hang or pull
    lead_error_cumulative s = channel_gain 1 + s of the scale    beyond what any class of screw misses
    stiffness_deviation a < 1 = preload_loss a, F1               where no force beyond F1 passes the nut

Without a table position the motor angle is compared with the torque alone, and a torque that acts later than recorded
is an angle that is recorded late. The drive is named, since every drive acts late, and the angle is listed with it. In
a rigid structure one mass moves, (J_m + J_s) / r^2 + m; the mass on the table is named, as it is what people change.

| symbol | meaning | unit |
|---|---|---|
| r | table travel per motor angle | m/rad |
| a, F1 | stiffness over the declared one, and the force up to which a nut that has lost its preload is soft | 1, N |
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.suspicion.quality import read_otherwise
from feeddrive.effects.base import Effect, number
from feeddrive.effects.chain.stiffness_deviation import WHOLE, StiffnessDeviation
from feeddrive.effects.source.weight import Weight
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.plant import Plant
from feeddrive.units.quantity import format_quantity


@dataclass(frozen=True)
class Twin:
    """Another effect that says the same: its name, and why the recordings cannot tell."""

    name: str
    reason: str


def twins_of(effect: Effect, plant: Plant, evidence: Sequence[Evidence]) -> tuple[Twin, ...]:
    """The effects that say the same as one that was found; none for most.

    Args:
        effect: found.
        plant: as declared.
        evidence: recordings.
    """
    if effect.name == "drive_delay" and not any("table_position" in e.channels for e in evidence):
        reason = "without a table position a torque that acts late is a motor angle that is recorded late"
        return (Twin("channel_delay", f"{reason}; record the table position to tell them apart"),)
    if effect.name == "payload" and not plant.chain.elastic and not plant.effects_of(Weight):
        reason = "in a rigid structure an inertia of motor or screw is a mass on the table"
        mend = 'use structure = "three_inertias" and record the table position to tell them apart'
        return (Twin("inertia_deviation", f"{reason}; {mend}"),)
    has_torque = any("motor_torque" in e.channels for e in evidence)
    return tuple(
        Twin(one.kind, f"{one.sentence}; {one.mend}")
        for one in read_otherwise([effect], plant, has_torque)
        if one.alternatives and one.kind != effect.name and effect.name != "drive_delay"
    )


def softer_while_seen(effect: Effect, problem: Problem, effects: Sequence[Effect]) -> tuple[Twin, ...]:
    """The lost preload that says the same as a softer axis or nut, with the force beyond which none was seen.

    Args:
        effect: found.
        problem: declared plant and recordings.
        effects: all that were found.
    """
    asked = {candidate.name for candidate in problem.predictor.candidates}
    if (
        not isinstance(effect, StiffnessDeviation)
        or effect.place not in (WHOLE, "nut")
        or number(effect.values["factor"]) >= 1
        or PreloadLoss.name not in asked
        or any(one.name == PreloadLoss.name for one in effects)
    ):
        return ()
    greatest = max((float(np.max(np.abs(run.force))) for run in scene_of(problem, effects).runs), default=0.0)
    seen = f"no force beyond {format_quantity(greatest, 'N')} passed the nut in these recordings"
    reason = f"{seen}: a nut that has lost its preload is as soft up to some force, and as stiff as declared beyond it"
    return (Twin(PreloadLoss.name, f"{reason}; greater forces tell them apart"),)
