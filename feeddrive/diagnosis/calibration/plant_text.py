"""A plant file with its declared values as calibrated, each with what is now known of it and where that is from."""

from __future__ import annotations

from collections.abc import Sequence

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.numbers.plant_text import with_written_values
from feeddrive.units.quantity import format_quantity

SOURCE = "calibrated by recordings"


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
    for one in results:
        factor, half = one.value / one.declared, 0.5 * (one.ci95[1] - one.ci95[0]) / one.value
        for key, unit, declared in one.written:
            number = f"{factor * declared!r} {unit}".removesuffix(" 1")
            was = format_quantity(declared, unit)
            changed[key] = (number, f"{100 * half:.2g} %", f"{SOURCE}, declared {was} within {one.tolerance:.0%}")
    return with_written_values(text, changed) if changed else text
