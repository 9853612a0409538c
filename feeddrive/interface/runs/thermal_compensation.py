"""What a compensation of heat leaves of the error: sensors placed, compensations designed, tried on another machine.

The design knows what the file declares. The machine that it is tried on is computed on another mesh and is not as
declared: other heats, other films, a heat that nobody declared, air that warms. It goes to and fro and then rests, as
ISO 230-3 has it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.compensation.heat.thermal_error import LeftOver, TableError, left_over, table_error
from feeddrive.compensation.heat.thermal_line import Convention, LineTable, line_table, straight_line
from feeddrive.compensation.heat.thermal_observer import thermal_observer
from feeddrive.compensation.heat.thermal_open_loop import compensation_model, model_alone
from feeddrive.compensation.heat.thermal_placement import Placement, placements
from feeddrive.compensation.heat.thermal_sensors import Sensor, mountable_places
from feeddrive.compensation.heat.thermal_trial import TriedMachine, tried_machine
from feeddrive.compensation.heat.thermal_unknowns import Unknowns
from feeddrive.errors import InputError
from feeddrive.files import write_text_atomically
from feeddrive.interface.axis import Axis
from feeddrive.interface.quantities import Quantity, si
from feeddrive.interface.shown import Listing, Shown, write_figures
from feeddrive.metrology.axis_heating import AxisHeating, axis_heating
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.heat import Heat
from feeddrive.thermal.reduced.model import HeatModel
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

_STEP = 30.0
"""Of the compensations [s]; a sensor of 60 s follows within two of them."""

_SETTLED = (0.0, 1 / 6, 1 / 2, 1.0)
"""Speeds over the highest at which places are compared."""

_FITTED = (1 / 6, 1 / 3, 2 / 3)
"""Speeds over the highest of the warm-ups and cool-downs to which the straight line is fitted."""

_MESH = Cells(130, 5, 16, 5)
"""Of the machine that is tried: another than the design's, so that no compensation meets its own rounding."""

_BEST = 3
_OBSERVER = "observer, {} sensor{}"


