"""What a compensation of heat leaves of the error: sensors placed, compensations designed, tried on another machine.

The design knows what the file declares. The machine that it is tried on is computed on another mesh and is not as
declared: other heats, other films, a heat that nobody declared, air that warms. It goes to and fro and then rests, as
ISO 230-3 has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.compensation.heat.thermal_error import TableError, compensation_model, table_error
from feeddrive.compensation.heat.thermal_line import LineTable, line_table
from feeddrive.compensation.heat.thermal_observer import thermal_observer
from feeddrive.compensation.heat.thermal_placement import Placement, placements
from feeddrive.compensation.heat.thermal_sensors import Sensor, mountable_places
from feeddrive.compensation.heat.thermal_trial import TriedMachine, tried_machine
from feeddrive.compensation.heat.thermal_unknowns import Unknowns
from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis
from feeddrive.interface.quantities import Quantity, si
from feeddrive.interface.runs.thermal_trial import ThermalTrial, micrometres
from feeddrive.interface.shown import Listing, Shown
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    pass

_STEP = 30.0
"""Of the compensations [s]; a sensor of 60 s follows within two of them."""

_SETTLED = (0.0, 1 / 6, 1 / 2, 1.0)
"""Speeds over the highest at which places are compared."""

_FITTED = (1 / 6, 1 / 3, 2 / 3)
"""Speeds over the highest of the warm-ups and cool-downs to which the straight line is fitted."""

_MESH = Cells(130, 5, 16, 5)
"""Of the machine that is tried: another than the design's, so that no compensation meets its own rounding."""

_BEST = 3


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
            [
                str(len(one.places)),
                ", ".join(one.places) or "no sensor",
                micrometres(one.rms, 2),
                micrometres(one.largest, 2),
            ]
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
            air: by how much the surroundings warm until the end; only the model alone takes it as recorded.
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
        """Error by the observer with sensors at some places, which sees no warming of the air, (k, p) [m]."""
        sensors = [Sensor(place) for place in places]
        observer = thermal_observer(self.heat, self.model, self.error, sensors, self.unknowns, machine.step)
        readings = machine.readings(sensors, np.random.default_rng(seed))
        return observer.observe(machine.speeds, np.full(len(machine.speeds), self.heat.ambient), readings).error


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
