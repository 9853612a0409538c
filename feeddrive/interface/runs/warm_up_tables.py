"""Tables of a warm-up: temperatures, errors, time constants, energy, models, network."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from feeddrive.interface.shown import Listing
from feeddrive.thermal.full.full_model import NUT
from feeddrive.thermal.reduced.network import Network
from feeddrive.thermal.run.study import ThermalStudy, WarmUp
from feeddrive.units.quantity import format_quantity

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
    return [_series(title, others, found), _series("Error at the table, growth of the screw", grown, found)]


def _series(title: str, names: Sequence[str], found: ThermalStudy) -> Listing:
    times = found.duty.times
    step = max(len(times) // _ROWS, 1)
    kept = range(len(times) - 1, -1, -step)[::-1]
    rows = [[_time(times[i]), *(_shown(name, float(found.series[name][i])) for name in names)] for i in kept]
    return Listing(title, ["time", *(_heading(name) for name in names)], rows)


def _heading(name: str) -> str:
    if name.startswith("table_growth"):
        return f"nut at {name.removeprefix('table_growth_').replace('mm', ' mm')} [µm]"
    return f"{name.removesuffix('_temperature').replace('_', ' ')} [°C]"


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


def _warm_up(name: str, one: WarmUp, found: ThermalStudy) -> list[str]:
    place = name.removeprefix("growth_").replace("mm", " mm")
    beyond = " (beyond this run)" if math.isfinite(one.time) and one.time > found.duty.duration else ""
    return [place, format_quantity(one.final, "m"), _time(one.time) + beyond, _time(one.rise_time)]


def _constants(found: ThermalStudy) -> Listing:
    names = list(found.constants[0].shares) if found.constants else []
    rows = [
        [_time(one.value), *(f"{one.shares[name] + 0.0:.1%}".replace("-0.0%", "0.0%") for name in names)]
        for one in found.constants
    ]
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
