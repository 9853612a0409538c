"""What may be other from one recording to the next: every fitted parameter, and levels that change by themselves.

Levels are tried whether an effect was found there or not: friction at each port (wear, lubricant, temperature), a force
(another load or balance), a mass (another workpiece), the screw's lead (its temperature) and its stiffness (preload).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from feeddrive.diagnosis.friction_at_port import declared_level, declared_viscous
from feeddrive.diagnosis.likelihood.coordinates import coordinates_of
from feeddrive.diagnosis.likelihood.fit import Problem
from feeddrive.diagnosis.recordings.recordings import RecordingShift, Target, is_shift, shift_of, target_of
from feeddrive.effects.base import Effect
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.friction.friction_deviation import FrictionDeviation
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.travel.lead_error_cumulative import LeadErrorCumulative

UNCHANGING = ("order",)
"""Parameters that no wear and no temperature changes."""


@dataclass(frozen=True)
class Movable:
    """One coordinate of one effect, that may be other in some recordings.

    Attributes:
        target: the effect and its coordinate.
        parameter: what the coordinate stands for, in words.
        effect: number of the effect in the list.
        columns: of the coordinate in the Jacobian of the list.
    """

    target: Target
    parameter: str
    effect: int
    columns: tuple[int, ...]

    def shifts(self, recordings: Sequence[int]) -> tuple[RecordingShift, ...]:
        """Shifts of nothing yet, one per recording."""
        return tuple(shift_of(self.target, number, len(self.columns)) for number in recordings)


def levels(problem: Problem, effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """Neutral effects for the levels that no effect of the list holds yet; none where temperatures are predicted."""
    plant = problem.plant
    if not problem.predictor.of_motion:
        return ()
    ports = [p for p in FrictionDeviation.ports if declared_level(plant, p) or declared_viscous(plant, p)]
    neutral: list[Effect] = [FrictionDeviation.of(port) for port in ports]
    neutral += [ConstantForce.of(force=0.0), Payload.of(mass=0.0)]
    if all("table_position" in evidence.channels for evidence in problem.evidence):
        neutral.append(LeadErrorCumulative.of(slope=0.0))
        if plant.chain.elastic:
            neutral.append(StiffnessDeviation.of(factor=1.0))
    present = {(effect.name, effect.port) for effect in effects}
    # the plant may hold one that cannot act twice
    present |= {(effect.name, effect.port) for effect in plant.effects if not effect.additive}
    return tuple(effect for effect in neutral if (effect.name, effect.port) not in present)


def movables(effects: Sequence[Effect], problem: Problem) -> tuple[Movable, ...]:
    """Every coordinate of the list that may change; shifts themselves are passed over."""
    result, at = [], 0
    for number, effect in enumerate(effects):
        for index, coordinate in enumerate(coordinates_of(effect, problem.plant)):
            count = len(coordinate.read(effect))
            parameter = str(getattr(coordinate, "key", "amplitude and phase"))
            if parameter not in UNCHANGING and not is_shift(effect):
                columns = tuple(range(at, at + count))
                result.append(Movable(target_of(effect, index), parameter, number, columns))
            at += count
    return tuple(result)
