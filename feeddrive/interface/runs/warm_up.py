"""The warm-up of a machine: temperatures, growth, time constants."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis
from feeddrive.interface.quantities import Quantity, quantities, si
from feeddrive.interface.runs.warm_up_tables import warm_up_tables
from feeddrive.interface.shown import Listing, Shown, finite, write_figures, write_json
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.recording import Recording
from feeddrive.thermal.reduced.network import Network, network
from feeddrive.thermal.reduced.reduction import DEFAULT_ORDER
from feeddrive.thermal.rig import Travel
from feeddrive.thermal.run.duty import AMBIENT_CHANNEL, SPEED, constant_duty, read_duty
from feeddrive.thermal.run.study import ThermalStudy, study
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

_USUAL_DURATION = "180 min"


@dataclass(frozen=True, repr=False, eq=False)
class WarmUp(Shown):
    """How a machine warms up.

    Attributes:
        study: everything that was computed, SI; temperatures in degC.
        segments: of the shaft in the network.
    """

    study: ThermalStudy
    segments: int = 10

    def __getitem__(self, name: str) -> FloatArray:
        """Values of a channel at the ends of the rows, shape (k,): temperatures [degC], growth [m], "time" [s].

        Raises:
            InputError: no such channel; names those there are.
        """
        if name == "time":
            return self.study.duty.times
        if name not in self.study.series:
            raise InputError(f'no channel "{name}"', self.study.heat.name, f"it has {', '.join(self.study.series)}")
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
            [
                name,
                *(
                    format_quantity(value, unit)
                    for value, unit in ((one.final, "m"), (one.time, "s"), (one.rise_time, "s"))
                ),
            ]
            for name, one in self.study.warm_up.items()
        ]
        headings = ("growth", "settles at", f"within {format_quantity(self.study.within, 'm')} after", "63 % after")
        return Listing(f"{self.study.heat.name}: warm-up", headings, rows, records)

    @cached_property
    def network(self) -> Network:
        """Lumped network at the mean conductances of the run, for reading; its errors are some per cent."""
        found = self.study
        bodies = (*found.heat.bodies, *found.heat.attached)
        return network(found.heat.rig, found.conductances, self.segments, bodies)

    def tables(self) -> tuple[Listing, ...]:
        """Temperatures, error at the table, warm-up, time constants, energy, models, network."""
        return warm_up_tables(self.study, self.network)

    def record(self) -> dict[str, Any]:
        """Everything that was found, plain values, SI."""
        found, lumps = self.study, self.network
        duty, energy, travel = found.duty, found.energy, found.heat.rig.travel
        return {
            "format": "feeddrive-thermal/1",
            "version": __version__,
            "plant": found.heat.name,
            "duty": {
                "source": duty.source,
                "duration": duty.duration,
                "step": duty.step,
                "mean_speed": float(np.mean(np.abs(duty.speeds))),
            },
            "travel": [travel.low, travel.high],
            "time": duty.times.tolist(),
            "series": {name: values.tolist() for name, values in found.series.items()},
            "warm_up": {
                "within": found.within,
                **{
                    name: {"final": one.final, "time": finite(one.time), "rise_time": finite(one.rise_time)}
                    for name, one in found.warm_up.items()
                },
            },
            "time_constants": [{"value": one.value, "shares": dict(one.shares)} for one in found.constants],
            "energy": {
                "heats": dict(energy.heats),
                "to_surroundings": energy.to_surroundings,
                "stored": energy.stored,
                "imbalance": energy.imbalance,
            },
            "models": {
                "full": found.model.order - 1,
                "reduced": found.order,
                "largest_error": found.reduction_errors,
            },
            "conductances": {str(path): value for path, value in found.conductances.items()},
            "network": {
                "nodes": [vars(lump) for lump in lumps.lumps],
                "links": [vars(link) for link in lumps.links],
                "edges": lumps.edges.tolist(),
            },
        }

    @property
    def recording(self) -> Recording:
        """Speed, surroundings, temperatures and growth over the time."""
        found, duty = self.study, self.study.duty
        series = {re.sub(r"[^a-z0-9_]+", "_", name.lower()): values for name, values in found.series.items()}
        channels = {SPEED: duty.speeds, AMBIENT_CHANNEL: duty.ambient, **series}
        return Recording(found.heat.name, duty.times, channels, duty.step)

    def save(self, folder: str | Path) -> Path:
        """Write `thermal.json`, `recording.csv` and the figures.

        Raises:
            InputError: the folder cannot be written.
        """
        place = Path(folder)
        write_recording(self.recording, place / "recording.csv")
        write_figures(self._figures(), place)
        write_json(self.record(), place / "thermal.json")
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_thermal import thermal_figures

        return thermal_figures(self.study)


def warm_up(
    axis: Axis,
    duty: str | Path | None = None,
    *,
    speed: Quantity | None = None,
    duration: Quantity | None = None,
    within: Quantity = "1 µm",
    order: int = DEFAULT_ORDER,
    stroke: Quantity | Sequence[Quantity] | None = None,
    segments: int = 10,
) -> WarmUp:
    """Let a machine warm up from rest and cold.

    Args:
        axis: a machine that declares heat.
        duty: CSV with time, screw_speed and perhaps ambient_temperature, in place of a constant speed.
        speed: constant, of the screw; half the highest if left out.
        duration: of the constant speed; 180 min if left out.
        within: band about the final growth for the warm-up time.
        order: number of states of the reduced model that is compared.
        stroke: of the nut, a length about the middle of the declared travel, or its two ends.
        segments: of the shaft in the network.

    Raises:
        InputError: a machine without heat, a duty that cannot be used.

    >>> import feeddrive as fd
    >>> warm = fd.warm_up(fd.load("thermal_bench"), speed="750 rev/min", duration="60 min")
    >>> "nut_temperature" in warm.channels
    True
    """
    plant = axis.heat
    if stroke is not None:
        travel = _travel(stroke, plant.rig.travel)
        plant.rig.refuse_travel(travel)
        plant = replace(plant, rig=replace(plant.rig, travel=travel))
    if duty is not None:
        if speed is not None or duration is not None:
            raise InputError("a duty holds speed and duration", "speed, duration", "leave them out, or the duty")
        rows = read_duty(Path(duty), plant.ambient)
    else:
        turning = plant.highest_speed / 2 if speed is None else si(speed, "rad/s", "speed")
        lasting = si(_USUAL_DURATION if duration is None else duration, "s", "duration")
        rows = constant_duty(turning, lasting, plant.ambient)
    band = si(within, "m", "within")
    if not (math.isfinite(band) and band > 0):
        raise InputError(f'"{within}" is no error', "within", 'write a length above zero, such as "1 µm"')
    return WarmUp(study(plant, rows, band, order), segments)


def _travel(stroke: Quantity | Sequence[Quantity], declared: Travel) -> Travel:
    ends = quantities(stroke, "m", "stroke")
    if len(ends) == 2:
        return Travel(*ends)
    if len(ends) != 1 or not ends[0] >= 0:
        raise InputError(f'"{stroke}" is no stroke', "stroke", 'write "150 mm", or "150 mm to 350 mm"')
    middle = (declared.low + declared.high) / 2
    return Travel(middle - ends[0] / 2, middle + ends[0] / 2)
