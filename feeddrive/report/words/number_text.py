"""Numbers as people read them: a unit of the trade for every SI unit, only the digits that the interval supports."""

from __future__ import annotations

import math
from dataclasses import dataclass

from feeddrive.units.quantity import shown_unit

DASH = "\N{EN DASH}"
MINUS = "\N{MINUS SIGN}"
SPACE = "\N{NO-BREAK SPACE}"
"""Between a number and its unit, and inside a unit, so that no line breaks there."""


@dataclass(frozen=True)
class Scale:
    """Shown number = SI number * factor, followed by the unit's label."""

    factor: float
    unit: str


_ERROR: dict[str, Scale] = {
    "m": Scale(1e6, "µm"),
    "m/s": Scale(1e3, "mm/s"),
    "rad": Scale(1e3, "mrad"),
    "rad/s": Scale(30.0 / math.pi, "rev/min"),
    "degC": Scale(1.0, "K"),
}
_SPELLINGS = {
    "kg m²": "kg m^2",
    "kg*m^2": "kg m^2",
    "kg*m**2": "kg m^2",
    "N*m": "N m",
    "Nm": "N m",
    "°C": "degC",
    "": "1",
    "dimensionless": "1",
}


def unit_name(unit: str) -> str:
    """The unit in the package's one spelling; an unknown unit comes back as it is."""
    return _SPELLINGS.get(unit.strip(), unit.strip())


def scale_for_value(largest: float, unit: str) -> Scale:
    """Unit of the trade for values whose largest magnitude is `largest` in the SI unit `unit`."""
    name = unit_name(unit)
    if name == "kg m^2" and abs(largest) < 1.0:
        return Scale(1e4, "kg cm²")
    factor, _, label = shown_unit(largest if math.isfinite(largest) else 1.0, name)
    return Scale(factor, label)


def scale_for_difference(largest: float, unit: str) -> Scale:
    """Unit of the trade for differences of values in the SI unit `unit`, of which those of temperatures are in K."""
    return scale_for_value(largest, "K" if unit_name(unit) == "degC" else unit)


def scale_for_error(unit: str) -> Scale:
    """Unit in which errors of a channel are shown: always µm for lengths, so that channels can be compared."""
    name = unit_name(unit)
    return _ERROR.get(name) or scale_for_value(1.0, name)


def scale_for_signal(name: str, largest: float, unit: str) -> Scale:
    """Unit in which a measured channel or variable is shown: mm for positions, revolutions for angles."""
    if unit_name(unit) == "m":
        return Scale(1e6, "µm") if name.startswith("table_growth") else Scale(1e3, "mm")
    if unit_name(unit) == "rad":
        return Scale(0.5 / math.pi, "rev")
    if unit_name(unit) == "N m":
        return Scale(1.0, "N m")
    if unit_name(unit) == "m/s":
        return Scale(60.0, "m/min") if largest >= 0.1 else Scale(1e3, "mm/s")
    return scale_for_value(largest, unit)


def scale_for_time(duration: float) -> Scale:
    """Unit in which a time axis of this length [s] is shown: seconds, minutes or hours."""
    if duration <= 600.0:
        return Scale(1.0, "s")
    return Scale(1.0 / 60.0, "min") if duration <= 7200.0 else Scale(1.0 / 3600.0, "h")


def band_text(band: tuple[float, float]) -> str:
    """A band in words; slow recordings are compared as they are, from zero to half their rate."""
    low, high = band
    if high < 0.1:
        return f"all, rows of {significant(0.5 / high, 2)} s" if high > 0.0 else "all"
    return f"{significant(low)} to {significant(high)} Hz"


def axis_label(words: str, unit: str) -> str:
    """Label of an axis: what it is, and its unit in brackets ([1] for a pure number)."""
    return f"{words} [{unit or '1'}]"


RAISED = str.maketrans("-\N{MINUS SIGN}0123456789", "⁻⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits of an exponent as raised letters."""


def fixed(number: float, decimals: int) -> str:
    """A number with a true minus sign and a fixed count of decimals; a dash if it is not finite."""
    if not math.isfinite(number):
        return DASH
    text = f"{number:.{decimals}f}"
    if float(text) == 0.0:
        text = text.removeprefix("-")
    return text.replace("-", MINUS)


def significant(number: float, digits: int = 3) -> str:
    """A number with `digits` significant digits; powers of ten only where plain digits would be unreadable."""
    if not math.isfinite(number):
        return DASH
    if number == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(float(f"{number:.{digits - 1}e}"))))
    if not -5 <= exponent <= 6:
        mantissa = fixed(number / 10.0**exponent, digits - 1)
        return f"{mantissa}·10{str(exponent).translate(RAISED)}".replace("-", MINUS)
    rounded = round(number, digits - 1 - exponent)
    return fixed(rounded, max(0, digits - 1 - exponent))


def decimals_for(half_width: float) -> int:
    """Decimals that an interval of this half width supports: one digit of it, two where it begins with 1 or 2."""
    if not (math.isfinite(half_width) and half_width > 0.0):
        return 3
    exponent = math.floor(math.log10(half_width))
    leading = half_width / 10.0**exponent
    return min(9, max(0, (1 if leading < 2.95 else 0) - exponent))


def with_unit(number: str, unit: str) -> str:
    """Number and unit, no unit where it is empty."""
    return f"{number}{'' if unit in ('', '°') else SPACE}{unit.replace(' ', SPACE)}"


def scale_for_share_of_life(largest: float) -> Scale:
    """Unit in which shares of a rated life, which a motion takes in small bites, are readable."""
    for least, scale in ((1e-4, Scale(1e2, "%")), (1e-7, Scale(1e6, "millionths"))):
        if abs(largest) >= least:
            return scale
    return Scale(1e9, "billionths")


def share_text(share: float) -> str:
    """A share as per cent with digits that suit its size."""
    if not math.isfinite(share):
        return DASH
    percent = 100.0 * share
    if abs(percent) < 1.0:
        return with_unit(significant(percent, 2), "%")
    return with_unit(fixed(percent, 0 if abs(percent) >= 99.95 else 1), "%")


def times_text(factor: float) -> str:
    """How many times larger something is; beyond a thousand only that it is."""
    if math.isnan(factor):
        return DASH
    return f"> 1000{SPACE}×" if factor > 1000.0 else f"{significant(factor)}{SPACE}×"


def error_text(number: float, unit: str) -> str:
    """An error of a channel with three significant digits and its unit."""
    scale = scale_for_error(unit)
    return with_unit(significant(number * scale.factor), scale.unit)
