"""Units at the border: "20 mm" in, 0.020 m inside, "20 mm" out.

The angle has a dimension of its own here, so a rotational speed is never taken for a frequency nor the other way
round, and torque (N m) is kept apart from energy (J).
"""

from __future__ import annotations

import math
import re
import sys

from feeddrive.errors import InputError, quoted
from feeddrive.units.conversion import Conversion, UnitError, conversion_between
from feeddrive.units.definitions import EXAMPLE_UNITS
from feeddrive.units.usual_ranges import ABSOLUTE_ZERO, beyond_usual

__all__ = ["Conversion", "format_quantity", "parse", "split_quantity", "unit_conversion", "unit_factor"]

_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)


def parse(
    text: object, unit: str, where: str, usual: tuple[float, float] | None = None, may_vanish: bool = False
) -> float:
    """Return a written quantity in SI.

    Args:
        text: what stands in the file: "20 mm", or for unit "1" also a bare number.
        unit: SI unit that is needed, such as "m", "rad/s", "N m/rad", "degC" (a temperature), "K" (a difference), "1".
        where: file and key, for the message.
        usual: range in which this very key is usual [unit]; that of its unit where it is None.
        may_vanish: whether a value next to zero means the same as zero.

    Raises:
        InputError: bare number for a dimensional quantity, wrong dimension, unknown unit, not a number, more than a
            million times outside of what is usual (`feeddrive.units.usual_ranges`), a temperature below
            the absolute zero.
    """
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise InputError(f"{quoted(text)} is not a quantity", where, _write_it(unit))
    if isinstance(text, int) and abs(text) > sys.float_info.max:
        raise InputError(f"{quoted(text)} is beyond what can be computed with", where, _write_it(unit))
    number, unit_text = _split(str(text), unit, where)
    if not math.isfinite(number):
        raise InputError(f"{quoted(text)} is not a finite number", where, _write_it(unit))
    if not unit_text and unit != "1":
        raise InputError(f"{quoted(text)} is a bare number", where, _write_it(unit, number))
    value = float(unit_conversion(unit_text or "1", unit, where).apply(number))
    if not math.isfinite(value):
        raise InputError(f"{quoted(text)} is beyond what can be computed with", where, _write_it(unit))
    _refuse_what_nobody_means(value, unit, where, beyond_usual(value, unit, usual, may_vanish))
    return value


def split_quantity(text: str, where: str) -> tuple[float, str]:
    """Split "0.5 mm/rad" into 0.5 and "mm/rad", whatever the unit; the unit of a bare number is "1".

    Raises:
        InputError: the text does not begin with a finite number, or holds a decimal comma.
    """
    number, unit_text = _split(text, "1", where)
    if not math.isfinite(number):
        raise InputError(f"{quoted(text)} is not a finite number", where)
    return number, unit_text or "1"


def unit_conversion(unit_text: str, si_unit: str, where: str) -> Conversion:
    """Return the conversion from `unit_text` to `si_unit`, with the offset of degC, degF and K.

    Raises:
        InputError: unknown unit, wrong dimension, or a pair that must not be mixed.
    """
    try:
        return conversion_between(unit_text.strip(), si_unit)
    except UnitError as error:
        raise InputError(error.what, where, error.mend) from None


def unit_factor(unit_text: str, si_unit: str, where: str) -> float:
    """Return the factor from `unit_text` to `si_unit`; a conversion with an offset is refused.

    Raises:
        InputError: as `unit_conversion`, and K or degF for a temperature.
    """
    conversion = unit_conversion(unit_text, si_unit, where)
    if conversion.offset:
        raise InputError(f"{unit_text} and {si_unit} differ by an offset", where, f"write it in {si_unit}")
    return conversion.factor


def format_quantity(value_si: float, unit: str) -> str:
    """Return an SI value as people are used to it, four significant digits: 7.6e-6, "m" -> "7.6 µm"."""
    factor, offset, label = shown_unit(value_si, unit)
    shown = value_si * factor + offset
    digits = f"{shown:.4g}"
    if "e+" in digits:
        digits = f"{float(digits):.0f}" if abs(shown) < 1e7 else digits
    return f"{digits} {label}".rstrip() if label != "°" else f"{digits}°"


