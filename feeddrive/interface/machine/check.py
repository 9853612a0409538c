"""What a declared machine is asked for: rules of plausibility, and the life of its ball screw, rated and used."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from feeddrive.interface.shown import Listing, Shown, finite
from feeddrive.parts.life.consumed_life import ConsumedLife
from feeddrive.parts.life.life_exponents import BALL_SCREW
from feeddrive.plant.analysis.plausibility import Finding, Verdict
from feeddrive.plant.analysis.rated_life import LifeRow, datum
from feeddrive.plant.plant import Plant
from feeddrive.report.words.number_text import scale_for_share_of_life
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    from feeddrive.report.figures.drawing import ReportFigure


_DN, _DN_SHOWN = "m rad/s", "mm rev/min"
"""Unit of the DN value, inside and as catalogues count it."""


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
        count = len(self.warnings)
        title = f"{self.axis_name}: {count or 'no'} warning{'s' * (count != 1)}"
        rows = [_row(one) for one in self.findings]
        return Listing(title, ("rule", "value", "limit", "verdict", "source"), rows, records)

    def record(self) -> dict[str, Any]:
        """Everything as plain values, SI."""
        rules = [
            {**asdict(one), "sense": one.sense.name.lower(), "verdict": one.verdict.value} for one in self.findings
        ]
        return {
            "format": "feeddrive-check/1",
            "name": self.axis_name,
            "warnings": len(self.warnings),
            "rules": rules,
        }


def _row(one: Finding) -> list[str]:
    """A rule as catalogues write it: the DN value as a number alone, its unit beside the rule."""
    rule = f"{one.rule} [{_DN_SHOWN}]" if one.unit == _DN else one.rule
    value = "" if one.value is None else _amount(one.value, one.unit)
    limit = "" if one.limit is None else f"{one.sense.value} {_amount(one.limit, one.unit)}"
    return [rule, value, limit, one.verdict.value, one.source]


def _amount(value: float, unit: str) -> str:
    return f"{value * 1e3 * 30 / math.pi:.0f}" if unit == _DN else format_quantity(value, unit)


RATED = "rated life of the ball screw, survived by 90 %"

_HOUR, _KILOMETRE, _MILLION = 3600.0, 1e3, 1e6


@dataclass(frozen=True, repr=False, eq=False)
class Life(Shown):
    """Rated life of the ball screw, survived by 90 %, by preload alone and at the declared axial load.

    Attributes:
        axis_name: of the machine.
        rows: one per load; none where no dynamic rating is declared.
        plant: of which it is the answer.
    """

    axis_name: str
    rows: Sequence[LifeRow]
    plant: Plant

    def listing(self) -> Listing:
        """One row per load."""
        records = [
            {
                "force [N]": one.force,
                "nut + [N]": one.nut_loads[0],
                "nut − [N]": one.nut_loads[1],
                "revolutions": one.revolutions,
                "travel [m]": one.travel,
                "time [s]": one.time,
            }
            for one in self.rows
        ]
        rows = [
            [
                format_quantity(one.force, "N") if one.force else "preload alone",
                *(format_quantity(load, "N") for load in one.nut_loads),
                _digits(one.revolutions / _MILLION),
                f"{_digits(one.travel / _KILOMETRE)} km",
                "" if one.time is None else f"{_digits(one.time / _HOUR)} h",
            ]
            for one in self.rows
        ]
        headings = ("axial force", "load of nut +", "of nut −", "10⁶ rev", "travel", "at greatest velocity")
        title = f"{self.axis_name}: {RATED}"
        if not self.rows:
            title += " (not known: ball_screw.dynamic_rating is not declared)"
        return Listing(title, headings, rows, records)

    def _figures(self) -> Sequence[ReportFigure]:
        from feeddrive.report.figures.figure_parts import life_figure

        return () if datum(self.plant, "ball_screw.dynamic_rating") is None else (life_figure(self.plant),)


@dataclass(frozen=True, repr=False, eq=False)
class UsedLife(Shown):
    """What a motion takes of the life of each nut of the ball screw.

    Attributes:
        name: of the run or the recording.
        time: of its samples, (n,) [s].
        used: along the samples; None where no dynamic rating is declared, or no force of a nut is known.
    """

    name: str
    time: FloatArray
    used: ConsumedLife | None

    def listing(self) -> Listing:
        """One row per nut, then how often 90 % survive the motion."""
        title = f"{self.name}: life of the ball screw that it takes"
        headings = ("nut", "load over the turns", "greatest load", "used of its rated life")
        if self.used is None:
            return Listing(f"{title} (not known: ball_screw.dynamic_rating is not declared)", headings, [])
        records = [
            {"nut": name, "equivalent load [N]": equivalent, "greatest load [N]": greatest, "used [1]": share}
            for name, equivalent, greatest, share in zip(
                ("nut +", "nut −"),
                self.used.equivalent.tolist(),
                self.used.forces.max(axis=1).tolist(),
                self.used.total.tolist(),
                strict=True,
            )
        ]
        scale = scale_for_share_of_life(float(self.used.total.max()))
        rows = [
            [
                str(one["nut"]),
                *(format_quantity(one[key], "N") for key in ("equivalent load [N]", "greatest load [N]")),
                f"{_digits(scale.factor * one['used [1]'])} {scale.unit}",
            ]
            for one in records
        ]
        rows.append(["both", "", "", f"survived by 90 % {_times(self.used.repetitions)} times"])
        turned = float(self.used.revolutions[-1])
        caption = (
            f"{_digits(turned)} revolutions of the screw. Load over the turns: the constant load that takes as much "
            f"life (mean to the power {BALL_SCREW.load:g}), preload included."
        )
        return Listing(title, headings, rows, [*records, {"repetitions": finite(self.used.repetitions)}], caption)

    def record(self) -> dict[str, Any] | None:
        """Loads, shares of life and repetitions of the motion, SI; None where nothing is known."""
        if self.used is None:
            return None
        return {
            "recording": self.name,
            "revolutions": float(self.used.revolutions[-1]),
            "equivalent_loads": self.used.equivalent.tolist(),
            "greatest_loads": self.used.forces.max(axis=1).tolist(),
            "used": self.used.total.tolist(),
            "repetitions": finite(self.used.repetitions),
        }

    def _figures(self) -> Sequence[ReportFigure]:
        if self.used is None:
            return ()
        from feeddrive.report.figures.figure_parts import used_life_figure

        return (used_life_figure(self.time, self.used),)


def _times(value: float) -> str:
    """How often, in millions where it is often."""
    return f"{_digits(value / _MILLION)} million" if math.isfinite(value) and value >= _MILLION else _digits(value)


def _digits(value: float) -> str:
    """Three digits and no power of ten, which nobody reads in hours and kilometres."""
    return f"{float(f'{value:.3g}'):.15g}"
