"""HEIDENHAIN TNC 426, TNC 430, iTNC 530: MP2500, MP2510 of the speed controller, MP1810 of the position controller.

    MP2500 = 2 pi K_p / k_T,   MP2510 = MP2500 / T_n

| symbol | meaning | unit |
|---|---|---|
| k_T | torque constant of the motor | N m/A |
| MP2500, MP2510 | current per speed in revolutions, and per angle | A s, A |

The manual gives the units A s and A; that they count per revolution follows from the later control, which writes
A s^2/rev for the differential factor of the same controller. Filters are not written: the manual's filters have no
frequency that is published.
"""

from __future__ import annotations

import math

from feeddrive.errors import InputError
from feeddrive.servo.cascade import KV_UNIT
from feeddrive.tuning.drive_forms.parameter import DriveForm, Facts, Line, LoopSettings, Parameter, wanted
from feeddrive.tuning.filter_choice import FilterLimits

_SPEED = "Technical Manual TNC 426, TNC 430, December 2001, p. 6-135"
_POSITION = "Technical Manual iTNC 530 HSCI p. 834"
FORM = DriveForm(
    "heidenhain",
    "HEIDENHAIN TNC 426, TNC 430, iTNC 530",
    "machine parameters; .0 is axis 1, write that of the axis",
    (_SPEED, _POSITION, "per revolution: Technical Manual MANUALplus 620 p. 856"),
)
LIMITS = FilterLimits(most=0, notch=False, low_pass=False)

_KV = Parameter(
    "MP1810.0", "(m/min)/mm", "kv factor for control with following error", 1 / KV_UNIT, 3, 0.1, 20.0, _POSITION
)


def _speed_parameters(facts: Facts) -> tuple[Parameter, Parameter]:
    """MP2500 and MP2510, whose numbers depend on the torque constant.

    Raises:
        InputError: it is not known.
    """
    if facts.torque_constant is None:
        mend = 'declare torque_constant = "... N m/A" in [motor]'
        raise InputError(
            "HEIDENHAIN counts the gain in amperes, and the torque constant is not declared", FORM.name, mend
        )
    per_si = 2 * math.pi / facts.torque_constant
    return (
        Parameter("MP2500.0", "A s", "proportional factor of the speed controller", per_si, 3, 0.0, 1e6, _SPEED),
        Parameter("MP2510.0", "A", "integral factor of the speed controller", per_si, 0, 0.0, 1e8, _SPEED),
    )


def lines(loop: LoopSettings, facts: Facts) -> list[Line]:
    """The lines of a file.

    Raises:
        InputError: a value outside its range, no torque constant, a filter.
    """
    if loop.filters:
        raise InputError("filters are not written for this control", FORM.name, "their frequencies are not published")
    gain, integral = _speed_parameters(facts)
    first = gain.line(loop.velocity_gain, -1)
    per_angle = first.value / loop.reset_time if math.isfinite(loop.reset_time) else 0.0
    return [first, integral.line(per_angle, -1), _KV.line(loop.position_gain, -1)]


def known() -> tuple[Parameter, ...]:
    """Every parameter that is read; the numbers of two depend on the axis."""
    return (*_speed_parameters(Facts(1.0, 1.0, 1.0, 1.0)), _KV)


def settings(values: dict[str, float], facts: Facts) -> LoopSettings:
    """The loop that a file sets; arguments as `sinamics.settings`.

    Raises:
        InputError: a parameter missing, no torque constant.
    """
    gain, integral = (wanted(values, one.name, FORM.name) / one.per_si for one in _speed_parameters(facts))
    reset = gain / integral if integral else math.inf
    return LoopSettings(gain, reset, wanted(values, _KV.name, FORM.name) / _KV.per_si)
