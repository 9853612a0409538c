"""SINAMICS S120 under SINUMERIK: p1460, p1462, the four current set-point filters, MD32200.

    general filter   (s^2/wz^2 + 2 Dz s/wz + 1) / (s^2/wn^2 + 2 Dn s/wn + 1)
    band-stop of defined depth K at f, B wide at -3 dB:  wn = wz = 2 pi f,  Dn = B / 2f,  Dz = Dn 10^(K/20)

Filter k = 1..4 is p(1652 + 5k) type, then frequency and damping of the denominator, frequency and damping of the
numerator; p1656 has one bit for each that is active.
"""

from __future__ import annotations

import math

from feeddrive.errors import InputError
from feeddrive.servo.cascade import KV_UNIT
from feeddrive.tuning.drive_forms.parameter import DriveForm, Facts, Line, LoopSettings, Parameter, wanted
from feeddrive.tuning.filter_choice import FilterChoice, FilterLimits

_LIST = "SINAMICS S210 list manual, firmware 5.2, p1460 and p1462"
_NUMBERS = "public reader of SINUMERIK archives ArchiveScope (config.py), after Siemens 109783558"
_FUNCTIONS = "SINAMICS S120 Function Manual FH1 07/2007 p. 81, 06/2012 p. 137"
_SERVO_GAIN = "SINUMERIK 808D Parameter Manual 08/2015 p. 234, 6FC5397-8EP40-0BA1"

FORM = DriveForm(
    "sinamics",
    "SINAMICS S120 with SINUMERIK",
    "drive parameters p... of the active data set; machine data MD...",
    (_LIST, _NUMBERS, _FUNCTIONS, _SERVO_GAIN),
)
LIMITS = FilterLimits(most=4, frequency=(0.5, 16000.0), damping=(0.001, 10.0), depth=(1.0, 60.0))

_GAIN = Parameter("p1460[0]", "N m s/rad", "speed controller P gain", 1.0, 4, 0.0, 5e8, _LIST)
_RESET = Parameter("p1462[0]", "ms", "speed controller integral time", 1e3, 2, 0.0, 1e5, _LIST)
_KV = Parameter("MD32200", "(m/min)/mm", "POSCTRL_GAIN, servo gain factor", 1 / KV_UNIT, 4, 0.0, 2000.0, _SERVO_GAIN)
_ACTIVE = Parameter("p1656[0]", "", "active current set-point filters, one bit each", 1.0, 0, 0.0, 15.0, _NUMBERS)
_LOW_PASS, _GENERAL = 1, 2


def _filter_parameters(number: int) -> tuple[Parameter, ...]:
    first = 1652 + 5 * number
    what = f"current set-point filter {number}"
    rows = (
        ("", "type: 1 low-pass PT2, 2 general second order", 0, 1.0, 2.0),
        ("Hz", "denominator natural frequency", 1, 0.5, 16000.0),
        ("", "denominator damping", 3, 0.001, 10.0),
        ("Hz", "numerator natural frequency", 1, 0.5, 16000.0),
        ("", "numerator damping", 3, 0.0, 10.0),
    )
    return tuple(
        Parameter(f"p{first + i}[0]", unit, f"{what}, {text}", 1.0, digits, low, high, _NUMBERS)
        for i, (unit, text, digits, low, high) in enumerate(rows)
    )


def lines(loop: LoopSettings, facts: Facts) -> list[Line]:
    """The lines of a file.

    Raises:
        InputError: a value outside its range, or more filters than there are.
    """
    del facts
    reset = loop.reset_time if math.isfinite(loop.reset_time) else 0.0
    found = [
        _GAIN.line(loop.velocity_gain, -1),
        _RESET.line(reset, 1),
        _KV.line(loop.position_gain, -1),
        _ACTIVE.line(2 ** len(loop.filters) - 1),
    ]
    for number, choice in enumerate(loop.filters, 1):
        low_pass = choice.kind == "PT2"
        numerator = 0.7 if low_pass else choice.damping * 10 ** (-choice.depth / 20)
        values = (_LOW_PASS if low_pass else _GENERAL, choice.frequency, choice.damping, choice.frequency, numerator)
        pairs = list(zip(_filter_parameters(number), values, strict=True))
        found += [parameter.line(value) for parameter, value in (pairs[:3] if low_pass else pairs)]
    return found


def known() -> tuple[Parameter, ...]:
    """Every parameter that is read."""
    filters = (one for number in range(1, LIMITS.most + 1) for one in _filter_parameters(number))
    return (_GAIN, _RESET, _KV, _ACTIVE, *filters)


def settings(values: dict[str, float], facts: Facts) -> LoopSettings:
    """The loop that a file sets, by name to number as typed and facts of the axis.

    Raises InputError: a parameter missing, a filter that is not one of the two types.
    """
    del facts
    active = int(values.get(_ACTIVE.name, 0.0))
    filters = tuple(_filter(values, number) for number in range(1, LIMITS.most + 1) if active >> (number - 1) & 1)
    gain, reset, kv = (wanted(values, one.name, FORM.name) / one.per_si for one in (_GAIN, _RESET, _KV))
    return LoopSettings(gain, reset or math.inf, kv, filters)


def _filter(values: dict[str, float], number: int) -> FilterChoice:
    names = [parameter.name for parameter in _filter_parameters(number)]
    kind, frequency, damping = (wanted(values, name, FORM.name) for name in names[:3])
    if kind == _LOW_PASS:
        return FilterChoice("PT2", frequency, damping)
    if kind != _GENERAL:
        raise InputError(f"type {kind:g} is no filter type", names[0], "1 and 2 are possible")
    upper, numerator = (wanted(values, name, FORM.name) for name in names[3:])
    if upper != frequency or not 0 <= numerator < damping:
        what = f"{names[3]} and {names[4]} make no notch"
        raise InputError(what, FORM.name, "the cascade takes notches: equal frequencies, numerator damped less")
    depth = 20 * math.log10(damping / numerator) if numerator else math.inf
    return FilterChoice("notch", frequency, damping, depth)
