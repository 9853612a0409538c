"""What a thermal rig is made of: screw, nut, bearing seats, travel of the nut, steel.

The shaft is a solid cylinder of the pitch circle's diameter, the nut a hollow cylinder around it (paper 002, section 2,
assumption 1). A bearing is a stretch of the shaft's end with a film coefficient of its own and heat on its surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from feeddrive.errors import InputError
from feeddrive.units.quantity import format_quantity


def refuse_unless(holds: bool, what: str, where: str, mend: str) -> None:
    """Raise `InputError` unless something holds."""
    if not holds:
        raise InputError(what, where, mend)


def refuse_unless_positive(value: float, unit: str, where: str) -> None:
    """Raise `InputError` unless a value is finite and above zero."""
    good = math.isfinite(value) and value > 0
    refuse_unless(good, f"{format_quantity(value, unit)} is not possible", where, "write a value above zero")


def refuse_negative(value: float, unit: str, where: str) -> None:
    """Raise `InputError` where a value is negative or not finite."""
    good = math.isfinite(value) and value >= 0
    refuse_unless(good, f"{format_quantity(value, unit)} is not possible", where, "write zero or a value above it")


@dataclass(frozen=True)
class Steel:
    """Material of shaft and nut.

    Attributes:
        conductivity: λ [W/(m K)].
        heat_capacity: ρc, of volume [J/(m³ K)].
        expansion: α of length [1/K].
    """

    conductivity: float = 50.0
    heat_capacity: float = 3.926e6
    expansion: float = 11.7e-6

    def __post_init__(self) -> None:
        refuse_unless_positive(self.conductivity, "W/(m K)", "conductivity")
        refuse_unless_positive(self.heat_capacity, "J/(m^3 K)", "heat_capacity")
        refuse_unless(math.isfinite(self.expansion), "expansion is not a number", "expansion", "write a number")

    @property
    def diffusivity(self) -> float:
        """α = λ/(ρc) [m²/s]."""
        return self.conductivity / self.heat_capacity


@dataclass(frozen=True)
class Nut:
    """The nut, both halves of a double nut with their spacer.

    Attributes:
        outer_radius: [m].
        length: [m].
        end_share: share of the two end faces that convects, 0 where they are covered by the table and wipers.
    """

    outer_radius: float
    length: float
    end_share: float = 0.0

    def __post_init__(self) -> None:
        refuse_unless_positive(self.outer_radius, "m", "nut.outer_radius")
        refuse_unless_positive(self.length, "m", "nut.length")
        good = 0 <= self.end_share <= 1
        refuse_unless(good, f"{self.end_share} is no share", "nut.end_share", "write a number from 0 to 1")


@dataclass(frozen=True)
class Seat:
    """A bearing's seat at one end of the shaft.

    Attributes:
        length: of the stretch that takes the bearing's heat [m].
        film: film coefficient on its surface [W/(m² K)]; None for that of the bare shaft.
        end_share: share of the shaft's end face that convects with `film`; 0 is adiabatic.
    """

    length: float = 0.010
    film: float | None = None
    end_share: float = 0.0

    def __post_init__(self) -> None:
        refuse_unless_positive(self.length, "m", "seat.length")
        if self.film is not None:
            refuse_negative(self.film, "W/(m^2 K)", "seat.film")
        good = 0 <= self.end_share <= 1
        refuse_unless(good, f"{self.end_share} is no share", "seat.end_share", "write a number from 0 to 1")
        ownless = self.end_share > 0 and self.film is None
        refuse_unless(not ownless, "an end face convects but has no film", "seat.film", "write the seat's film")


@dataclass(frozen=True)
class Travel:
    """Where the nut's centre goes to and fro at constant speed; low = high is a nut that stays [m]."""

    low: float
    high: float

    def __post_init__(self) -> None:
        good = math.isfinite(self.low) and math.isfinite(self.high) and self.low <= self.high
        refuse_unless(good, f"{self.low:g} m to {self.high:g} m is no travel", "travel", "write the lower end first")

    @property
    def stroke(self) -> float:
        """Length of the travel [m]."""
        return self.high - self.low


