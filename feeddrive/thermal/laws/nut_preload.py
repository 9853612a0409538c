"""Preload of a double nut with spacer while nut and shaft differ in temperature.

    axial:   ΔF = ± (k/2) α s D          radial:   ΔF = -k α (d_m/2) D cot β

| symbol | meaning | unit |
|---|---|---|
| D | nut (with spacer) hotter than the shaft by | K |
| k | axial stiffness of one nut at its preload, 1.5 F/δ_a | N/m |
| s | distance of the two ball groups | m |
| d_m | pitch diameter | m |
| β | contact angle, from the radial direction | rad |

The groove of the nut leaves its balls by u_r cos β - u_a sin β along the contact normal, u_r = α (d_m/2) D outward and
u_a = ± α (s/2) D along the axis. The same leaving comes from an axial way u_r cot β - u_a of the nut, so ΔF is k times
that. + with an oversize spacer, which pushes the nuts apart, - with an undersize one. The radial part unloads in either
case: the groove in the nut grows away from the balls. Equal temperatures change nothing; balls hotter than both are
left out. Valid for a nut whose body is stiff beside its contacts and D small enough that ΔF stays below F. The turn of
the contact angle under the load is left out: with c the distance of the groove centres (some tenths of a millimetre) it
adds (F/c) (u_a cos²β / sin β + u_r cos β), 2 to 4 % of the radial part as nuts are built.
"""

from __future__ import annotations

import math
import warnings
from enum import Enum

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.rig import refuse_unless_positive
from feeddrive.units.quantity import format_quantity


class Spacer(Enum):
    """How the spacer preloads: the sign of the axial part."""

    OVERSIZE = 1
    UNDERSIZE = -1


def preload_change(
    difference: float, preload: float, stiffness: float, group_distance: float, pitch_diameter: float,
    contact_angle: float, spacer: Spacer, expansion: float = 11.7e-6,
) -> float:  # fmt: skip
    """ΔF [N].

    Args:
        difference: D, nut over shaft [K].
        preload: F [N].
        stiffness: k of one nut [N/m].
        group_distance: s [m].
        pitch_diameter: d_m [m].
        contact_angle: β, from the radial direction, below π/2 [rad].
        spacer: oversize or undersize.
        expansion: α [1/K].

    Raises:
        InputError: a value that is not positive, or a contact angle of π/2 or more.

    Warns:
        ValidityWarning: the whole preload is lost; the balls are loose then.
    """
    for value, unit, where in (
        (preload, "N", "preload"),
        (stiffness, "N/m", "stiffness"),
        (group_distance, "m", "group_distance"),
        (pitch_diameter, "m", "pitch_diameter"),
        (contact_angle, "rad", "contact_angle"),
    ):
        refuse_unless_positive(value, unit, where)
    if contact_angle >= math.pi / 2:
        what = f"{format_quantity(contact_angle, 'rad')} is no angle from the radial direction"
        raise InputError(what, "contact_angle", "write it below 90 deg")
    axial = spacer.value * stiffness / 2 * group_distance
    radial = stiffness * pitch_diameter / 2 / math.tan(contact_angle)
    change = expansion * difference * (axial - radial)
    if preload + change < 0:
        loss = f"{difference:.3g} K between nut and shaft take {format_quantity(-change, 'N')}"
        warnings.warn(
            f"{loss} of {format_quantity(preload, 'N')} preload: the nut is loose", ValidityWarning, stacklevel=2
        )
    return change
