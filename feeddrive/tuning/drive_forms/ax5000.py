"""Beckhoff AX5000 under TwinCAT: IDNs S-0-0100, S-0-0101, S-0-0104 and the filters of the current command.

Of the filters only the low-pass of second order is written: frequency and damping of the notch and of the phase
correction filter are described, their equations are not.
"""

from __future__ import annotations

import math

from feeddrive.errors import InputError
from feeddrive.servo.cascade import KV_UNIT
from feeddrive.tuning.drive_forms.parameter import DriveForm, Facts, Line, LoopSettings, Parameter, wanted
from feeddrive.tuning.filter_choice import FilterChoice, FilterLimits

_PAGES = "infosys.beckhoff.com/content/1033/ax5000_idn_description/"
FORM = DriveForm(
    "twincat",
    "Beckhoff AX5000",
    "IDNs of the drive; S-0-0100 counts in N m s/rad where bit 15 of P-0-0010 is set",
    (f"{_PAGES}: S-0-0100 1000502539, S-0-0101 1000532747, S-0-0104 1000602379, P-0-0515 1400883851",),
)
LIMITS = FilterLimits(
    most=3,
    notch=False,
    frequency=(1.0, 3200.0),
    damping=(0.01, 0.99),
    whole_hertz=True,
)

_GAIN = Parameter("S-0-0100", "N m s/rad", "velocity loop proportional gain", 1.0, 3, 0.0, 1e6, _PAGES + "1000502539")
_RESET = Parameter("S-0-0101", "ms", "velocity loop integral action time", 1e3, 1, 0.0, 6000.0, _PAGES + "1000532747")
_KV = Parameter("S-0-0104", "1000/min", "position loop Kv-factor", 1 / KV_UNIT, 2, 0.0, 100.0, _PAGES + "1000602379")
_FILTERS = ("P-0-0515", "P-0-0516", "P-0-0517")
_NONE, _LOW_PASS = 0, 3


def _filter_parameters(name: str) -> tuple[Parameter, Parameter, Parameter]:
    return (
        Parameter(f"{name}.FilterType", "", "0 none, 3 low-pass of 2nd order", 1.0, 0, 0, 5, _PAGES + "1400689291"),
        Parameter(f"{name}.LowPassFrequency", "Hz", "natural frequency", 1.0, 0, 1, 600000, _PAGES + "1400883851"),
        Parameter(f"{name}.LowPassDamping", "", "damping", 1.0, 8, 0.0, 0.99999999, _PAGES + "1400888971"),
    )


def lines(loop: LoopSettings, facts: Facts) -> list[Line]:
    """The lines of a file.

    Raises:
        InputError: a value outside its range, a filter that this form does not write.
    """
    del facts
    reset = loop.reset_time if math.isfinite(loop.reset_time) else 0.0
    found = [_GAIN.line(loop.velocity_gain, -1), _RESET.line(reset, 1), _KV.line(loop.position_gain, -1)]
    for place, name in enumerate(_FILTERS):
        kind, frequency, damping = _filter_parameters(name)
        if place >= len(loop.filters):
            found.append(kind.line(_NONE))
            continue
        choice = loop.filters[place]
        if choice.kind != "PT2":
            raise InputError("a notch is not written for this drive", FORM.name, "its equation is not published")
        found += [kind.line(_LOW_PASS), frequency.line(choice.frequency), damping.line(choice.damping)]
    return found


def known() -> tuple[Parameter, ...]:
    """Every parameter that is read."""
    return (_GAIN, _RESET, _KV, *(one for name in _FILTERS for one in _filter_parameters(name)))


def settings(values: dict[str, float], facts: Facts) -> LoopSettings:
    """The loop that a file sets; arguments as `sinamics.settings`.

    Raises:
        InputError: a parameter missing, a filter that is not a low-pass of second order.
    """
    del facts
    filters = []
    for name in _FILTERS:
        kind, frequency, damping = _filter_parameters(name)
        written = values.get(kind.name, _NONE)
        if written == _NONE:
            continue
        if written != _LOW_PASS:
            raise InputError(f"filter type {written:g} is not known", kind.name, "0 and 3 are read")
        low, damped = (wanted(values, one.name, FORM.name) for one in (frequency, damping))
        filters.append(FilterChoice("PT2", low, damped))
    gain, reset, kv = (wanted(values, one.name, FORM.name) / one.per_si for one in (_GAIN, _RESET, _KV))
    return LoopSettings(gain, reset or math.inf, kv, tuple(filters))