def _refuse_what_nobody_means(value: float, unit: str, where: str, usual: tuple[float, float] | None) -> None:
    """Refuse a temperature that does not exist, and a value that is far outside a usual range."""
    if unit == "degC" and value < ABSOLUTE_ZERO:
        what = f"{format_quantity(value, unit)} is below the absolute zero"
        raise InputError(what, where, "write a temperature above -273.15 degC")
    if usual is not None:
        side = "below" if abs(value) < usual[0] else "above"
        ends = " to ".join(format_quantity(end, unit) for end in usual)
        what = f"{format_quantity(value, unit)} is more than a million times {side} what is usual, {ends}"
        raise InputError(what, where, "check the number and its unit")


def _split(text: str, unit: str, where: str) -> tuple[float, str]:
    """Split "20 mm" into 20.0 and "mm"."""
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        raise InputError(f'"{text}" does not begin with a number', where, _write_it(unit))
    number, rest = match.groups()
    if re.match(r",\d", rest):
        pointed = text.strip().replace(",", ".") if text.count(",") == 1 else "2.5 mm"
        mend = f'write a decimal point, e.g. "{pointed}", and nothing between thousands'
        raise InputError(f'"{text}" has a decimal comma', where, mend)
    if re.match(r"[/*^²³.\d]|\s+[\d.+-]+(?!\s*/)(\s|$)", rest):
        raise InputError(f'"{text}" is not one number and its unit', where, _write_it(unit))
    return float(number), rest.strip()


def _write_it(unit: str, number: float | None = None) -> str:
    """Return the mend for a missing or unusable quantity."""
    if unit == "1":
        return "write a number without unit, e.g. 0.5"
    example = EXAMPLE_UNITS.get(unit, unit)
    return f'write it with its unit, e.g. "{20.0 if number is None else number:g} {example}"'


_SCALES: dict[str, tuple[tuple[float, float, str], ...]] = {
    "m": ((0.0, 1e9, "nm"), (1e-7, 1e6, "µm"), (1e-4, 1e3, "mm"), (10.0, 1.0, "m")),
    "s": ((0.0, 1e6, "µs"), (1e-4, 1e3, "ms"), (1.0, 1.0, "s"), (600.0, 1 / 60, "min"), (7200.0, 1 / 3600, "h")),
    "N": ((0.0, 1.0, "N"), (1e4, 1e-3, "kN")),
    "N m": ((0.0, 1e3, "mN m"), (1e-2, 1.0, "N m")),
    "N/m": ((0.0, 1.0, "N/m"), (1e5, 1e-6, "N/µm")),
    "m/s": ((0.0, 1e6, "µm/s"), (1e-5, 1e3, "mm/s"), (1e-3, 60.0, "m/min")),
    "rad": ((0.0, 180 / math.pi, "°"),),
    "rad/s": ((0.0, 30 / math.pi, "rev/min"),),
    "m rad/s": ((0.0, 3e4 / math.pi, "mm rev/min"),),
    "Hz": ((0.0, 1.0, "Hz"), (1e4, 1e-3, "kHz")),
    "W": ((0.0, 1.0, "W"), (1e4, 1e-3, "kW")),
    "Pa": ((0.0, 1.0, "Pa"), (1e5, 1e-6, "MPa"), (1e9, 1e-9, "GPa")),
    "degC": ((0.0, 1.0, "°C"),),
    "m/m": ((0.0, 1e6, "µm/m"),),
    "1": ((0.0, 1.0, ""),),
}
"""SI unit -> rows (from this absolute size on, factor, label), smallest size first."""


def shown_unit(value_si: float, unit: str) -> tuple[float, float, str]:
    """Return factor, offset and label to show an SI value in; units that are not in the table stay SI."""
    scales = _SCALES.get(unit)
    if scales is None:
        return 1.0, 0.0, unit.replace("^2", "²").replace("^3", "³")
    if value_si == 0.0:
        return 1.0, 0.0, _label_at_zero(unit)
    chosen = [row for row in scales if abs(value_si) >= row[0]] or [scales[0]]
    return chosen[-1][1], 0.0, chosen[-1][2]


def _label_at_zero(unit: str) -> str:
    """Return the label of zero: the unit in which most values of the kind are shown."""
    usual = {"m": "mm", "s": "s", "N m": "N m", "N/m": "N/µm", "m/s": "m/min"}
    return usual.get(unit, _SCALES[unit][0][2])


def percent(share: float, decimals: int = 0) -> str:
    """A share as per cent, with a blank before the sign as before any unit."""
    rounded = round(100.0 * share, decimals) + 0.0  # no minus before zero
    return f"{rounded:.{decimals}f} %".replace("-", "\N{MINUS SIGN}")
