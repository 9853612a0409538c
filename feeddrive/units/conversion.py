"""Written units and their conversion to SI: spellings, dimensions, and look-alikes that are kept apart.

Importing pint takes time, so it happens on the first conversion that is not the identity.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any, TypeVar

from feeddrive.typing import FloatArray
from feeddrive.units.definitions import DEFINITIONS
from feeddrive.units.grammar import LONGEST, GrammarError, check_unit

Number = TypeVar("Number", float, FloatArray)

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+")

_RANGE = 1e40  # a conversion beyond it is of no unit that anyone measures in

# Spellings of the shop floor that pint would not read, or would read as something else.
_SPELLINGS: tuple[tuple[str, str], ...] = (
    (r"º", "°"),
    (r"°\s*C\b", "degC"),
    (r"°\s*F\b", "degF"),
    (r"[·⋅∙\u00d7]", "*"),
    (r"(?<=[A-Za-zµμ])\.(?=[A-Za-zµμ])", " "),
    (r"(?<![A-Za-zµμ])([kmMcµμu]?)N([mcµμu]?)m(s?)(?![A-Za-z])", r"\1N \2m \3"),
    (r"(?<![A-Za-zµμ])(k?)g(c|m?)m(?:\^?2|²)", r"\1g \2m^2"),
    (r"(?<=[A-Za-z])(-?[123])(?![\d.])", r"^\1"),
)
_SUPERSCRIPT = re.compile(r"[⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺]+")


@dataclass(frozen=True)
class Conversion:
    """Linear map from a written unit to an SI unit: si = factor * value + offset (offset in the SI unit)."""

    factor: float
    offset: float = 0.0

    def apply(self, value: Number) -> Number:
        """Return the value, number or array of any shape, in the SI unit."""
        if self.factor == 1.0:
            return value + self.offset if self.offset else value
        divisor = 1.0 / self.factor
        if divisor.is_integer() and not self.offset:  # 20 / 1e6 is the double nearest to 2e-5, 20 * 1e-6 is not
            return value / divisor
        return value * self.factor + self.offset


class UnitError(Exception):
    """What is wrong with a unit, and its mend; the place is added by the caller."""

    def __init__(self, what: str, mend: str) -> None:
        super().__init__(what)
        self.what = what
        self.mend = mend


@lru_cache(maxsize=1024)
def conversion_between(unit_text: str, si_unit: str) -> Conversion:
    """Return the conversion from a written unit to an SI unit.

    Raises:
        UnitError: unknown unit, wrong dimension, or a pair that must not be mixed.
    """
    if unit_text == si_unit:
        return Conversion(1.0)
    given, needed = _unit(unit_text), _unit(si_unit)
    _refuse_lookalike(unit_text, si_unit, _names(given), _names(needed))
    if not _same_dimension(given.dimensionality, needed.dimensionality, si_unit):
        raise UnitError(f'"{unit_text}" does not measure {_kind(si_unit)}', _needed(si_unit))
    if si_unit == "degC":
        return _temperature(str(given))
    factor = float(given._REGISTRY.convert(1.0, _per_radian(given, needed), needed))
    if not 1.0 / _RANGE < factor < _RANGE:
        raise UnitError(f'"{unit_text}" is {factor:.0e} {si_unit}, which nobody measures in', _needed(si_unit))
    short = float(f"{factor:.12g}")
    return Conversion(short if abs(short / factor - 1.0) < 1e-15 else factor)


@cache
def _registry() -> Any:
    """Return the registry; built on first use."""
    import pint

    registry: Any = pint.UnitRegistry(None)
    registry.load_definitions(list(DEFINITIONS))
    return registry


@lru_cache(maxsize=1024)
def _unit(unit_text: str) -> Any:
    """Return pint's unit of a written one."""
    if not unit_text.strip() or len(unit_text) > LONGEST:
        raise UnitError(f'"{unit_text}" is not a unit', "write a unit such as mm, rev/min, N m")
    spelled = unit_text
    for pattern, replacement in _SPELLINGS:
        spelled = re.sub(pattern, replacement, spelled)
    spelled = _SUPERSCRIPT.sub(lambda match: f"^({match[0].translate(_SUPERSCRIPTS)})", spelled).strip()
    if spelled not in ("degC", "degF"):  # in a compound a temperature is a difference
        spelled = re.sub(r"\bdegC\b", "K", spelled)
    try:
        check_unit(spelled)
    except GrammarError as error:
        raise UnitError(f'unknown unit "{unit_text}": it {error}', _nearest_unit(unit_text)) from None
    try:
        registry = _registry()
    except Exception as error:  # a file of the folder that is started from, named like a module of Python
        mend = "start from a folder without Python files, or use the command feeddrive"
        raise UnitError(f"the unit library cannot be loaded ({error})", mend) from error
    try:
        return registry.parse_units(spelled)
    except Exception as error:  # pint, its tokenizer and Python's arithmetic each raise their own kinds
        raise UnitError(f'unknown unit "{unit_text}"', _nearest_unit(unit_text)) from error


