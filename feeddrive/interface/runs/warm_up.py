"""The warm-up of a machine: temperatures, growth, time constants."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.interface.axis import Axis, axis_of
from feeddrive.interface.quantities import Quantities, Quantity, quantities, si
from feeddrive.interface.shown import Listing, Shown, finite, write_figures, write_json
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.recording import Recording
from feeddrive.thermal.full.full_model import NUT
from feeddrive.thermal.reduced.network import Network, network
from feeddrive.thermal.reduced.reduction import DEFAULT_ORDER
from feeddrive.thermal.rig import Travel
from feeddrive.thermal.run.duty import AMBIENT_CHANNEL, SPEED, constant_duty, read_duty
from feeddrive.thermal.run.study import ThermalStudy, study
from feeddrive.thermal.run.study import WarmUp as Settled
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity, percent

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
    axis: Axis | str | Path,
    duty: str | Path | None = None,
    *,
    speed: Quantity | None = None,
    duration: Quantity | None = None,
    within: Quantity = "1 µm",
    order: int = DEFAULT_ORDER,
    stroke: Quantities = None,
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
    plant = axis_of(axis).heat
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
    if order < 1 or segments < 1:
        what = f"{order} states of the reduced model and {segments} segments of the shaft"
        raise InputError(what, "order, segments", "write whole numbers above zero")
    return WarmUp(study(plant, rows, band, order), segments)


def _travel(stroke: Quantity | Sequence[Quantity], declared: Travel) -> Travel:
    ends = quantities(stroke, "m", "stroke")
    if len(ends) == 2:
        return Travel(*ends)
    if len(ends) != 1 or not ends[0] >= 0:
        raise InputError(f'"{stroke}" is no stroke', "stroke", 'write "150 mm", or "150 mm to 350 mm"')
    middle = (declared.low + declared.high) / 2
    return Travel(middle - ends[0] / 2, middle + ends[0] / 2)


_ROWS = 10


def warm_up_tables(found: ThermalStudy, lumps: Network) -> tuple[Listing, ...]:
    """What people read, in the order in which they ask."""
    return (*_over_time(found), _warm_ups(found), _constants(found), _energy(found), _models(found), *_network(lumps))


def _over_time(found: ThermalStudy) -> list[Listing]:
    """Temperatures, and the error at the table, at some times."""
    duty, travel = found.duty, found.heat.rig.travel
    speed = format_quantity(float(np.mean(np.abs(duty.speeds))), "rad/s")
    what = f"{speed} constant" if duty.is_constant else f"{speed} on average ({duty.source})"
    title = f"{found.heat.name}: {what}, nut from {travel.low * 1e3:.4g} to {travel.high * 1e3:.4g} mm"
    grown = [name for name in found.series if name.startswith("table_growth")]
    others = [name for name in found.series if name not in grown]
    held = "" if found.heat.rig.both_ends is None else ", held at both ends"
    return [_series(title, others, found), _series(f"Error at the table, growth of the screw{held}", grown, found)]


def _series(title: str, names: Sequence[str], found: ThermalStudy) -> Listing:
    times = found.duty.times
    step = max(len(times) // _ROWS, 1)
    kept = range(len(times) - 1, -1, -step)[::-1]
    rows = [[_time(times[i]), *(_shown(name, float(found.series[name][i])) for name in names)] for i in kept]
    return Listing(title, ["time", *(_heading(name) for name in names)], rows)


def _heading(name: str) -> str:
    if name.startswith("table_growth"):
        place = _place(name)
        return f"{place if place == _END else f'nut at {place}'} [µm]"
    return f"{name.removesuffix('_temperature').replace('_', ' ')} [°C]"


_END = "end of the screw"


def _place(name: str) -> str:
    """Of a growth, by its name: where the nut stands, or the far end of the screw, which no nut reaches."""
    place = name.rpartition("growth_")[2]
    return _END if place == "end" else place.replace("mm", " mm")


def _shown(name: str, value: float) -> str:
    return f"{1e6 * value:.2f}" if name.startswith("table_growth") else f"{value:.2f}"


def _time(seconds: float) -> str:
    if not math.isfinite(seconds):
        return "not in this run"
    return f"{seconds / 60:.4g} min" if seconds >= 60 else f"{seconds:.3g} s"


def _warm_ups(found: ThermalStudy) -> Listing:
    rows = [_warm_up(name, one, found) for name, one in found.warm_up.items()]
    band = format_quantity(found.within, "m")
    last = "error it settles at" if found.duty.is_constant else "error at the end of the run"
    return Listing("Warm-up of the table's position", ("nut at", last, f"within {band} after", "63.2 % after"), rows)


def _warm_up(name: str, one: Settled, found: ThermalStudy) -> list[str]:
    beyond = " (beyond this run)" if math.isfinite(one.time) and one.time > found.duty.duration else ""
    return [_place(name), format_quantity(one.final, "m"), _time(one.time) + beyond, _time(one.rise_time)]


def _constants(found: ThermalStudy) -> Listing:
    names = list(found.constants[0].shares) if found.constants else []
    rows = [[_time(one.value), *(percent(one.shares[name], 1) for name in names)] for one in found.constants]
    headings = [_heading("nut_temperature" if name == NUT else f"table_{name}").split(" [")[0] for name in names]
    return Listing("Time constants, and their shares in a step", ["τ", *headings], rows)


def _energy(found: ThermalStudy) -> Listing:
    energy = found.energy
    rows = [[f"heat in: {_words(name)}", _energy_text(value)] for name, value in energy.heats.items() if value]
    rows += [
        ["to the surroundings", _energy_text(energy.to_surroundings)],
        ["stored in steel and bodies", _energy_text(energy.stored)],
        ["does not close by", f"{energy.imbalance:.1e} of the largest"],
    ]
    return Listing("Energy of the run", ("", "energy"), rows)


def _words(name: str) -> str:
    return {"front": "front bearing", "rear": "rear bearing"}.get(name, name)


def _energy_text(value: float) -> str:
    return f"{value / 1e3:.4g} kJ"


def _models(found: ThermalStudy) -> Listing:
    rise, growth = _largest(found.reduction_errors)
    rows = [
        ["full, finite volumes", str(found.model.order - 1), "", ""],
        ["reduced", str(found.order), f"{1e3 * rise:.2g} mK", f"{1e9 * growth:.2g} nm"],
    ]
    return Listing("Models, errors in this run", ("model", "states", "temperatures", "growths"), rows)


def _largest(errors: Mapping[str, float]) -> tuple[float, float]:
    grown = [error for name, error in errors.items() if name.startswith("table_growth")]
    others = [error for name, error in errors.items() if not name.startswith("table_growth")]
    return max(others), max(grown)


def _network(lumps: Network) -> list[Listing]:
    edges = 1e3 * lumps.edges
    spans = {f"shaft_{i + 1}": f"{edges[i]:.4g} to {edges[i + 1]:.4g} mm" for i in range(len(edges) - 1)}
    nodes = [
        [one.name, spans.get(one.name, ""), f"{one.capacity:.4g} J/K", f"{one.to_air:.3g} W/K"] for one in lumps.lumps
    ]
    links = [
        [one.first, one.second, f"{one.conductance:.3g} W/K", f"{1 / one.conductance:.3g} K/W"]
        for one in lumps.links
        if one.conductance > 0
    ]
    title = "Network: nodes, at the mean conductances of the run"
    remark = "The network is for reading; its errors are some per cent. Numbers above are those of the full model."
    return [
        Listing(title, ("node", "shaft from the front end", "capacity", "to the air"), nodes),
        Listing("Network: conductances between nodes", ("from", "to", "conductance", "resistance"), links, (), remark),
    ]
