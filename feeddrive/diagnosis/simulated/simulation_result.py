"""What closed-loop simulation says of a diagnosis: errors of the loop, and what was refined in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from feeddrive.effects.base import Value


@dataclass(frozen=True)
class ErrorFigure:
    """Rms of an error [unit of the channel], and relative to what the channel shows."""

    rms: float
    relative: float


@dataclass(frozen=True)
class SimulatedChannel:
    """Closed-loop simulation error of one channel: rms in its SI unit, and relative (see `diagnose.simulation`).

    Attributes:
        name: of the channel.
        unit: SI unit of the rms.
        before: with the declared plant.
        after: with all that is reported, tables of what no name explains too.
        after_attribution: with the effects found and the values of the attribution.
        after_refinement: with the values refined in simulation, kept or not; None where nothing was refined.
    """

    name: str
    unit: str
    before: ErrorFigure
    after: ErrorFigure
    after_attribution: ErrorFigure
    after_refinement: ErrorFigure | None = None


@dataclass(frozen=True)
class RefinedValue:
    """A value of an effect before and after it was refined in closed-loop simulation, in its SI unit."""

    effect: str
    key: str
    unit: str
    before: Value
    after: Value


@dataclass(frozen=True)
class SimulationResult:
    """Closed-loop simulation error where the controller is declared: relative, unfiltered, over the judged samples.

    Attributes:
        channel: that the first figures are of.
        before: with the declared plant.
        after: with all that is reported, tables of what no name explains too.
        after_attribution: with the values of the attribution; None where it is not known.
        after_refinement: with the refined values, kept or not; None where nothing was refined.
        kept: whether the refined values are those that are reported.
        statement: what was refined and whether it was kept, and why.
        channels: every simulated channel.
        refined: values that the refinement changed, kept or not.
        not_refined: effect to the reason why (some of) its values stayed.
    """

    channel: str
    before: float
    after: float
    after_attribution: float | None = None
    after_refinement: float | None = None
    kept: bool = False
    statement: str = ""
    channels: tuple[SimulatedChannel, ...] = ()
    refined: tuple[RefinedValue, ...] = ()
    not_refined: Mapping[str, str] = field(default_factory=dict)
