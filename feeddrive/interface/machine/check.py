"""Rules of plausibility of a machine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from feeddrive.interface.shown import Listing, Shown
from feeddrive.plant.analysis.plausibility import Finding, Verdict
from feeddrive.units.quantity import format_quantity

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
