"""Tables that a machine answers with: natural frequencies, stiffness budget, rules of plausibility, rated life."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from feeddrive.interface.shown import Listing, Shown
from feeddrive.plant.analysis.mode_map import ModeMap
from feeddrive.plant.analysis.plausibility import Finding, Verdict
from feeddrive.plant.analysis.rated_life import LifeRow
from feeddrive.plant.analysis.stiffness_budget import StiffnessBudget
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


@dataclass(frozen=True, repr=False, eq=False)
class Modes(Shown):
    """Natural frequencies along the stroke.

    Attributes:
        axis_name: of the machine.
        map: everything that was computed, SI.
        plant: of which it is the answer; drawn along its stroke.
    """

    axis_name: str
    map: ModeMap
    plant: Plant

    @property
    def positions(self) -> FloatArray:
        """Table positions [m], shape (n,)."""
        return self.map.positions

    @property
    def held(self) -> FloatArray:
        """Natural frequencies with the motor held [Hz], shape (n, k); the first is the anti-resonance of the loop."""
        return self.map.held

    @property
    def free(self) -> FloatArray:
        """Natural frequencies with the motor free, without the free motion [Hz], shape (n, k)."""
        return self.map.free

    def listing(self) -> Listing:
        """One row per table position."""
        found = self.map
        columns: dict[str, FloatArray] = {"position [m]": found.positions}
        if len(found.stiffness):
            columns["stiffness [N/m]"] = found.stiffness
        for name, values in (("held", found.held), ("free", found.free)):
            columns |= {
                f"{name} f{i} [Hz]": column for i, column in enumerate(np.atleast_2d(values).T, 1) if len(column)
            }
        records = [
            {key: float(values[row]) for key, values in columns.items() if row < len(values)}
            for row in range(len(found.positions))
        ]
        rows = [[format_quantity(value, _unit(key)) for key, value in record.items()] for record in records]
        headings = [key.partition(" [")[0] for key in records[0]]
        return Listing(f"{self.axis_name}: natural frequencies, motor held and free", headings, rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_modes import modes_figure

        drawn = self.plant.chain.varies and self.plant.stroke is not None
        return (modes_figure(self.plant),) if drawn else ()


def _unit(key: str) -> str:
    return key.partition("[")[2].rstrip("]")


@dataclass(frozen=True, repr=False, eq=False)
class Stiffness(Shown):
    """Static stiffness at the table with the motor held, and whose compliance it is.

    Attributes:
        axis_name: of the machine.
        position: of the table [m].
        budget: everything that was computed, SI.
        plant: of which it is the answer; drawn where it is described by parts.
    """

    axis_name: str
    position: float
    budget: StiffnessBudget
    plant: Plant

    def __float__(self) -> float:
        """Combined stiffness [N/m]."""
        return self.budget.total

    @property
    def total(self) -> float:
        """Combined stiffness, motor held [N/m]."""
        return self.budget.total

    def listing(self) -> Listing:
        """One row per part, then axial, torsional and combined."""
        budget = self.budget
        records: list[dict[str, Any]] = [
            {
                "part": one.part,
                "deformation": one.deformation,
                "stiffness [N/m]": 1 / one.compliance,
                "share": one.share,
            }
            for one in budget.parts
        ]
        for name, value, share in (
            ("axial stiffness", budget.axial, budget.axial_share),
            ("torsional stiffness at the table", budget.torsional, budget.torsional_share),
            ("combined stiffness, motor held", budget.total, 1.0),
        ):
            records.append({"part": name, "deformation": "", "stiffness [N/m]": value, "share": share})
        rows = [
            [str(one["part"]), str(one["deformation"]), format_quantity(float(one["stiffness [N/m]"]), "N/m"),
             f"{one['share']:.1%}"]
            for one in records
        ]  # fmt: skip
        title = f"{self.axis_name}: stiffness at the table, at {format_quantity(self.position, 'm')}"
        return Listing(title, ("part", "deformation", "felt at the table", "share of compliance"), rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_stiffness import stiffness_figures

        return stiffness_figures(self.plant, self.position)


@dataclass(frozen=True, repr=False, eq=False)
class Check(Shown):
    """Rules of plausibility, each with value, limit, verdict and source.

    Attributes:
        axis_name: of the machine.
        findings: one per rule.
    """

    axis_name: str
    findings: Sequence[Finding]

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Rules that are broken."""
        return tuple(one for one in self.findings if one.verdict is Verdict.BROKEN)

    def listing(self) -> Listing:
        """One row per rule."""
        records = [{**asdict(one), "sense": one.sense.value, "verdict": one.verdict.value} for one in self.findings]
        rows = [
            [one.rule, _amount(one.value, one.unit), _amount(one.limit, one.unit), one.verdict.value, one.source]
            for one in self.findings
        ]
        count = len(self.warnings)
        title = f"{self.axis_name}: {count or 'no'} warning{'s' * (count != 1)}"
        return Listing(title, ("rule", "value", "limit", "verdict", "source"), rows, records)


def _amount(value: float | None, unit: str) -> str:
    if value is None:
        return ""
    return f"{value * 1e3 * 30 / math.pi:.0f} mm rev/min" if unit == "m rad/s" else format_quantity(value, unit)


@dataclass(frozen=True, repr=False, eq=False)
class Life(Shown):
    """Rated life of the ball screw, survived by 90 %, by preload alone and at the declared axial load.

    Attributes:
        axis_name: of the machine.
        rows: one per load; none where no dynamic rating is declared.
    """

    axis_name: str
    rows: Sequence[LifeRow]

    def listing(self) -> Listing:
        """One row per load."""
        records = [
            {"force [N]": one.force, "nut + [N]": one.nut_loads[0], "nut − [N]": one.nut_loads[1],
             "revolutions": one.revolutions, "travel [m]": one.travel, "time [s]": one.time}
            for one in self.rows
        ]  # fmt: skip
        rows = [
            [format_quantity(one.force, "N") if one.force else "preload alone",
             *(format_quantity(load, "N") for load in one.nut_loads), f"{one.revolutions / 1e6:.3g}",
             f"{one.travel / 1e3:.3g} km", "" if one.time is None else f"{one.time / 3600:.3g} h"]
            for one in self.rows
        ]  # fmt: skip
        headings = ("axial force", "load of nut +", "of nut −", "10⁶ rev", "travel", "at greatest velocity")
        title = f"{self.axis_name}: rated life of the ball screw, survived by 90 %"
        if not self.rows:
            title += " (not known: ball_screw.dynamic_rating is not declared)"
        return Listing(title, headings, rows, records)