@dataclass(frozen=True)
class Body:
    """A body attached to the nut or to a seat: motor, bearing housing, table; of one temperature.

    Attributes:
        name: of its heat among the inputs and of its rise among the outputs.
        port: "nut", "front" or "rear".
        capacity: [J/K].
        conductance: to the surface at the port [W/K].
        to_air: to the surroundings [W/K].
    """

    name: str
    port: str
    capacity: float
    conductance: float
    to_air: float = 0.0

    def __post_init__(self) -> None:
        ports = ("nut", "front", "rear")
        refuse_unless(self.port in ports, f'no port "{self.port}"', self.name, f"known are {', '.join(ports)}")
        refuse_unless_positive(self.capacity, "J/K", f"{self.name}.capacity")
        refuse_negative(self.conductance, "W/K", f"{self.name}.conductance")
        refuse_negative(self.to_air, "W/K", f"{self.name}.to_air")


@dataclass(frozen=True)
class BothEnds:
    """What holds a shaft whose bearings take axial force at both ends.

    Attributes:
        near, far: axial stiffness of the bearings at the front and at the rear end [N/m].
        axial_rigidity: E A of the shaft [N].
    """

    near: float
    far: float
    axial_rigidity: float

    def __post_init__(self) -> None:
        refuse_unless_positive(self.near, "N/m", "near_stiffness")
        refuse_unless_positive(self.far, "N/m", "far_stiffness")
        refuse_unless_positive(self.axial_rigidity, "N", "axial_rigidity")


@dataclass(frozen=True)
class Rig:
    """Geometry and material of shaft and nut.

    Attributes:
        radius: of the shaft, half the pitch circle's diameter or the nominal radius [m].
        length: of the shaft [m].
        nut: the nut.
        travel: of the nut's centre, counted from the front (motor-side) end [m].
        front, rear: seats at the two ends.
        steel: material.
        nut_heat_share: share of the nut's friction heat that enters on the nut's side of the contact, the rest on the
            shaft's (0.5 in paper 002).
        growth_positions: of the nut, where the growth of the table position is wanted [m].
        both_ends: what holds the shaft axially at both ends; None where the front bearing alone does.
    """

    radius: float
    length: float
    nut: Nut
    travel: Travel
    front: Seat = field(default_factory=Seat)
    rear: Seat = field(default_factory=Seat)
    steel: Steel = field(default_factory=Steel)
    nut_heat_share: float = 1.0
    growth_positions: tuple[float, ...] = ()
    both_ends: BothEnds | None = None

    def __post_init__(self) -> None:
        refuse_unless_positive(self.radius, "m", "radius")
        refuse_unless_positive(self.length, "m", "length")
        wider = self.nut.outer_radius > self.radius
        refuse_unless(
            wider, "the nut is not wider than the shaft", "nut.outer_radius", "write the radius, not the bore"
        )
        self.refuse_travel(self.travel)
        good = self.front.length + self.rear.length < self.length
        refuse_unless(good, "the seats are longer than the shaft", "seat.length", "write shorter seats")
        good = 0 <= self.nut_heat_share <= 1
        refuse_unless(good, f"{self.nut_heat_share} is no share", "nut_heat_share", "write a number from 0 to 1")
        for position in self.growth_positions:
            good = 0 < position <= self.length
            refuse_unless(good, f"{position:g} m is not on the shaft", "growth_positions", "count from the front end")

    def refuse_travel(self, travel: Travel) -> None:
        """Refuse a travel on which the nut leaves the shaft.

        Raises:
            InputError: a stroke longer than the shaft allows, or a nut beyond one of the ends.
        """
        room = self.length - self.nut.length
        long = f"a stroke of {travel.stroke * 1e3:.4g} mm is longer than the {max(room, 0) * 1e3:.4g} mm there are"
        refuse_unless(travel.stroke <= room * (1 + 1e-12), long, "travel", "write a shorter stroke")
        half, slack = self.nut.length / 2, 1e-9 * self.length
        inside = travel.low >= half - slack and travel.high <= self.length - half + slack
        ends = f"the nut's centre must stay within {half * 1e3:.4g} mm to {(self.length - half) * 1e3:.4g} mm"
        refuse_unless(inside, "the nut leaves the shaft", "travel", ends)
        self._refuse_nut_on_bearing(travel, half - slack)

    def _refuse_nut_on_bearing(self, travel: Travel, half: float) -> None:
        front = travel.low - half >= self.front.length or self.front.film is None
        rear = travel.high + half <= self.length - self.rear.length or self.rear.film is None
        refuse_unless(front and rear, "the nut runs over a bearing", "travel", "write a travel between the seats")
