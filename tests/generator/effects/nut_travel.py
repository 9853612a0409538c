"""Effects on the travel of the nut and on the spring between nut and table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from tests.generator.constants import Constants
from tests.generator.effects.base import Effect, require


@dataclass(frozen=True)
class Backlash(Effect):
    """Free play of total width [m] between nut and table."""

    name: ClassVar[str] = "backlash"
    size_keys: ClassVar[tuple[str, ...]] = ("width",)
    width: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(gap=self.width)


@dataclass(frozen=True)
class LeadErrorPeriodic(Effect):
    """Travel error amplitude [m] * sin(order * screw angle + phase [rad])."""

    name: ClassVar[str] = "lead_error_periodic"
    size_keys: ClassVar[tuple[str, ...]] = ("amplitude",)
    amplitude: float
    order: float
    phase: float = 0.0

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(travel_amplitude=self.amplitude, travel_order=self.order, travel_phase=self.phase)


@dataclass(frozen=True)
class LeadErrorCumulative(Effect):
    """Travel error slope [m/m] * x, counted from the screw's fixed end at 0: the unloaded x is r phi / (1 - slope)."""

    name: ClassVar[str] = "lead_error_cumulative"
    size_keys: ClassVar[tuple[str, ...]] = ("slope",)
    slope: float

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(lead_slope=self.slope)


@dataclass(frozen=True)
class ThermalGrowth(Effect):
    """Travel error strain [m/m] * (1 - exp(-t / time_constant [s])) * x.

    x counts from the screw's fixed end at 0, t from the first sample.
    """

    name: ClassVar[str] = "thermal_growth"
    size_keys: ClassVar[tuple[str, ...]] = ("strain",)
    strain: float
    time_constant: float

    def __post_init__(self) -> None:
        """Refuse a growth that runs away."""
        require(self.time_constant > 0.0, self, "time_constant is above 0")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(growth_strain=self.strain, growth_time=self.time_constant)


@dataclass(frozen=True)
class StiffnessDeviation(Effect):
    """Axial stiffness times factor; its damper stays."""

    name: ClassVar[str] = "stiffness_deviation"
    size_keys: ClassVar[tuple[str, ...]] = ("factor",)
    neutral: ClassVar[float] = 1.0
    factor: float

    def __post_init__(self) -> None:
        """Refuse a spring that does not hold."""
        require(self.factor > 0.0, self, "factor is above 0")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(axial_stiffness=constants.axial_stiffness * self.factor)


@dataclass(frozen=True)
class StiffnessVsPosition(Effect):
    """Compliance (1 + s / (1 - s) * (x - low) / (high - low)) / k, s = share_over_stroke, over the axis' travel.

    So that k is declared at the low end and (1 - s) k is left at the high one. Conservative: the table feels
    -k'(x) e^2 / 2 as well. Outside the travel the line goes on.
    """

    name: ClassVar[str] = "stiffness_vs_position"
    size_keys: ClassVar[tuple[str, ...]] = ("share_over_stroke",)
    share_over_stroke: float

    def __post_init__(self) -> None:
        """Refuse a spring that does not hold at the far end."""
        require(self.share_over_stroke < 0.95, self, "share_over_stroke is below 0.95")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(stroke_share=self.share_over_stroke)


@dataclass(frozen=True)
class PreloadLoss(Effect):
    """Spring of stiffness ratio * k while |F| < force [N], of stiffness k beyond, the force being continuous:

    F(e) = ratio k e for |e| <= e1 = force / (ratio k), else sign(e) * (force + k * (|e| - e1)).
    F is the spring's force without the damper, which stays. Conservative. Its size is `force`.
    """

    name: ClassVar[str] = "preload_loss"
    size_keys: ClassVar[tuple[str, ...]] = ("force",)
    ratio: float
    force: float

    def __post_init__(self) -> None:
        """Refuse a free play (ratio 0), which is another effect, and what is no loss."""
        require(0.0 < self.ratio <= 1.0 and self.force >= 0.0, self, "0 < ratio <= 1, force is not negative")

    def planted(self, constants: Constants) -> Constants:
        """Return `constants` with this effect in them."""
        return constants._replace(preload_ratio=self.ratio, preload_force=self.force)