@dataclass(frozen=True, repr=False, eq=False)
class ThermalCompensation(Shown):
    """Compensations of the thermal error of an axis, and the best places of their sensors.

    Attributes:
        heat: what the file declares.
        unknowns: what it does not, and how far that may wander.
        sensors: greatest number of them.
        reference: P0 of the straight line [m].
    """

    heat: Heat
    unknowns: Unknowns
    sensors: int
    reference: float

    @cached_property
    def model(self) -> HeatModel:
        """The reduced model that every compensation runs."""
        return compensation_model(self.heat)

    @cached_property
    def error(self) -> TableError:
        """The error of the table as the model has it."""
        return table_error(self.heat, self.model)

    @cached_property
    def places(self) -> Mapping[int, tuple[Placement, ...]]:
        """Number of sensors to all sets of places, the best first."""
        speeds = [share * self.heat.highest_speed for share in _SETTLED]
        counts = range(self.sensors + 1)
        return {n: placements(self.heat, self.model, self.error, n, speeds, self.unknowns) for n in counts}

    def listing(self) -> Listing:
        """The best sets of places of each number of sensors, and the error to be expected with them."""
        found = [one for sets in self.places.values() for one in sets[:_BEST]]
        records = [{"places": ", ".join(one.places), "rms [m]": one.rms, "largest [m]": one.largest} for one in found]
        rows = [
            [str(len(one.places)), ", ".join(one.places) or "no sensor", _micro(one.rms, 2), _micro(one.largest, 2)]
            for one in found
        ]
        caption = "One standard deviation, over all that the unknowns may be, of the error along the stroke."
        headings = ("sensors", "places", "expected error left, rms [µm]", "largest [µm]")
        return Listing(f"{self.heat.name}: places of the sensors", headings, rows, records, caption)

    def line(self, rows: int) -> LineTable:
        """The straight line that controls take, over the nut's temperature, from warm-ups and cool-downs by the model.

        Args:
            rows: of 30 s, of each warm-up with its cool-down.
        """
        still = np.full(rows, self.heat.ambient)
        runs = [
            tried_machine(
                self.heat, self.model, _STEP, _to_and_fro(share * self.heat.highest_speed, rows, rows // 2), still
            )
            for share in _FITTED
        ]
        readings = np.concatenate([self.heat.ambient + one.rises["nut"] for one in runs])
        return line_table(readings, np.vstack([one.error for one in runs]), runs[0].positions, self.reference)

    def on(
        self,
        speed: Quantity,
        moving: Quantity = "4 h",
        resting: Quantity = "4 h",
        *,
        heat: float = 1.0,
        film: float = 1.0,
        undeclared: Mapping[str, Quantity] | None = None,
        air: Quantity = "0 K",
        seed: int = 1,
    ) -> ThermalTrial:
        """Try the compensations on a machine that is not as declared: it goes to and fro, then rests.

        Args:
            speed: of the screw while it moves.
            moving: how long it moves, an hour at least.
            resting: how long it rests after.
            heat, film: factors on all heats and films [1].
            undeclared: name of a body, "front" or "rear" to a heat that it gets while the axis moves.
            air: by how much the surroundings warm until the end; no compensation but the model alone is told.
            seed: of the noise of the sensors.

        Raises:
            InputError: a time that is no whole number of rows of 30 s, or a heat at a place that does not exist.
        """
        turning, warmer = si(speed, "rad/s", "speed"), si(air, "K", "air")
        times = {"moving": si(moving, "s", "moving"), "resting": si(resting, "s", "resting")}
        for name, time in times.items():
            if not (time > 0 and abs(time / _STEP - round(time / _STEP)) < 1e-9):
                raise InputError(f"{time:g} s is no whole number of rows of 30 s", name, 'write a time such as "4 h"')
        rows = round(sum(times.values()) / _STEP)
        speeds = _to_and_fro(turning, rows, round(times["moving"] / _STEP))
        others = {
            _place(self.heat, name): np.where(speeds > 0, si(power, "W", f"undeclared.{name}"), 0.0)
            for name, power in (undeclared or {}).items()
        }
        ambient = self.heat.ambient + np.linspace(0.0, warmer, rows)
        full = replace(self.heat, cells=_MESH).full_model()
        machine = tried_machine(self.heat, full, _STEP, speeds, ambient, heat=heat, film=film, others=others)
        return ThermalTrial(self, machine, times["moving"], seed)

    def observed(self, machine: TriedMachine, places: tuple[str, ...], seed: int) -> FloatArray:
        """What the observer with sensors at some places makes of a machine; it is not told that the air warms, (k, p)
        [m]."""
        sensors = [Sensor(place) for place in places]
        observer = thermal_observer(self.heat, self.model, self.error, sensors, self.unknowns, machine.step)
        readings = machine.readings(sensors, np.random.default_rng(seed))
        return observer.observe(machine.speeds, np.full(len(machine.speeds), self.heat.ambient), readings).error


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
                _micro(one.rms_after, 2),
                _micro(one.largest_after, 2),
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
                *(_micro(value, 1) for value in (one.first_hour, one.heating, one.whole, one.largest)),
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
        from feeddrive.report.figures.figure_thermal_compensation import (
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


def thermal_compensation(
    axis: Axis,
    *,
    sensors: int = 3,
    heats: Mapping[str, Quantity] | None = None,
    reference: Quantity | None = None,
) -> ThermalCompensation:
    """Design compensations of the thermal error of an axis: places of sensors, observer, model alone, straight line.

    Args:
        axis: a machine that declares heat and a travel of the nut.
        sensors: greatest number of temperature sensors.
        heats: name of a body, "front" or "rear" to the standard deviation of a heat that may be there undeclared; 2 W
            at the front bearing if left out.
        reference: P0, position of the nut from which the straight line counts; the low end of its travel if left out.

    Raises:
        InputError: a machine without heat, more sensors than places, or a heat at a place that does not exist.

    >>> import feeddrive as fd
    >>> design = fd.thermal_compensation(fd.load("thermal_bench"), sensors=1)
    >>> design.places[1][0].places
    ('front',)
    """
    heat = axis.heat
    travel = heat.rig.travel
    if not travel.high > travel.low:
        raise InputError("the nut does not travel", heat.name, "declare travel in [thermal] from low to high")
    most = len(mountable_places(heat))
    if not 1 <= sensors <= most:
        raise InputError(f"{sensors} sensors", "sensors", f"write 1 to {most}, as many as there are places")
    unknowns = Unknowns()
    if heats is not None:
        found = ((_place(heat, name), si(power, "W", f"heats.{name}")) for name, power in heats.items())
        unknowns = Unknowns(heats=tuple(found))
    return ThermalCompensation(
        heat, unknowns, sensors, travel.low if reference is None else si(reference, "m", "reference")
    )


def _place(heat: Heat, name: str) -> str:
    known = ("front", "rear", *(body.name for body in heat.bodies))
    if name not in known:
        raise InputError(f'no place "{name}" that a heat could act on', heat.name, f"write one of {', '.join(known)}")
    return name


def _to_and_fro(speed: float, rows: int, moving: int) -> FloatArray:
    """Speeds of a screw that turns for some rows and then rests, (rows,) [rad/s]."""
    return np.repeat([speed, 0.0], [moving, rows - moving])


def _micro(value: float, decimals: int) -> str:
    return f"{value * 1e6:.{decimals}f}"
