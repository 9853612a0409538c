"""Values put into the text of a plant file, each with what is known of it and where that is from.

Comments and order are kept; the text is read again to check it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.numbers.declared_values import DeclaredValue
from feeddrive.errors import InputError
from feeddrive.schema.toml_text import parse_toml
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity, parse, percent

_HEADER = re.compile(r"^\s*\[([^\[\]]+)\]\s*(#.*)?$")
_LIST_HEADER = re.compile(r"^\s*\[\[([^\[\]]+)\]\]\s*(#.*)?$")
SOURCE = "calibrated by recordings"

TOLD = 0.01
"""Deviations by which a measurement must move a value for it to be written: less is no news, and moves no number by as
much as a hundredth of what its tolerance does."""


def with_calibrated_values(text: str, results: Sequence[CalibratedResult]) -> str:
    """The text with the calibrated values in place of the declared ones.

    Values are written in full: what is known of a sum of two inertias is more than what is known of either, and
    rounding one would lose it. The tolerance is that of the value alone, half its 95 % interval.

    Args:
        text: of the declared plant's file.
        results: what was calibrated.

    Raises:
        InputError: a text in which a value cannot be placed.
    """
    changed = {}
    entries = parse_toml(text, "declared plant")
    for one in results:
        factor, half = one.value / one.declared, 0.5 * (one.ci95[1] - one.ci95[0]) / one.value
        for key, unit, declared in one.written:
            number = f"{factor * declared!r} {unit}".removesuffix(" 1")
            was = format_quantity(declared, unit)
            key, number = _in_guide(entries, key, number, factor)
            changed[key] = (number, f"{100 * half:.2g} %", f"{SOURCE}, declared {was} within {percent(one.tolerance)}")
    return with_written_values(text, changed) if changed else text


def _in_guide(entries: Mapping[str, object], key: str, number: str, factor: float) -> tuple[str, str]:
    """Key and value of a friction that is computed from [guide]; as they are where it is not."""
    guide = entries.get("guide")
    if not key.startswith("effect.guide_friction.") or not isinstance(guide, Mapping):
        return key, number
    if key.endswith(".smoothing_velocity"):
        return "guide.smoothing_velocity", number
    present = guide.get("friction_factor", 1.0)
    present = present.get("value", 1.0) if isinstance(present, Mapping) else present
    return "guide.friction_factor", repr(factor * parse(present, "1", "guide.friction_factor"))


def most_likely_values(
    values: Sequence[DeclaredValue], coordinates: FloatArray, deviations: FloatArray, source: str
) -> dict[str, tuple[str, str, str]]:
    """Declared values as a measurement moved them: dotted key to value, tolerance and source.

    Values are written in full, as those of parts that share a compliance are known together far better than alone. Left
    out are those of which the measurement tells nothing: it moved them by less than a hundredth of their deviation.

    Args:
        values: as declared.
        coordinates: most likely, (k,).
        deviations: of the coordinates, (k,); twice that is the tolerance.
        source: what says so.
    """
    found = {}
    for value, at, deviation in zip(values, coordinates, deviations, strict=True):
        text = value.at(float(at)) if abs(at) > TOLD * value.deviation else None
        if text is not None:
            tolerance = f"{100 * math.expm1(2 * float(deviation)):.2g} %" if not value.missing else "50 %"
            was = "rigid" if value.missing else format_quantity(value.value, value.unit)
            found[value.key] = (text, tolerance, f"{source}, declared {was}")
    return found


def with_written_values(text: str, changed: Mapping[str, tuple[str, str, str]]) -> str:
    """The text with other values.

    Args:
        text: TOML.
        changed: dotted key to value with its unit, tolerance and source; `effect.NAME.key` names an effect.

    Raises:
        InputError: a text in which a value cannot be placed.
    """
    for key, (value, tolerance, source) in changed.items():
        entry = f'{{ value = "{value}", tolerance = "{tolerance}", source = "{source}" }}'
        text = _placed(text, key, entry)
        read = _found(parse_toml(text, "plant with other values"), key)
        if not isinstance(read, Mapping) or read.get("value") != value:
            raise InputError(
                f"{key} cannot be written into this plant file", key, "write it by hand, on a line of its own"
            )
    return text


def _placed(text: str, key: str, entry: str) -> str:
    section, _, last = key.rpartition(".")
    lines = text.splitlines()
    start, end = _section(lines, section)
    assignment = re.compile(rf"^\s*{re.escape(last)}\s*=")
    for place in range(start, end):
        if assignment.match(lines[place]):
            comment = re.search(r"\s#(?=[^\"]*$).*$", lines[place])
            lines[place] = f"{last} = {entry}{comment.group(0) if comment else ''}"
            return "\n".join(lines) + "\n"
    if start == len(lines):
        lines += ["", f"[{section}]"]
        return "\n".join([*lines, f"{last} = {entry}"]) + "\n"
    return "\n".join([*lines[:start], f"{last} = {entry}", *lines[start:]]) + "\n"


def _section(lines: list[str], section: str) -> tuple[int, int]:
    """First line after the section's header and the line after its last; the end of the file where there is none."""
    of_effect = section.startswith("effect.")
    begun = None
    for number, line in enumerate(lines):
        header, listed = _HEADER.match(line), _LIST_HEADER.match(line)
        if begun is not None and (header or listed):
            return begun, number
        if of_effect and begun is None and re.match(rf'^\s*name\s*=\s*"{re.escape(section[7:])}"', line):
            begun = number + 1
        if header and header.group(1).strip() == section:
            begun = number + 1
    return (len(lines), len(lines)) if begun is None else (begun, len(lines))


def _found(entries: Mapping[str, object], key: str) -> object:
    at: object = entries
    for step in key.split("."):
        if isinstance(at, list):
            at = next((one for one in at if isinstance(one, Mapping) and one.get("name") == step), None)
        else:
            at = at.get(step) if isinstance(at, Mapping) else None
    return at
