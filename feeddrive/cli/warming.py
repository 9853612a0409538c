"""What `feeddrive thermal` does: read, let the machine warm up, write, tell."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive import __version__
from feeddrive.cli.output import deliver, tell_written, warnings_as_lines, working
from feeddrive.cli.warming_tables import thermal_tables
from feeddrive.errors import InputError
from feeddrive.files import find_plant, write_bytes_atomically, write_text_atomically
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.file.files import read_plant
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.recording import Recording
from feeddrive.thermal.heat import Heat
from feeddrive.thermal.reduced.network import Network, network
from feeddrive.thermal.rig import Travel
from feeddrive.thermal.run.duty import AMBIENT_CHANNEL, SPEED, Duty, constant_duty, read_duty
from feeddrive.thermal.run.study import ThermalStudy, study
from feeddrive.units.quantity import parse

FORMAT = "feeddrive-thermal/1"
_USUAL_DURATION = "180 min"


@dataclass(frozen=True)
class Asked:
    """What was typed: texts with units, a file, numbers; None where left out."""

    speed: str | None
    duration: str | None
    stroke: str | None
    duty: Path | None
    within: str
    order: int
    segments: int


def warm_and_tell(name: str, asked: Asked, as_json: bool, out: Path | None) -> None:
    """Warm a machine up and show or write what comes of it.

    Args:
        name: plant file or shipped name.
        asked: what was typed.
        as_json: whether JSON is wanted.
        out: folder for the files; nothing is written if None.

    Raises:
        InputError: an unusable plant, duty or option, or a folder that cannot be written.
    """
    refuse_unusable(out)
    with warnings_as_lines():
        plant = _plant(name, asked.stroke)
        with working(f"warming {plant.name} up: full and reduced model"):
            found = study(plant, _duty(plant, asked), _band(asked.within), asked.order)
    lumps = network(plant.rig, found.conductances, asked.segments, (*plant.bodies, *plant.attached))
    content = thermal_content(found, lumps)
    if out is not None:
        with output_folder(out) as folder:
            _write(found, content, folder)
    deliver(content, [] if as_json else thermal_tables(found, lumps), as_json, None)
    tell_written(out, as_json)


def _plant(name: str, stroke: str | None) -> Heat:
    plant = read_plant(find_plant(name)).heat
    if stroke is None:
        return plant
    plant.rig.refuse_travel(travel := _travel(stroke, plant.rig.travel))
    return replace(plant, rig=replace(plant.rig, travel=travel))


def _travel(text: str, declared: Travel) -> Travel:
    ends = [parse(part.strip(), "m", "--stroke") for part in text.split(" to ")]
    if len(ends) > 2:
        raise InputError(f'"{text}" is no stroke', "--stroke", 'write "150 mm", or "150 mm to 350 mm"')
    if len(ends) == 2:
        return Travel(*ends)
    if not (math.isfinite(ends[0]) and ends[0] >= 0):
        raise InputError(f'"{text}" is no stroke', "--stroke", "write a length of zero or more")
    middle = (declared.low + declared.high) / 2
    return Travel(middle - ends[0] / 2, middle + ends[0] / 2)


def _duty(plant: Heat, asked: Asked) -> Duty:
    if asked.duty is None:
        speed = plant.highest_speed / 2 if asked.speed is None else parse(asked.speed, "rad/s", "--speed")
        return constant_duty(speed, parse(asked.duration or _USUAL_DURATION, "s", "--duration"), plant.ambient)
    if asked.speed is not None or asked.duration is not None:
        raise InputError("--duty holds speed and duration", "--speed, --duration", "leave them out, or --duty")
    return read_duty(asked.duty, plant.ambient)


def _band(text: str) -> float:
    width = parse(text, "m", "--within")
    if not (math.isfinite(width) and width > 0):
        raise InputError(f'"{text}" is no error', "--within", 'write a length above zero, such as "1 µm"')
    return width


def thermal_content(found: ThermalStudy, lumps: Network) -> dict[str, Any]:
    """Everything that was found, SI units, ready for JSON."""
    duty, energy = found.duty, found.energy
    travel = found.plant.rig.travel
    return {
        "format": FORMAT,
        "version": __version__,
        "plant": found.plant.name,
        "duty": {"source": duty.source, "duration": duty.duration, "step": duty.step,
                 "mean_speed": float(np.mean(np.abs(duty.speeds)))},
        "travel": [travel.low, travel.high],
        "time": duty.times.tolist(),
        "series": {name: values.tolist() for name, values in found.series.items()},
        "warm_up": {
            "within": found.within,
            **{name: {"final": one.final, "time": _finite(one.time), "rise_time": _finite(one.rise_time)}
               for name, one in found.warm_up.items()},
        },
        "time_constants": [{"value": one.value, "shares": dict(one.shares)} for one in found.constants],
        "energy": {"heats": dict(energy.heats), "to_surroundings": energy.to_surroundings, "stored": energy.stored,
                   "imbalance": energy.imbalance},
        "models": {"full": found.model.order - 1, "reduced": found.order, "largest_error": found.reduction_errors},
        "conductances": {str(path): value for path, value in found.conductances.items()},
        "network": {
            "nodes": [vars(lump) for lump in lumps.lumps],
            "links": [vars(link) for link in lumps.links],
            "edges": lumps.edges.tolist(),
        },
    }  # fmt: skip


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _write(found: ThermalStudy, content: dict[str, Any], out: Path) -> None:
    from feeddrive.report.figures.drawing import render  # matplotlib takes time to import
    from feeddrive.report.figures.figure_thermal import thermal_figures

    duty = found.duty
    series = {re.sub(r"[^a-z0-9_]+", "_", name.lower()): values for name, values in found.series.items()}
    channels = {SPEED: duty.speeds, AMBIENT_CHANNEL: duty.ambient, **series}
    write_recording(Recording(found.plant.name, duty.times, channels, duty.step), out / "recording.csv")
    for figure in thermal_figures(found):
        drawn = render(figure)
        write_bytes_atomically(out / f"{drawn.stem}.png", drawn.png)
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    write_text_atomically(out / "thermal.json", text)