def _nearest_unit(unit_text: str) -> str:
    known = [
        "mm",
        "µm",
        "m",
        "s",
        "ms",
        "rev/min",
        "rad/s",
        "deg",
        "rad",
        "N m",
        "N/µm",
        "m/min",
        "m/s",
        "kg m^2",
        "degC",
        "kg",
    ]
    lowered = {name.lower(): name for name in known}
    near = difflib.get_close_matches(unit_text.lower(), list(lowered), n=1, cutoff=0.6)
    return f'did you mean "{lowered[near[0]]}"?' if near else "write a unit such as mm, rev/min, N m, N/µm"


def _names(unit: Any) -> set[str]:
    """Return the names of the units in a product, their prefixes taken off."""
    return {_registry().parse_unit_name(name)[0][1] for name in unit._units}


def _refuse_lookalike(unit_text: str, si_unit: str, given: set[str], needed: set[str]) -> None:
    """Refuse units of the same dimension that mean another thing."""
    for name, kind in (("joule", "an energy"), ("hertz", "a frequency")):
        if name in given and name not in needed and ("newton" in needed or name == "hertz"):
            raise UnitError(f'"{unit_text}" is {kind}, not {_kind(si_unit)}', _needed(si_unit))
    if si_unit == "K" and given & {"degree_Celsius", "degree_Fahrenheit"}:
        raise UnitError(f'"{unit_text}" is a temperature, here a difference is needed', "write it in K")


def _same_dimension(given: Any, needed: Any, si_unit: str) -> bool:
    """Compare dimensions; "per rad" may be left out, as in N m s for N m s/rad, but not of a stiffness (a torque?)."""
    for name in {*given, *needed}:
        left_out = name == "[angle]" and name not in given and needed[name] < 0 and si_unit != "N m/rad"
        if not left_out and abs(given.get(name, 0) - needed.get(name, 0)) > 1e-9:
            return False
    return True


def _per_radian(given: Any, needed: Any) -> Any:
    """Put back a "per rad" that was left out."""
    missing = needed.dimensionality.get("[angle]", 0) - given.dimensionality.get("[angle]", 0)
    return given * _registry().radian ** missing if missing else given


def _temperature(name: str) -> Conversion:
    """Return the conversion of a temperature to degC."""
    if name == "kelvin":
        return Conversion(1.0, -273.15)
    return Conversion(1.0) if name == "degree_Celsius" else Conversion(5.0 / 9.0, -160.0 / 9.0)


def _kind(si_unit: str) -> str:
    kinds = {
        "m": "a length",
        "rad": "an angle",
        "rad/s": "a rotational speed",
        "Hz": "a frequency",
        "s": "a time",
        "N m": "a torque",
        "N": "a force",
        "A": "a current",
        "degC": "a temperature",
        "1": "a pure number",
        "m/s": "a velocity",
        "kg": "a mass",
        "kg m^2": "an inertia",
        "N/m": "a stiffness",
        "W": "a power",
    }
    return kinds.get(si_unit, f"what is in {si_unit}")


def _needed(si_unit: str) -> str:
    units = {
        "m": "m, mm or µm",
        "rad": "rad, deg or rev",
        "rad/s": "rad/s, deg/s or rev/min",
        "Hz": "Hz, kHz or 1/s",
        "m/s": "m/s, mm/s or m/min",
        "N/m": "N/m or N/µm",
        "1": "no unit",
        "degC": "degC or K",
    }
    return f"it needs {units.get(si_unit, si_unit)}"
