"""Frequency responses of an axis as a result that shows itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.interface.shown import Listing, Shown
from feeddrive.servo.frequency_response import Case
from feeddrive.servo.response_family import Curve, Family
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class Bode(Shown):
    """Frequency responses, one curve for each position and payload.

    Attributes:
        axis_name: of the machine.
        family: the curves: `curve.response.frequency` [Hz] and `.values` (complex, SI), peaks, margins of open loops.
    """

    axis_name: str
    family: Family

    @property
    def curves(self) -> tuple[Curve, ...]:
        """One per position and payload."""
        return self.family.curves

    def listing(self) -> Listing:
        """Margins of open loops, bandwidths of closed ones, peaks and dips of the mechanics."""
        headings, rows = self._rows()
        records = [
            {"case": case_text(curve.case), "frequency [Hz]": float(f), "magnitude [dB]": float(dB),
             "phase [deg]": float(degrees)}
            for curve in self.curves
            for f, dB, degrees in zip(curve.response.frequency, curve.response.decibel,
                                      np.degrees(np.unwrap(np.angle(curve.response.values))), strict=True)
        ]  # fmt: skip
        return Listing(f"{self.axis_name}: {self.family.title}", headings, rows, records)

    def _rows(self) -> tuple[Sequence[str], list[list[str]]]:
        if self.curves[0].margins is not None:
            rows = [
                [case_text(curve.case), f"{m.gain:.3g} dB", f"{m.gain_frequency:.3g} Hz", f"{m.phase:.3g}°",
                 f"{m.phase_frequency:.3g} Hz", f"{m.sensitivity:.2f}" if m.stable else "unstable"]
                for curve in self.curves if (m := curve.margins) is not None
            ]  # fmt: skip
            return ("table at", "gain margin", "at", "phase margin", "at", "sensitivity peak"), rows
        if self.curves[0].closed is not None:
            rows = [
                [case_text(curve.case), f"{c.bandwidth:.3g} Hz", f"{c.peak:.2f} dB", f"{c.peak_frequency:.3g} Hz"]
                for curve in self.curves if (c := curve.closed) is not None
            ]  # fmt: skip
            return ("table at", "bandwidth, -3 dB", "peak", "at"), rows
        rows = [
            [case_text(curve.case), str(one.kind), f"{one.frequency:.1f} Hz", f"{one.decibel:.1f} dB"]
            for curve in self.curves for one in curve.seen
        ]  # fmt: skip
        return ("table at", "kind", "at", "magnitude [dB, SI]"), rows

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_bode import bode_figure

        return (bode_figure(self.family),)


def case_text(case: Case) -> str:
    """A position and payload in words."""
    load = f", {case.payload:+g} kg" if case.payload else ""
    return f"{format_quantity(case.position, 'm')}{load}"
