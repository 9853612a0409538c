"""Units as exponents of SI base units, as FMI wants them."""

from __future__ import annotations

import re

_BASE = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "J": {"kg": 1, "m": 2, "s": -2},
    "Hz": {"s": -1},
    **{name: {name: 1} for name in ("kg", "m", "s", "A", "K", "rad")},
}
_FACTOR = re.compile(r"([A-Za-z]+)(?:\^(-?\d+))?")


def exponents(unit: str) -> dict[str, int] | None:
    """Exponents of kg, m, s, A, K and rad; {} for a pure number, None where there are no whole ones.

    Args:
        unit: SI unit as feeddrive writes it, such as "N m s/rad" or "kg m^2".
    """
    if unit == "1":
        return {}
    total: dict[str, int] = {}
    above, _, below = unit.partition("/")
    for text, sign in ((above, 1), (below.removeprefix("(").removesuffix(")"), -1)):
        for factor in text.split():
            match = _FACTOR.fullmatch(factor)
            if match is None or match[1] not in _BASE:
                if factor == "1":
                    continue
                return None
            for base, exponent in _BASE[match[1]].items():
                total[base] = total.get(base, 0) + sign * exponent * int(match[2] or 1)
    return {base: exponent for base, exponent in total.items() if exponent}
