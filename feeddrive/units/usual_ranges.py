"""What is usual at feed drives, unit by unit, so that a slip of the pen is refused where it is read.

A written value that is not zero is refused where its size is more than `BEYOND` times outside the usual range: nobody
means 1e150 kg, and equations with such numbers overflow or lose everything else. Between that and the usual range a
machine may be strange; what knows its own range (a part, a value of the chain) warns there.
"""

from __future__ import annotations

BEYOND = 1e6
"""How far outside the usual range a value may lie. The widest slip of a unit is that between µm and m."""

ABSOLUTE_ZERO = -273.15
"""[degC]"""

USUAL: dict[str, tuple[float, float]] = {
    "1": (1e-6, 1e6),
    "m": (1e-9, 100.0),
    "rad": (1e-9, 1e5),
    "s": (1e-7, 1e7),
    "kg": (1e-3, 1e6),
    "A": (1e-3, 1e4),
    "V": (1e-3, 1e4),
    "W": (1e-3, 1e6),
    "K": (1e-4, 1e3),
    "degC": (1e-3, 1e3),
    "dB": (1e-3, 200.0),
    "Pa": (1.0, 1e13),
    "Hz": (1e-4, 1e7),
    "1/s": (1e-4, 1e7),
    "m/m": (1e-9, 1e-2),
    "m/s": (1e-7, 100.0),
    "m/s^2": (1e-4, 1e5),
    "m/s^3": (1e-3, 1e9),
    "rad/s": (1e-5, 1e5),
    "m rad/s": (1e-2, 1e3),
    "m^2/s": (1e-7, 1e-1),
    "N": (1e-4, 1e7),
    "N m": (1e-7, 1e6),
    "N m^2": (1e-2, 1e8),
    "N/m": (1.0, 1e12),
    "N s/m": (1e-3, 1e9),
    "N m/rad": (1e-2, 1e10),
    "N m s/rad": (1e-8, 1e6),
    "N m/(rad/s)^(2/3)": (1e-8, 1e3),
    "N m/A": (1e-4, 1e3),
    "N m/V": (1e-6, 1e4),
    "N m/W^0.5": (1e-4, 1e3),
    "V s/m": (1e-3, 1e7),
    "kg m^2": (1e-9, 1e4),
    "kg m": (1e-9, 1e2),
    "kg/m": (1e-3, 1e4),
    "kg/m^3": (10.0, 1e5),
    "1/K": (1e-7, 1.0),
    "J/K": (1e-2, 1e8),
    "W/K": (1e-4, 1e5),
    "W/(m K)": (1e-3, 1e4),
    "W/(m^2 K)": (1e-2, 1e7),
    "J/(m^3 K)": (1e3, 1e8),
}
"""Least and greatest size [SI] of what plant, scenario and controller files hold; resolutions at the low end."""


def beyond_usual(
    value: float, unit: str, usual: tuple[float, float] | None = None, may_vanish: bool = False
) -> tuple[float, float] | None:
    """The usual range of a written value that nobody can mean; None of any other.

    Args:
        value: SI; zero is left to the caller.
        unit: SI unit; one that is not in `USUAL` is not judged.
        usual: range of this very key [unit]; that of its unit where it is None.
        may_vanish: whether a value next to zero means the same as zero, as in a curve that passes through it.
    """
    if value == 0 or unit not in USUAL:
        return None
    low, high = USUAL[unit]
    if usual is not None:
        low, high = usual[0] or min(low, usual[1]), usual[1]
    small = abs(value) < low / BEYOND and not may_vanish
    return (low, high) if small or abs(value) > high * BEYOND else None
