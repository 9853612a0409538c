"""How a screw is held axially: four kinds of support, and the load that either end carries.

| kind | near end (motor) | far end | axial force goes to |
|---|---|---|---|
| fixed-free, fixed-supported | fixed | free, or sliding | the near end |
| fixed-fixed | fixed | fixed, both preloaded | both ends, like springs in parallel |
| supported-supported | thrust one way | thrust the other way | one end at a time, by direction of the force |

With c_1 = 1/k_1 + x / E A towards the near end and c_2 = 1/k_2 + (l - x) / E A towards the far end:

    one end   1/k = c_1          both ends   1/k = c_1 c_2 / (c_1 + c_2)        by direction   1/k = max(c_1, c_2)

The last is the softer of its two directions, the one to design for; the other one is never softer.

| symbol | meaning | unit |
|---|---|---|
| x, l | nut and far end from the near bearing | m |
| k_1, k_2 | axial stiffness of the bearings | N/m |

Source: paper 004, eq. (6), for one end; both ends: springs in parallel, R_s = E A l / (x (l - x)) of catalogues for
rigid bearings.

The bearing (set) that holds the screw axially: its stiffness, F = k_BG x with F in N, x in m.

Valid while the preload keeps all rows loaded, up to about 2.8 times it: a catalogue gives the stiffness at the preload.
Housing and clamping nut yield too and belong into `housing_stiffness` of the drive.
Source: catalogues; k_BG of paper 004, eq. (6).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

from feeddrive.errors import InputError
from feeddrive.parts.screw.ball_screw import ScrewShaft
from feeddrive.parts.values import PartValue, check_values, part_values


@dataclass(frozen=True)
class SupportBearing:
    """A support bearing that takes axial force.

    Attributes:
        axial_stiffness: of the preloaded set, without its housing [N/m].

    Raises:
        InputError: a value that is not possible.

    Warns:
        ValidityWarning: unusual value.
    """

    axial_stiffness: float

    values: ClassVar[tuple[PartValue, ...]] = part_values("""
axial_stiffness | N/m | (100000, 1e11) usual 1e7 to 1e10 | | axial stiffness of the preloaded set, without its housing
""")

    def __post_init__(self) -> None:
        check_values("bearing", self.values, vars(self))


class Support(Enum):
    """The four kinds, near end first."""

    FIXED_FREE = "fixed-free"
    FIXED_SUPPORTED = "fixed-supported"
    SUPPORTED_SUPPORTED = "supported-supported"
    FIXED_FIXED = "fixed-fixed"

    @property
    def far_end_takes_force(self) -> bool:
        """Whether the far bearing takes axial force."""
        return self in (Support.SUPPORTED_SUPPORTED, Support.FIXED_FIXED)


@dataclass(frozen=True)
class ScrewSupports:
    """The bearings of a screw.

    Attributes:
        kind: of support.
        near: bearing at the motor's end.
        far: bearing at the far end; None where it takes no axial force.

    Raises:
        InputError: a far bearing is missing, or takes no force in this kind of support.
    """

    kind: Support
    near: SupportBearing
    far: SupportBearing | None = None

    def __post_init__(self) -> None:
        if self.kind.far_end_takes_force and self.far is None:
            raise InputError(f"{self.kind.value} needs a bearing at the far end", "supports.far", "give its stiffness")
        if self.far is not None and not self.kind.far_end_takes_force:
            mend = f"leave it away or choose {Support.FIXED_FIXED.value}"
            raise InputError(f"takes no axial force when {self.kind.value}", "supports.far", mend)

    def load_shares(self, screw: ScrewShaft, position: float) -> tuple[float, float]:
        """Shares of the axial force at the nut, `position` [m] from the near bearing, that near and far one take.

        Their sum is 1; a position outside the screw raises InputError.
        """
        check_position(screw, position)
        if self.far is None:
            return 1.0, 0.0
        c_1 = 1.0 / self.near.axial_stiffness + position / screw.axial_rigidity
        c_2 = 1.0 / self.far.axial_stiffness + (screw.length - position) / screw.axial_rigidity
        if self.kind is Support.FIXED_FIXED:
            return c_2 / (c_1 + c_2), c_1 / (c_1 + c_2)
        return (1.0, 0.0) if c_1 >= c_2 else (0.0, 1.0)

    def compliances(self, screw: ScrewShaft, position: float) -> tuple[float, float, float]:
        """What near bearing, screw and far bearing add to the axial compliance at the nut [m/N].

        Each is twice its strain energy under a unit force, so that they add up to 1/k in all four kinds.
        Arguments and errors as `load_shares`.
        """
        near, far = self.load_shares(screw, position)
        shaft = (near**2 * position + far**2 * (screw.length - position)) / screw.axial_rigidity
        far_bearing = far**2 / self.far.axial_stiffness if self.far is not None else 0.0
        return near**2 / self.near.axial_stiffness, shaft, far_bearing

    def axial_stiffness(self, screw: ScrewShaft, position: float) -> float:
        """Stiffness of screw and bearings together at the nut [N/m]. Arguments and errors as `load_shares`."""
        return 1.0 / sum(self.compliances(screw, position))


def check_position(screw: ScrewShaft, position: float) -> None:
    """Refuse a nut that is not on the screw.

    Raises:
        InputError: position [m] outside 0 to the screw's length.
    """
    if not 0.0 <= position <= screw.length:
        what = f"the nut at {position * 1e3:.4g} mm is not on the screw"
        raise InputError(what, "position", f"choose 0 to {screw.length * 1e3:.4g} mm from the near bearing")
