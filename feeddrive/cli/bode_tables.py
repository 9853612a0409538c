"""Tables of `feeddrive bode`: resonances, margins, figures of closed loops, and the response in numbers."""

from __future__ import annotations

import math

import numpy as np
from rich.table import Table

from feeddrive.cli.output import table
from feeddrive.report.figures.figure_bode import magnitude_unit
from feeddrive.servo.frequency_response import Case
from feeddrive.servo.resonances import Resonance, on_curve
from feeddrive.servo.response_family import Curve, Family
from feeddrive.units.quantity import format_quantity

_STEPS = (1, 2, 3, 5, 7)
_WIDEST = 4
"""Curves side by side in a table of numbers; JSON has all."""


def family_tables(name: str, family: Family) -> list[Table]:
    """The tables of a family; those without rows are left out."""
    title = f"{name}: {family.title}"
    tables = [_roots(title, family), _margins(title, family), _closed(title, family), _numbers(title, family)]
    return [shown for shown in tables if shown.row_count]


def describe(case: Case) -> str:
    """A case in a cell."""
    load = f", {case.payload:+g} kg" if case.payload else ""
    return f"{format_quantity(case.position, 'm')}{load}"


def _roots(title: str, family: Family) -> Table:
    """Poles and zeros of the mechanics, each with its extremum of the curve; of loops the extrema alone."""
    unit, more = magnitude_unit(family.curves[0].response.unit)
    magnitude = f"magnitude{_suffix(unit)}"
    if not any(curve.response.marks for curve in family.curves):
        rows = [
            [describe(curve.case), str(one.kind), f"{one.frequency:.1f} Hz", f"{one.decibel + more:.1f} dB"]
            for curve in family.curves for one in curve.seen
        ]  # fmt: skip
        return table(f"{title}, peaks and dips", ("table at", "kind", "at", magnitude), rows)
    rows = [_root_row(curve, root, more) for curve in family.curves for root in curve.response.marks]
    headings = ("table at", "kind", "natural", "damping", "on the curve", magnitude)
    return table(f"{title}, resonances", headings, rows)


def _root_row(curve: Curve, root: Resonance, more: float) -> list[str]:
    seen = on_curve(root, curve.seen)
    place = [f"{seen.frequency:.1f} Hz", f"{seen.decibel + more:.1f} dB"] if seen else ["not seen", ""]
    return [describe(curve.case), str(root.kind), f"{root.frequency:.1f} Hz", f"{root.damping:.2%}", *place]


def _suffix(unit: str) -> str:
    return "" if unit == "1" else f", {unit}"


def _margins(title: str, family: Family) -> Table:
    rows = [
        [describe(curve.case), f"{_number(m.gain)} dB", f"{_number(m.gain_frequency)} Hz", f"{_number(m.phase)}°",
         f"{_number(m.phase_frequency)} Hz", f"{m.sensitivity:.2f}" if m.stable else "unstable"]
        for curve in family.curves if (m := curve.margins) is not None
    ]  # fmt: skip
    headings = ("table at", "gain margin", "at", "phase margin", "at", "sensitivity peak")
    return table(f"{title}, margins", headings, rows)


def _closed(title: str, family: Family) -> Table:
    rows = [
        [describe(curve.case), f"{_number(c.bandwidth)} Hz", f"{c.peak:.2f} dB", f"{_number(c.peak_frequency)} Hz"]
        for curve in family.curves if (c := curve.closed) is not None
    ]  # fmt: skip
    return table(f"{title}", ("table at", "bandwidth, -3 dB", "peak", "at"), rows)


def _numbers(title: str, family: Family) -> Table:
    shown = family.curves[:_WIDEST]
    unit, more = magnitude_unit(shown[0].response.unit)
    frequency = shown[0].response.frequency
    decades = range(math.floor(math.log10(frequency[0])), math.ceil(math.log10(frequency[-1])) + 1)
    wanted = [step * 10.0**decade for decade in decades for step in _STEPS]
    inside = [f for f in wanted if frequency[0] * (1 - 1e-9) <= f <= frequency[-1] * (1 + 1e-9)]
    headings = ["frequency", *(text for curve in shown for text in (f"{describe(curve.case)}{_suffix(unit)}", "phase"))]
    rows = [[f"{f:g} Hz", *(cell for curve in shown for cell in _at(curve, f, more))] for f in inside]
    return table(title, headings, rows)


def _at(curve: Curve, frequency: float, more: float) -> tuple[str, str]:
    response = curve.response
    place = np.log(response.frequency)
    values = np.interp(math.log(frequency), place, response.decibel) + more
    phase = np.interp(math.log(frequency), place, np.unwrap(response.degrees, period=360))
    return f"{values:.2f} dB", f"{(phase + 180) % 360 - 180:.1f}°"


def _number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "–"
