"""Quantities as callers write them: a string with its unit, or a number in SI."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real

import numpy as np

from feeddrive.errors import InputError
from feeddrive.units.quantity import parse

Quantity = str | float
"""A string with its unit, such as "20 mm", or a number in SI."""

Quantities = Quantity | Sequence[Quantity] | None
"""One quantity or several; None for none."""


def si(value: Quantity, unit: str, where: str = "quantity") -> float:
    """A quantity in SI.

    Args:
        value: "20 mm", or a number that is in SI already.
        unit: SI unit that is needed, such as "m", "rad/s" or "1".
        where: name of the argument, for messages.

    Raises:
        InputError: another dimension, an unknown unit in a string, no finite number. `unit` itself is taken as known.

    >>> import feeddrive as fd
    >>> fd.si("20 mm", "m"), fd.si(0.02, "m")
    (0.02, 0.02)
    """
    if isinstance(value, str):
        return parse(value, unit, where)
    if isinstance(value, bool) or not isinstance(value, Real | np.floating) or not math.isfinite(value):
        raise InputError(f"{value!r} is no quantity", where, f'write "... {unit}", or a number in {unit}')
    return float(value)


def positive(value: Quantity, unit: str, where: str, example: str) -> float:
    """A quantity in SI that is above zero; `example` is how one is written.

    Raises:
        InputError: as `si`, or zero or less.
    """
    found = si(value, unit, where)
    if not found > 0:
        raise InputError(f"{value} is not above zero", where, f'write e.g. "{example}"')
    return found


def quantities(values: Quantities, unit: str, where: str) -> tuple[float, ...]:
    """One quantity or several, in SI; none for None.

    Raises:
        InputError: as `si`.
    """
    if values is None:
        return ()
    if isinstance(values, str) or not isinstance(values, Sequence | np.ndarray):
        return (si(values, unit, where),)
    return tuple(si(value, unit, where) for value in values)
