"""A machine on which the compensations of its heat were tried: numbers of the test, what each left, figures, table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.compensation.heat.thermal_error import LeftOver, left_over, model_alone
from feeddrive.compensation.heat.thermal_line import Convention, LineTable, straight_line
from feeddrive.compensation.heat.thermal_sensors import Sensor
from feeddrive.compensation.heat.thermal_trial import TriedMachine
from feeddrive.files import write_text_atomically
from feeddrive.interface.shown import Listing, Shown, write_figures
from feeddrive.metrology.axis_heating import AxisHeating, axis_heating
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.interface.runs.thermal_compensation import ThermalCompensation
    from feeddrive.report.figures.drawing import ReportFigure

_OBSERVER = "observer, {} sensor{}"


@dataclass(frozen=True, repr=False, eq=False)
class ThermalTrial(Shown):
    """What each compensation left of the thermal error of one machine.

    Attributes:
        design: of the compensations.
        machine: what happened on it.
        stop: when it stopped [s].
        seed: of the noise of the sensors.
    """

    design: ThermalCompensation
    machine: TriedMachine
    stop: float
    seed: int

    @cached_property
    def heating(self) -> AxisHeating:
        """Numbers of the test after ISO 230-3, at both ends and in the middle of the travel."""
        positions = self.design.error.positions
        ends = [0, len(positions) // 2, -1]
        return axis_heating(self.machine.times, self.machine.error[:, ends], positions[ends], self.stop)

    @cached_property
    def line(self) -> LineTable:
        """The straight line over the nut's temperature, as a control takes it."""
        return self.design.line(len(self.machine.speeds))

    @cached_property
    def compensations(self) -> Mapping[str, FloatArray]:
        """Name of a compensation to the error that it makes out, (k, p) [m]."""
        design, machine = self.design, self.machine
        nut = design.heat.ambient + machine.readings([Sensor("nut")], np.random.default_rng(self.seed))[:, 0]
        found = {
            "line over the nut's temperature": self.line.line(nut).at(machine.positions),
            "model alone, air recorded": model_alone(
                design.heat, design.model, design.error, machine.step, machine.speeds, machine.ambient
            ),
        }
        for n in range(1, design.sensors + 1):
            places = design.places[n][0].places
            found[_OBSERVER.format(n, "s" if n > 1 else "")] = design.observed(machine, places, self.seed)
        best = found[self._line_of]
        straight = straight_line(best, machine.positions, design.reference).at(machine.positions)
        return found | {f"line through {self._line_of}": straight}

    @property
    def _line_of(self) -> str:
        """The observer through whose error a line is laid too: of two sensors, which most machines can carry."""
        n = min(2, self.design.sensors)
        return _OBSERVER.format(n, "s" if n > 1 else "") if n else "model alone, air recorded"

    @property
    def left(self) -> Mapping[str, LeftOver]:
        """Name of a compensation to what it leaves; first without any."""
        error = self.machine.error
        nothing = {"no compensation": np.zeros_like(error)}
        return {name: left_over(error, one) for name, one in {**nothing, **self.compensations}.items()}

    def listing(self) -> Listing:
        """What each compensation leaves over stroke and time, and how many times smaller that is than without."""
        records = [
            {"compensation": name, "rms [m]": one.rms_after, "largest [m]": one.largest_after}
            for name, one in self.left.items()
        ]
        rows = [
            [
                name,
                micrometres(one.rms_after, 2),
                micrometres(one.largest_after, 2),
                f"{one.rms_factor:.1f}",
                f"{one.largest_factor:.1f}",
            ]
            for name, one in self.left.items()
        ]
        headings = ("compensation", "rms [µm]", "largest [µm]", "times smaller, rms", "largest")
        caption = "One run; the expected error is the spread over all that the unknowns may be."
        return Listing(f"{self.design.heat.name}: error left over stroke and time", headings, rows, records, caption)

    def tables(self) -> tuple[Listing, ...]:
        """The numbers of the test, the best places, what each compensation leaves."""
        found = self.heating
        rows = [
            [
                format_quantity(one.position, "m"),
                *(micrometres(value, 1) for value in (one.first_hour, one.heating, one.whole, one.largest)),
                f"{one.settling / 60:.0f}",
            ]
            for one in found.targets
        ]
        headings = (
            "nut at",
            "first 60 min [µm]",
            "heating [µm]",
            "whole test [µm]",
            "largest [µm]",
            "steady after [min]",
        )
        caption = f"Slope within the travel when the axis stops: {found.slope * 1e6:.0f} µm/m."
        test = Listing(f"{self.design.heat.name}: heating by moving the axis", headings, rows, caption=caption)
        return test, self.design.listing(), self.listing()

    def save(self, folder: str | Path) -> Path:
        """Write the figures, and `thermal_line.csv`: the straight line over the nut's temperature for a control.

        Raises:
            InputError: the folder cannot be written.
        """
        place = Path(folder)
        write_figures(self._figures(), place)
        write_text_atomically(place / "thermal_line.csv", self.line.text(Convention.MEASURED_ERROR))
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_compensation import (
            axis_heating_figure,
            compensation_figure,
            stroke_figure,
        )

        machine, found = self.machine, self.compensations
        times, positions, ambient = machine.times, machine.positions, self.design.heat.ambient
        temperatures = {name.replace("_", " "): ambient + rise for name, rise in machine.rises.items()}
        shown = {name: one for name, one in found.items() if not name.startswith("line through")}
        moments = [0.25 * 3600, 3600.0, self.stop, self.stop + 900, self.stop + 3600]
        return (
            axis_heating_figure(times, positions, machine.error, {**temperatures, "air": machine.ambient}, self.stop),
            compensation_figure(times, positions, machine.error, shown, self.stop),
            stroke_figure(
                times, positions, machine.error, found[self._line_of], [m for m in moments if m <= times[-1]]
            ),
        )


def micrometres(value: float, decimals: int) -> str:
    """A length [m] in µm, without its unit."""
    return f"{value * 1e6:.{decimals}f}"
