"""LinuxCNC: two `pid` and as many `biquad` components of HAL, the machine's unit mm.

    position   speed = Pgain (command - feedback) + FF1 command'                     mm, mm/s
    velocity   torque = Pgain e + Igain int e dt,   e = command - feedback           mm/s, N m
    biquad     type 1 low-pass, type 2 complete notch; corner f0, Q = 1 / (2 D)

with Pgain = K_v in the first, and in the second Pgain = K_p / r, Igain = K_p / (T_n r), for speeds of the table r w.
The names pid.position, pid.velocity and biquad.torque-k are those to load the components with (`names=`).
"""

from __future__ import annotations

import math

from feeddrive.errors import InputError
from feeddrive.tuning.drive_forms.parameter import DriveForm, Facts, Line, LoopSettings, Parameter, wanted
from feeddrive.tuning.filter_choice import FilterChoice, FilterLimits

_PID, _BIQUAD = "manual page pid(9), LinuxCNC 2.9", "manual page biquad(9), LinuxCNC 2.9: 2 > Q > 0.5"
FORM = DriveForm(
    "linuxcnc",
    "LinuxCNC with a drive in torque mode",
    "HAL; load pid.position, pid.velocity, biquad.torque-k; mm",
    (_PID, _BIQUAD),
)
LIMITS = FilterLimits(most=3, damping=(0.26, 0.99), depth=(math.inf, math.inf))
_MM = 1e-3
_LOW_PASS, _NOTCH = 1, 2


def _pid(facts: Facts) -> tuple[Parameter, Parameter, Parameter, Parameter]:
    per = _MM / facts.radius
    return (
        Parameter("pid.velocity.Pgain", "N m s/mm", "K_p / r", per, 7, 0.0, math.inf, _PID),
        Parameter("pid.velocity.Igain", "N m/mm", "K_p / (T_n r)", per, 5, 0.0, math.inf, _PID),
        Parameter("pid.position.Pgain", "1/s", "K_v", 1.0, 3, 0.0, math.inf, _PID),
        Parameter("pid.position.FF1", "", "share of the set speed", 1.0, 3, 0.0, 10.0, _PID),
    )


def _biquad(number: int) -> tuple[Parameter, Parameter, Parameter]:
    name = f"biquad.torque-{number}"
    return (
        Parameter(f"{name}.type", "", "1 low-pass, 2 notch", 1.0, 0, 1, 2, _BIQUAD),
        Parameter(f"{name}.f0", "Hz", "corner frequency", 1.0, 1, 0.1, math.inf, _BIQUAD),
        Parameter(f"{name}.Q", "", "1 / (2 D)", 1.0, 6, 0.5, 2.0, _BIQUAD),
    )


def lines(loop: LoopSettings, facts: Facts) -> list[Line]:
    """The lines of a file.

    Raises:
        InputError: a value outside its range, a notch that is not complete.
    """
    gain, integral, kv, forward = _pid(facts)
    first = gain.line(loop.velocity_gain, -1)
    per_angle = first.value / loop.reset_time if math.isfinite(loop.reset_time) else 0.0
    found = [first, integral.line(per_angle, -1), kv.line(loop.position_gain, -1), forward.line(1.0)]
    for number, choice in enumerate(loop.filters):
        if choice.kind == "notch" and math.isfinite(choice.depth):
            raise InputError(f"a notch of {choice.depth:g} dB is not possible", FORM.name, "its notches are complete")
        kind = _LOW_PASS if choice.kind == "PT2" else _NOTCH
        values = (kind, choice.frequency, 1 / (2 * choice.damping))
        found += [parameter.line(value) for parameter, value in zip(_biquad(number), values, strict=True)]
    return found


def known() -> tuple[Parameter, ...]:
    """Every parameter that is read; the numbers of two depend on the axis."""
    filters = (one for number in range(LIMITS.most) for one in _biquad(number))
    return (*_pid(Facts(1.0, None, 1.0, 1.0)), *filters)


def settings(values: dict[str, float], facts: Facts) -> LoopSettings:
    """The loop that a file sets; arguments as `sinamics.settings`.

    Raises:
        InputError: a parameter missing, a type that is no filter.
    """
    gain, integral, kv = (wanted(values, one.name, FORM.name) / one.per_si for one in _pid(facts)[:3])
    filters = []
    for number in range(LIMITS.most):
        names = [parameter.name for parameter in _biquad(number)]
        if names[0] not in values:
            continue
        kind, frequency, quality = (wanted(values, name, FORM.name) for name in names)
        if kind not in (_LOW_PASS, _NOTCH) or not 0.5 <= quality <= 2:
            raise InputError(f"type {kind:g} with Q {quality:g}", names[0], "types 1 and 2 with Q of 0.5 to 2 are read")
        filters.append(FilterChoice("PT2" if kind == _LOW_PASS else "notch", frequency, 1 / (2 * quality)))
    return LoopSettings(gain, gain / integral if integral else math.inf, kv, tuple(filters))
