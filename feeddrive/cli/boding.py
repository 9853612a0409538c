"""What `feeddrive bode` does: read the request, compute the families, write and show them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive import __version__
from feeddrive.cli.bode_tables import family_tables
from feeddrive.cli.output import chain_remark, deliver, finite, tell_written, warnings_as_lines
from feeddrive.errors import InputError
from feeddrive.export.point import export_point
from feeddrive.files import find_plant, find_scenario_or_controller, write_bytes_atomically, write_text_atomically
from feeddrive.metrology.recorded_response import recorded_response
from feeddrive.metrology.response import Response as Measured
from feeddrive.output_folder import output_folder, refuse_unusable
from feeddrive.plant.analysis.linear import INPUTS, OUTPUTS
from feeddrive.plant.chain.resolution import resolved, resolved_modes
from feeddrive.plant.file.entries import nearest
from feeddrive.plant.file.files import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording.files.reading import read_recording
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.traces.opened import read_frequency_response
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.frequency_response import UNITS, Case, refuse_no_range
from feeddrive.servo.loop_response import loops_of, refuse_unstable_case
from feeddrive.servo.response_family import Family, closed_family, controlled_family, mechanics_family, open_family
from feeddrive.servo.response_json import family_content, measured_content
from feeddrive.simulate.controlled.controller_file import read_controller
from feeddrive.tuning.demand import cases_of
from feeddrive.units.quantity import parse, unit_conversion

FORMAT = "feeddrive-bode/1"
_LOOPS = ("open", "closed")


@dataclass(frozen=True)
class Request:
    """What was typed; texts are empty where left out."""

    plant: str
    given: str
    output: str
    at: str
    positions: str
    payload: str
    loop: str
    scenario: str
    frequencies: str
    recording: Path | None
    mapping: Path | None


def run(request: Request, as_json: bool, out: Path | None) -> None:
    """Compute, write and show.

    Raises:
        InputError: anything in the request that cannot be used.
    """
    refuse_unusable(out)
    with warnings_as_lines():
        plant = read_plant(find_plant(request.plant))
        cases = read_cases(plant, request.at, request.positions, request.payload)
        low, high = _range(request.frequencies)
        valid_to = min(resolved_modes(plant, case.position).chain_valid_to for case in cases)
        fine = resolved(plant, high, [case.position for case in cases])
        families = _families(fine, request, cases, low, high)
        measured = _measured(request)
    content = _content(plant, families, measured) | {"chain_valid_to": finite(valid_to)}
    if out is not None:
        with output_folder(out) as folder:
            _write(families, measured, content, folder)
    tables = [] if as_json else [table for family in families for table in family_tables(plant.name, family)]
    if tables and high > valid_to:
        tables[-1].caption = chain_remark(valid_to)
    deliver(content, tables, as_json, None)
    tell_written(out, as_json)


def read_cases(plant: Plant, at: str, positions: str, payload: str) -> tuple[Case, ...]:
    """Every position with every payload, as typed.

    Raises:
        InputError: positions given twice, off the stroke, or values that are no quantities.
    """
    point = export_point(plant, at)
    written = [part.split("=")[0].strip() for part in at.split(",")]
    if positions and "x" in written:
        raise InputError("positions are given twice", "--positions, --at x", "keep one of them")
    places = quantities(positions, "m", "--positions") or (point.position,)
    return cases_of(plant, places, quantities(payload, "kg", "--payload"), point.linearised_at)


def quantities(text: str, unit: str, where: str) -> tuple[float, ...]:
    """Values between commas, SI.

    Raises:
        InputError: not a quantity of that unit.
    """
    return tuple(parse(part.strip(), unit, where) for part in text.split(",")) if text.strip() else ()


def _range(text: str) -> tuple[float, float]:
    ends = quantities(text, "Hz", "--range")
    if len(ends) != 2:
        raise InputError(f'"{text}" is not two frequencies', "--range", 'write e.g. "1 Hz,2 kHz"')
    low, high = ends
    refuse_no_range(low, high)
    return low, high


def _families(plant: Plant, request: Request, cases: tuple[Case, ...], low: float, high: float) -> list[Family]:
    if not request.loop and not request.scenario:
        given, output = request.given or INPUTS[0], request.output or OUTPUTS[1]
        return [mechanics_family(plant, given, output, cases, low, high)]
    return _loop_families(plant, request, cases, low, high)


def _loop_families(plant: Plant, request: Request, cases: tuple[Case, ...], low: float, high: float) -> list[Family]:
    if request.recording is not None:
        raise InputError("a recording is laid over the mechanics, not over loops", "--recording", "leave out --loop")
    if (request.loop or "open") not in _LOOPS:
        raise InputError(f'"{request.loop}" is not possible', "--loop", nearest(request.loop, _LOOPS))
    if not request.scenario:
        mend = "name a scenario or controller file by --scenario, such as step_position"
        raise InputError("a loop needs a controller", "--loop", mend)
    cascade = read_controller(find_scenario_or_controller(request.scenario), plant)
    if request.loop == "closed":
        return _closed(plant, cascade, request, cases, low, high)
    if request.given or request.output:
        raise InputError("an open loop has no --from or --to", "--loop open", "leave them out, or write --loop closed")
    found = [open_family(plant, cascade, loop, cases, low, high) for loop in loops_of(cascade)]
    unstable = any(curve.margins is not None and not curve.margins.stable for one in found for curve in one.curves)
    if unstable:
        for case in cases:
            refuse_unstable_case(plant, cascade, case, request.scenario)
    return found


def _closed(
    plant: Plant, cascade: Cascade, request: Request, cases: tuple[Case, ...], low: float, high: float
) -> list[Family]:
    for case in cases:
        refuse_unstable_case(plant, cascade, case, request.scenario)
    if request.given or request.output:
        given, output = request.given or "position", request.output or "table_position"
        return [controlled_family(plant, cascade, given, output, cases, low, high)]
    return [closed_family(plant, cascade, loop, cases, low, high) for loop in loops_of(cascade)]


def _measured(request: Request) -> Measured | None:
    if request.recording is None:
        return None
    given, output = request.given or INPUTS[0], request.output or OUTPUTS[1]
    found = read_frequency_response(request.recording)
    if found is not None:
        return _in_si(found, given, output)
    return recorded_response(read_recording(request.recording, request.mapping), given, output)


def _in_si(found: FrequencyResponse, given: str, output: str) -> Measured:
    """The response of a file, if it is from and to the signals of the plot.

    Raises:
        InputError: other signals, or a magnitude of another unit or of none.
    """
    if (found.given, found.output) != (given, output):
        what = f"is the response from {found.given} to {found.output}, the plot is from {given} to {output}"
        raise InputError(what, found.source, "choose --from and --to, or correct the first line of the file")
    if not found.unit:
        mend = f"write it in the header: magnitude [({UNITS[output]})/({UNITS[given]})]"
        raise InputError("the magnitude has no unit", found.source, mend)
    conversion = unit_conversion(found.unit, f"({UNITS[output]})/({UNITS[given]})", f"{found.source}, magnitude")
    shown = found.positive
    values: Any = shown.values * conversion.factor
    return Measured(shown.frequency, values, shown.coherence, 0)


def _content(plant: Plant, families: list[Family], measured: Measured | None) -> dict[str, Any]:
    """Everything, SI; frequencies in Hz, magnitudes in dB, phases in degrees."""
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "name": plant.name,
        "structure": plant.chain.structure,
        "responses": [family_content(family) for family in families],
        "measured": _measured_content(measured) if measured else None,
    }
    return content


def _measured_content(measured: Measured) -> dict[str, Any]:
    return measured_content(measured.frequency, measured.response.astype(np.complex128), measured.coherence)


def _write(families: list[Family], measured: Measured | None, content: dict[str, Any], out: Path) -> None:
    from feeddrive.report.figures.drawing import render
    from feeddrive.report.figures.figure_bode import bode_figure

    for family in families:
        drawn = render(bode_figure(family, measured))
        write_bytes_atomically(out / f"{drawn.stem}.png", drawn.png)
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_text_atomically(out / "bode.json", text)
