"""The warm-up of a machine: temperatures, growth, time constants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis
from feeddrive.interface.quantities import Quantity, si
from feeddrive.interface.shown import Listing, Shown
from feeddrive.thermal.reduced.reduction import DEFAULT_ORDER
from feeddrive.thermal.run.duty import constant_duty, read_duty
from feeddrive.thermal.run.study import ThermalStudy, study
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class WarmUp(Shown):
    """How a machine warms up.

    Attributes:
        study: everything that was computed, SI; temperatures in degC.
    """

    study: ThermalStudy

    def __getitem__(self, name: str) -> FloatArray:
        """Values of a channel at the ends of the rows, shape (k,): temperatures [degC], growth [m], "time" [s].

        Raises:
            InputError: no such channel; names those there are.
        """
        if name == "time":
            return self.study.duty.times
        if name not in self.study.series:
            raise InputError(f'no channel "{name}"', self.study.plant.name, f"it has {', '.join(self.study.series)}")
        return self.study.series[name]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(self.study.series)

    def listing(self) -> Listing:
        """One row per place: the growth that it settles at, the time until then, the rise time."""
        records = [
            {"growth": name, "final [m]": one.final, "time [s]": one.time, "rise time [s]": one.rise_time}
            for name, one in self.study.warm_up.items()
        ]
        rows = [
            [name, *(format_quantity(value, unit) for value, unit in
                     ((one.final, "m"), (one.time, "s"), (one.rise_time, "s")))]
            for name, one in self.study.warm_up.items()
        ]  # fmt: skip
        headings = ("growth", "settles at", f"within {format_quantity(self.study.within, 'm')} after", "63 % after")
        return Listing(f"{self.study.plant.name}: warm-up", headings, rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_thermal import thermal_figures

        return thermal_figures(self.study)


def warm_up(
    axis: Axis,
    duty: str | Path | None = None,
    *,
    speed: Quantity | None = None,
    duration: Quantity = "180 min",
    within: Quantity = "1 µm",
    order: int = DEFAULT_ORDER,
) -> WarmUp:
    """Let a machine warm up from rest and cold.

    Args:
        axis: a machine that declares heat.
        duty: CSV with time, screw_speed and perhaps ambient_temperature, in place of a constant speed.
        speed: constant, of the screw; half the highest if left out.
        duration: of the constant speed.
        within: band about the final growth for the warm-up time.
        order: number of states of the reduced model that is compared.

    Raises:
        InputError: a machine without heat, a duty that cannot be used.

    >>> import feeddrive as fd
    >>> warm = fd.warm_up(fd.load("thermal_bench"), speed="750 rev/min", duration="60 min")
    >>> "nut_temperature" in warm.channels
    True
    """
    plant = axis.heat
    if duty is not None and speed is not None:
        raise InputError("a duty holds speed and duration", "speed", "leave it out, or duty")
    if duty is not None:
        rows = read_duty(Path(duty), plant.ambient)
    else:
        turning = plant.highest_speed / 2 if speed is None else si(speed, "rad/s", "speed")
        rows = constant_duty(turning, si(duration, "s", "duration"), plant.ambient)
    band = si(within, "m", "within")
    if not band > 0:
        raise InputError(f"{within} is no error", "within", 'write a length above zero, such as "1 µm"')
    return WarmUp(study(plant, rows, band, order))
