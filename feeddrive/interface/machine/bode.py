"""Frequency responses of a machine, or of the loops that a controller closes over it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive import __version__
from feeddrive.errors import InputError
from feeddrive.export.point import export_point
from feeddrive.interface.quantities import Quantities, Quantity, quantities
from feeddrive.interface.servo import Servo, cascade_for
from feeddrive.interface.shown import Listing, Shown, finite, write_figures, write_json
from feeddrive.metrology.response import Response as Measured
from feeddrive.metrology.response import recorded_response
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS
from feeddrive.plant.chain.resolution import resolved, resolved_modes
from feeddrive.plant.plant import Plant
from feeddrive.recording.frequency_response import FrequencyResponse
from feeddrive.recording.recording import Recording
from feeddrive.report.figures.figure_bode import magnitude_unit
from feeddrive.report.words.words import chain_remark
from feeddrive.schema.toml_text import nearest
from feeddrive.servo.loop_response import loops_of, refuse_unstable_case
from feeddrive.servo.mechanics_response import UNITS, Case, refuse_no_range
from feeddrive.servo.resonances import on_curve
from feeddrive.servo.response_family import (
    Curve,
    Family,
    closed_family,
    controlled_family,
    family_content,
    measured_content,
    mechanics_family,
    open_family,
)
from feeddrive.tuning.demand import cases_of
from feeddrive.units.quantity import format_quantity, percent, unit_conversion

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure

_STEPS = (1, 2, 3, 5, 7)
"""Frequencies of a decade in the table of numbers; `to_pandas` has all."""

_WIDEST = 4
"""Curves side by side in that table."""


@dataclass(frozen=True, repr=False, eq=False)
class Bode(Shown):
    """Frequency responses, one curve for each position and payload.

    Attributes:
        plant: of which they are.
        families: one of the mechanics, or one for each loop; `curve.response.frequency` [Hz], `.values` (complex, SI).
        chain_valid_to: frequency up to which the chain that simulations use holds [Hz].
        highest: frequency that was asked for [Hz].
        measured: response of a recording, laid over the mechanics.
    """

    plant: Plant
    families: tuple[Family, ...]
    chain_valid_to: float
    highest: float
    measured: Measured | None = None

    @property
    def curves(self) -> tuple[Curve, ...]:
        """One per position and payload, of each family in turn."""
        return tuple(curve for family in self.families for curve in family.curves)

    def listing(self) -> Listing:
        """Margins of open loops, bandwidths of closed ones, resonances of the mechanics; records hold the curves."""
        title = f"{self.plant.name}: {self.families[0].title}"
        resonances, margins, closed, numbers = _family_tables(title, self.families[0])
        first = next(one for one in (margins, closed, resonances, numbers) if one.rows)
        records = [
            {
                "response": family.title,
                "case": case_text(curve.case),
                "frequency [Hz]": float(f),
                "magnitude [dB]": float(magnitude),
                "phase [deg]": float(phase),
            }
            for family in self.families
            for curve in family.curves
            for f, magnitude, phase in zip(
                curve.response.frequency,
                curve.response.decibel,
                np.degrees(np.unwrap(np.angle(curve.response.values))),
                strict=True,
            )
        ]
        return Listing(title, first.headings, first.rows, records)

    def tables(self) -> tuple[Listing, ...]:
        """Resonances, margins, figures of closed loops, and the response in numbers, of every family."""
        found = [
            one
            for family in self.families
            for one in _family_tables(f"{self.plant.name}: {family.title}", family)
            if one.rows
        ]
        if self.highest > self.chain_valid_to:
            last = found[-1]
            found[-1] = Listing(last.title, last.headings, last.rows, caption=chain_remark(self.chain_valid_to))
        return tuple(found)

    def record(self) -> dict[str, Any]:
        """Everything as plain values: Hz, dB, degrees, else SI."""
        measured = self.measured
        return {
            "format": "feeddrive-bode/1",
            "version": __version__,
            "name": self.plant.name,
            "structure": self.plant.chain.structure,
            "responses": [family_content(family) for family in self.families],
            "measured": None
            if measured is None
            else measured_content(measured.frequency, measured.response.astype(np.complex128), measured.coherence),
            "chain_valid_to": finite(self.chain_valid_to),
        }

    def save(self, folder: str | Path) -> Path:
        """Write `bode.json` and a figure for each family.

        Raises:
            InputError: the folder cannot be written.
        """
        place = Path(folder)
        write_figures(self._figures(), place)
        write_json(self.record(), place / "bode.json", indent=1)
        return place

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_bode import bode_figure

        return [bode_figure(family, self.measured) for family in self.families]


def operating_cases(
    plant: Plant,
    at: str,
    positions: Quantities,
    payload: Quantities,
) -> tuple[Case, ...]:
    """Every position with every payload, at the velocity of an operating point.

    Raises:
        InputError: a point off the stroke, positions that are given twice, or a value that cannot be used.
    """
    point = export_point(plant, at, "at")
    if positions and "x" in [part.split("=")[0].strip() for part in at.split(",")]:
        raise InputError("positions are given twice", "--positions, --at x", "keep one of them")
    places = quantities(positions, "m", "positions") or (point.position,)
    return cases_of(plant, places, quantities(payload, "kg", "payload"), point.linearised_at)


def frequency_range(frequencies: Sequence[Quantity]) -> tuple[float, float]:
    """Lowest and highest frequency [Hz].

    Raises:
        InputError: not two frequencies, or no range.
    """
    ends = quantities(frequencies, "Hz", "frequencies")
    if len(ends) != 2:
        raise InputError(
            f'"{", ".join(map(str, frequencies))}" is not two frequencies', "frequencies", 'write e.g. "1 Hz,2 kHz"'
        )
    refuse_no_range(*ends)
    return ends[0], ends[1]


def mechanics_bode(
    plant: Plant, given: str, output: str, cases: tuple[Case, ...], ends: tuple[float, float],
    measured: Recording | FrequencyResponse | None,
) -> Bode:  # fmt: skip
    """Responses of the mechanics from an input to an output, and a measured one laid over them."""
    fine, valid_to = _resolved(plant, cases, ends[1])
    given, output = given or INPUTS[0], output or OUTPUTS[1]
    laid = None if measured is None else _laid_over(measured, given, output)
    return Bode(plant, (mechanics_family(fine, given, output, cases, *ends),), valid_to, ends[1], laid)


def _resolved(plant: Plant, cases: tuple[Case, ...], highest: float) -> tuple[Plant, float]:
    """The machine with a chain that holds up to a frequency, and up to which the declared chain does [Hz]."""
    valid_to = min(resolved_modes(plant, case.position).chain_valid_to for case in cases)
    return resolved(plant, highest, [case.position for case in cases]), valid_to


def loops_bode(
    plant: Plant, given: str, output: str, cases: tuple[Case, ...], ends: tuple[float, float],
    controller: Servo | str | Path | None, loop: str,
) -> Bode:  # fmt: skip
    """Responses of the loops that a controller closes."""
    fine, valid_to = _resolved(plant, cases, ends[1])
    return Bode(plant, _loops(fine, given, output, controller, loop, cases, *ends), valid_to, ends[1])


def _loops(
    plant: Plant, given: str, output: str, controller: Servo | str | Path | None, wanted: str,
    cases: tuple[Case, ...], low: float, high: float,
) -> tuple[Family, ...]:  # fmt: skip
    """Every loop, open or closed; one of them open; or the controlled axis between two signals."""
    kind = wanted or "open"
    if kind not in (known := ("open", "closed", "velocity", "position")):
        raise InputError(f'"{wanted}" is not possible', "loop", nearest(wanted, known))
    if controller is None:
        mend = "name a scenario or controller file by --scenario, such as step_position"
        raise InputError("a loop needs a controller", "loop", mend)
    cascade = cascade_for(plant, controller)
    loops = loops_of(cascade)
    name = controller if isinstance(controller, str | Path) else "controller"
    if kind == "closed":
        for case in cases:
            refuse_unstable_case(plant, cascade, case, str(name))
        if given or output:
            signals = given or "position", output or "table_position"
            return (controlled_family(plant, cascade, *signals, cases, low, high),)
        return tuple(closed_family(plant, cascade, one, cases, low, high) for one in loops)
    if given or output:
        raise InputError("an open loop has no --from or --to", "loop", "leave them out, or ask for the closed one")
    if kind != "open":
        loops = tuple(one for one in loops if str(one) == kind)
        if not loops:
            raise InputError(f"the controller closes no {kind} loop", "loop", "give it a position_gain")
    found = tuple(open_family(plant, cascade, one, cases, low, high) for one in loops)
    if any(curve.margins is not None and not curve.margins.stable for one in found for curve in one.curves):
        for case in cases:
            refuse_unstable_case(plant, cascade, case, str(name))
    return found


def _laid_over(measured: Recording | FrequencyResponse, given: str, output: str) -> Measured:
    """The response of a recording, or of a file if it is from and to the signals of the plot.

    Raises:
        InputError: other signals, or a magnitude of another unit or of none.
    """
    if isinstance(measured, Recording):
        return recorded_response(measured, given, output)
    if (measured.given, measured.output) != (given, output):
        what = f"is the response from {measured.given} to {measured.output}, the plot is from {given} to {output}"
        raise InputError(what, measured.source, "choose --from and --to, or correct the first line of the file")
    unit = f"({UNITS[output]})/({UNITS[given]})"
    if not measured.unit:
        raise InputError("the magnitude has no unit", measured.source, f"write it in the header: magnitude [{unit}]")
    conversion = unit_conversion(measured.unit, unit, f"{measured.source}, magnitude")
    shown = measured.positive
    values: Any = shown.values * conversion.factor
    return Measured(shown.frequency, values, shown.coherence, 0)


def case_text(case: Case) -> str:
    """A position and payload in words."""
    load = f", {case.payload:+g} kg" if case.payload else ""
    return f"{format_quantity(case.position, 'm')}{load}"


def _family_tables(title: str, family: Family) -> tuple[Listing, ...]:
    unit, more = magnitude_unit(family.curves[0].response.unit)
    suffix = "" if unit == "1" else f", {unit}"
    margins = [
        [
            case_text(curve.case),
            f"{_digits(m.gain)} dB",
            f"{_digits(m.gain_frequency)} Hz",
            f"{_digits(m.phase)}°",
            f"{_digits(m.phase_frequency)} Hz",
            f"{m.sensitivity:.2f}" if m.stable else "unstable",
        ]
        for curve in family.curves
        if (m := curve.margins) is not None
    ]
    closed = [
        [case_text(curve.case), f"{_digits(c.bandwidth)} Hz", f"{c.peak:.2f} dB", f"{_digits(c.peak_frequency)} Hz"]
        for curve in family.curves
        if (c := curve.closed) is not None
    ]
    headings = ("table at", "gain margin", "at", "phase margin", "at", "sensitivity peak")
    return (
        _resonances(title, family, suffix, more),
        Listing(f"{title}, margins", headings, margins),
        Listing(title, ("table at", "bandwidth, -3 dB", "peak", "at"), closed),
        _numbers(title, family, suffix, more),
    )


def _resonances(title: str, family: Family, suffix: str, more: float) -> Listing:
    """Poles and zeros of the mechanics, each with its extremum of the curve; of loops the extrema alone."""
    if not any(curve.response.marks for curve in family.curves):
        rows = [
            [case_text(curve.case), str(one.kind), f"{one.frequency:.1f} Hz", f"{one.decibel + more:.1f} dB"]
            for curve in family.curves
            for one in curve.seen
        ]
        return Listing(f"{title}, peaks and dips", ("table at", "kind", "at", f"magnitude{suffix}"), rows)
    rows = []
    for curve in family.curves:
        for root in curve.response.marks:
            seen = on_curve(root, curve.seen)
            place = [f"{seen.frequency:.1f} Hz", f"{seen.decibel + more:.1f} dB"] if seen else ["not seen", ""]
            natural = [f"{root.frequency:.1f} Hz", percent(root.damping, 2)]
            rows.append([case_text(curve.case), str(root.kind), *natural, *place])
    headings = ("table at", "kind", "natural", "damping", "on the curve", f"magnitude{suffix}")
    return Listing(f"{title}, resonances", headings, rows)


def _numbers(title: str, family: Family, suffix: str, more: float) -> Listing:
    shown = family.curves[:_WIDEST]
    frequency = shown[0].response.frequency
    decades = range(math.floor(math.log10(frequency[0])), math.ceil(math.log10(frequency[-1])) + 1)
    wanted = [step * 10.0**decade for decade in decades for step in _STEPS]
    inside = [f for f in wanted if frequency[0] * (1 - 1e-9) <= f <= frequency[-1] * (1 + 1e-9)]
    headings = ["frequency", *(text for curve in shown for text in (f"{case_text(curve.case)}{suffix}", "phase"))]
    return Listing(
        title, headings, [[f"{f:g} Hz", *(c for curve in shown for c in _at(curve, f, more))] for f in inside]
    )


def _at(curve: Curve, frequency: float, more: float) -> tuple[str, str]:
    response = curve.response
    place, where = np.log(response.frequency), math.log(frequency)
    values = np.interp(where, place, response.decibel) + more
    phase = np.interp(where, place, np.unwrap(response.degrees, period=360))
    return f"{values:.2f} dB", f"{(phase + 180) % 360 - 180:.1f}°"


def _digits(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "–"
