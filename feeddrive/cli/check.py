"""`feeddrive check PLANT`: rules of plausibility, each with value, limit, verdict and source."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from feeddrive.cli.output import JsonOption, OutOption, deliver, table, warnings_as_lines
from feeddrive.errors import InputError
from feeddrive.interface.axis import load
from feeddrive.plant.analysis.plausibility import Finding, Verdict
from feeddrive.units.quantity import format_quantity, parse

_DN, _DN_SHOWN = "m rad/s", "mm rev/min"
"""Unit of the DN value, inside and as catalogues count it."""


def command(
    plant: Annotated[str, typer.Argument(help="Plant file, or the name of a shipped machine.")],
    position_gain: Annotated[
        str, typer.Option(help="Position gain of the controller, such as '50 1/s'; the declared one if left out.")
    ] = "",
    as_json: JsonOption = False,
    out: OutOption = None,
) -> None:
    """Check a machine against rules of plausibility; warnings do not change the exit status."""
    with warnings_as_lines():
        axis = load(plant)
        findings = axis.check(_gain(position_gain) if position_gain else None).findings
    broken = sum(finding.verdict is Verdict.BROKEN for finding in findings)
    content = {
        "format": "feeddrive-check/1",
        "name": axis.name,
        "warnings": broken,
        "rules": [_content(finding) for finding in findings],
    }
    shown = table(f"{axis.name}: {broken or 'no'} warning{'s' * (broken != 1)}",
                  ("rule", "value", "limit", "verdict", "source"), [_row(finding) for finding in findings])  # fmt: skip
    shown.columns[0].min_width = 14  # no word of a rule is longer; more would not leave 80 letters enough for the rest
    deliver(content, [shown], as_json, out)


def _gain(text: str) -> float:
    """A position gain [1/s].

    Raises:
        InputError: no gain, or one that is not above zero.
    """
    gain = parse(text, "1/s", "--position-gain")
    if gain <= 0.0:
        raise InputError(f"{text} is no gain", "--position-gain", "write one above zero, such as '50 1/s'")
    return gain


def _content(finding: Finding) -> dict[str, Any]:
    return {
        "rule": finding.rule,
        "value": finding.value,
        "limit": finding.limit,
        "unit": finding.unit,
        "sense": finding.sense.name.lower(),
        "verdict": finding.verdict.value,
        "source": finding.source,
    }


def _row(finding: Finding) -> list[str]:
    value = "" if finding.value is None else _shown(finding.value, finding.unit)
    limit = "" if finding.limit is None else f"{finding.sense.value} {_shown(finding.limit, finding.unit)}"
    rule = f"{finding.rule} [{_DN_SHOWN}]" if finding.unit == _DN else finding.rule
    return [rule, value, limit, finding.verdict.value, finding.source]


def _shown(number: float, unit: str) -> str:
    """As it is written in catalogues: the DN value as a number alone, its unit stands beside the rule."""
    if unit == _DN:
        return f"{number * 1e3 * 30 / math.pi:.0f}"
    return format_quantity(number, unit)
