"""Elementary functions of numbers, arrays and CasADi expressions alike, so that a law is written once for all three."""

from __future__ import annotations

import casadi as ca
import numpy as np

from feeddrive.typing import Expression


def sine(angle: Expression) -> Expression:
    """sin of an angle [rad]; any shape."""
    return ca.sin(angle) if _symbolic(angle) else np.sin(angle)


def cosine(angle: Expression) -> Expression:
    """cos of an angle [rad]; any shape."""
    return ca.cos(angle) if _symbolic(angle) else np.cos(angle)


def arcsine(ratio: Expression) -> Expression:
    """Angle [rad] in -pi/2 to pi/2 whose sine is the ratio, itself in -1 to 1; any shape."""
    return ca.asin(ratio) if _symbolic(ratio) else np.arcsin(ratio)


def power(base: float, exponent: float) -> float:
    """A number of 0 or more to a positive exponent; infinite beyond the range of numbers in place of an error."""
    with np.errstate(over="ignore", under="ignore"):
        return float(np.float64(base) ** exponent)


def positive_part(value: Expression) -> Expression:
    """The value where it is positive, else 0; any shape."""
    return ca.fmax(value, 0) if _symbolic(value) else np.maximum(value, 0.0)


def within(value: Expression, limit: Expression) -> Expression:
    """The value cut off at -limit and limit (limit not negative); any shape."""
    if _symbolic(value) or _symbolic(limit):
        return ca.fmin(ca.fmax(value, -limit), limit)
    return np.clip(value, -limit, limit)


def _symbolic(value: Expression) -> bool:
    return isinstance(value, ca.SX | ca.MX | ca.DM)
