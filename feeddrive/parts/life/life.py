"""Life of a ball screw or bearing from its rating: revolutions and reliability.

    L = (C / F)^p   [10^6 rev],      S(N) = exp(-ln(1/0.9) (N / L)^e)

| symbol | meaning | unit |
|---|---|---|
| C, F | basic dynamic axial rating, axial load | N |
| L | rated life, which 90 % survive | 10^6 rev |
| N | revolutions | rev |
| S | probability of survival | 1 |
| p, e | exponents of `feeddrive.parts.life.life_exponents` | 1 |

Validity: loads up to half the rating; clean, lubricated contacts; no factor for film or dirt.
Source: paper 001, eqs. (7), (9) and, for the scatter, (24).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.elementary import power
from feeddrive.parts.life.life_exponents import BALL_SCREW
from feeddrive.parts.values import PartValue, check_values

MILLION = 1e6
"""Revolutions in which rated life is counted."""

HIGHEST_LOAD = 0.5
"""Load over rating up to which the life law is used in design."""

_LEAD = (PartValue("lead", "m", 0.0, 1.0),)
_SPEED = (PartValue("speed", "rad/s", 0.0, 1e6),)
_TEST = (PartValue("force", "N", 0.0, 1e9), PartValue("revolutions", "1", 0.0, 1e30))
_LOAD = (PartValue("rating", "N", 0.0, usual=(10.0, 5e6)), PartValue("force", "N", 0.0, open_ends=False))


def rated_revolutions(rating: float, force: float) -> float:
    """Revolutions that 90 % survive [rev]; infinite without load.

    Args:
        rating: C [N]; of the double nut for a double nut, see `double_nut_share`.
        force: F, size of the axial load of every nut, the preload included [N].

    Raises:
        InputError: a rating that is not positive, a negative force.

    Warns:
        ValidityWarning: a load above half the rating.
    """
    check_values("life", _LOAD, {"rating": rating, "force": force})
    if force > HIGHEST_LOAD * rating:
        text = f"life: a load of {force / rating:.2f} of the rating, the life law is trusted up to {HIGHEST_LOAD:g}"
        warnings.warn(text, ValidityWarning, stacklevel=2)
    if force == 0.0:
        return math.inf
    # As a power of ten, since a tiny load gives more revolutions than a number holds.
    decades = BALL_SCREW.load * math.log10(rating / force)
    return MILLION * 10.0**decades if decades < 300.0 else math.inf


def rating_of_test(force: float, revolutions: float) -> float:
    """C [N] of what 90 % survived for `revolutions` [rev] under `force` [N].

    Raises:
        InputError: a force or revolutions that are not positive.
    """
    check_values("life test", _TEST, {"force": force, "revolutions": revolutions})
    return float(force * (revolutions / MILLION) ** (1.0 / BALL_SCREW.load))


def survival(revolutions: float, rated: float) -> float:
    """Probability S of surviving `revolutions` where 90 % survive `rated` [rev], which may be infinite.

    Raises:
        InputError: negative revolutions, or a rated life that is not positive.
    """
    if not (0.0 <= revolutions < math.inf and rated > 0.0):
        what = f"{revolutions:g} revolutions of {rated:g} rated ones"
        raise InputError(what, "life", "write revolutions of 0 or more and a rated life above 0")
    return math.exp(math.log(0.9) * power(revolutions / rated, BALL_SCREW.slope))


def life_together(lives: Sequence[float]) -> float:
    """Life that 90 % of sets of bodies survive: L^-e is the sum of L_i^-e, in any unit; infinite where all are.

    Raises:
        InputError: no life, or one that is negative or no number.
    """
    shortest = min(lives, default=math.nan)
    if not all(life >= 0 for life in lives) or math.isnan(shortest):
        raise InputError(f"{list(lives)} are no lives", "life of a set", "give one or more, none of them negative")
    if math.isinf(shortest) or shortest == 0:
        return shortest
    return float(shortest * sum((life / shortest) ** -BALL_SCREW.slope for life in lives) ** (-1.0 / BALL_SCREW.slope))


def distance(revolutions: float, lead: float) -> float:
    """Travel of the table [m] in `revolutions` [rev] of a screw of this lead [m]; infinite where they are.

    Raises:
        InputError: negative revolutions, or a lead that is not possible.
    """
    check_values("screw", _LEAD, {"lead": lead})
    _refuse_negative(revolutions)
    return revolutions * lead


def running_time(revolutions: float, speed: float) -> float:
    """Time [s] for `revolutions` [rev] at a speed [rad/s]; infinite where they are.

    Raises:
        InputError: negative revolutions, or a speed that is not positive.
    """
    _refuse_negative(revolutions)
    check_values("life", _SPEED, {"speed": speed})
    return revolutions * 2.0 * math.pi / speed


def _refuse_negative(revolutions: float) -> None:
    if not revolutions >= 0.0:
        raise InputError(f"{revolutions:g} revolutions", "life", "write 0 or more")
