"""The nut: axial stiffness F = k_N x [N/m], and how it follows from a catalogue's value at another preload.

    k_N = f_ar R_nu (F_pr / F_pr,cat)^(1/3)

Symbols at `stiffness_at_preload`. Valid while both nuts stay loaded, up to an axial force of 2.8 times a rigid preload;
there one nut alone is left, 0.7 times as stiff. Source: ISO 3408-4; Hertz for the cube root; k_N of paper 004, eq. (6).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from feeddrive.parts.values import PartValue, check_values, part_values

CATALOGUE_VALUES = part_values("""
catalogue_stiffness | N/m | (100000, 1e11) usual 1e7 to 5e9 | | nut stiffness as the catalogue states it, R_nu
catalogue_preload | N | (0, 1e7) usual 10 to 100000 | | preload or load at which the catalogue states it
preload | N | (0, 1e7) usual 10 to 100000 | | preload of this nut
accuracy_factor | 1 | [0, 1] usual 0.4 to 1 | | share of the stated stiffness that real balls and grooves reach, f_ar
""")
"""Values of a nut whose stiffness follows from a catalogue's value at another preload."""


@dataclass(frozen=True)
class Nut:
    """A preloaded nut.

    Attributes:
        axial_stiffness: between screw and nut body, R_nu,ar of ISO 3408-4 [N/m].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    axial_stiffness: float

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
axial_stiffness | N/m | (100000, 1e11) usual 1e7 to 5e9 | | stiffness between screw and nut body at the preload, R_nu,ar
""")

    def __post_init__(self) -> None:
        check_values("nut", self.values, vars(self))


def stiffness_at_preload(
    catalogue_stiffness: float, catalogue_preload: float, preload: float, accuracy_factor: float
) -> float:
    """R_nu,ar = f_ar R_nu (F_pr / F_pr,cat)^(1/3): a nut's stiffness at the preload it is delivered with [N/m].

    Args:
        catalogue_stiffness: R_nu, theoretical, with the nut body [N/m].
        catalogue_preload: preload or load that the catalogue states it for [N].
        preload: of this nut [N].
        accuracy_factor: f_ar, share of the theory that real balls and grooves reach; 1 where the catalogue's value
            holds it already.

    Raises:
        InputError: a value that is not possible.

    Validity: while the load leaves balls on both sides loaded. Source: ISO 3408-4 (symbols), Hertz contact (cube root).
    """
    given = {
        "catalogue_stiffness": catalogue_stiffness,
        "catalogue_preload": catalogue_preload,
        "preload": preload,
        "accuracy_factor": accuracy_factor,
    }
    check_values("nut", CATALOGUE_VALUES, given)
    return float(accuracy_factor * catalogue_stiffness * (preload / catalogue_preload) ** (1.0 / 3.0))
