"""What closed-loop simulation says of a diagnosis: errors of the loop, what was refined in it; keys of the record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from feeddrive.effects.base import Value


@dataclass(frozen=True)
class ErrorFigure:
    """Rms of an error [unit of the channel], and relative to what the channel shows."""

    rms: float
    relative: float

    def record(self) -> dict[str, float]:
        """Its keys in `diagnosis.json`."""
        return {"rms": self.rms, "relative": self.relative}


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

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        refined = {"after_refinement": self.after_refinement.record()} if self.after_refinement else {}
        return {
            "name": self.name, "unit": self.unit, "before": self.before.record(), "after": self.after.record(),
            "after_attribution": self.after_attribution.record(), **refined,
        }  # fmt: skip


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

    def record(self) -> dict[str, Any]:
        """The entry `simulation` of `diagnosis.json`; keys without value are left out.

        `before` and `after` are of the channel named first, `after` as it is reported.
        """
        record: dict[str, Any] = {
            "channel": self.channel, "before": self.before, "after": self.after,
            "after_attribution": self.after_attribution, "after_refinement": self.after_refinement,
            "refinement_kept": self.kept, "statement": self.statement,
            "channels": [channel.record() for channel in self.channels],
            "refined": [dict(vars(value)) for value in self.refined],
            "not_refined": [{"name": name, "reason": reason} for name, reason in self.not_refined.items()],
        }  # fmt: skip
        return {key: value for key, value in record.items() if value is not None}
