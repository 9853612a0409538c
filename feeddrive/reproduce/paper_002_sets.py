"""The two sets of assumptions under which paper 002 is computed; what it does not give stands here, in one place.

Both: shaft radius 8 mm (16 mm screw), nut outer radius 20 mm (40 radial cells), 500 mm shaft, the nut's centre travels
100 mm at mid shaft, λ 50 W/(m K), no air on the nut's end faces nor on the shaft under the nut, adiabatic shaft ends.

P, "as printed": half of ω T in all (π N T/60), half on each side, contact of table 5, ρc 3.8e6, nut 80 mm, front
   bearing on a 10 mm seat with h_b and its full heat. Read literally, (25) to (29) heat two to four times as much: this
   reading and the nut's length were chosen because figure 7 then comes out.
F, "fitted": 0.609 ω T all on the nut's side, ten times the contact, ρc 3.926e6, nut 100 mm, no bearing heat.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from feeddrive.thermal.full.full_model import NUT, discretise, model_of
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.full.moving import moving_system
from feeddrive.thermal.laws.films import Films
from feeddrive.thermal.laws.friction import Friction, nut_load_torque
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.reduction import compressed_basis
from feeddrive.thermal.rig import Nut, Rig, Seat, Steel, Travel
from feeddrive.typing import FloatArray

SPEEDS = (250, 500, 750)
"""[rev/min]"""
PRELOADS = (670, 1300)
"""[N]"""

SCREW_FILM = 0.29033
"""h_s = 0.29033 N^(2/3), N in rev/min, through table 3 [W/(m² K)]."""
LOAD_CONSTANT = 4.1364e-4
"""In place of 1.93e-4·κ·cot(contact angle) in (22), through table 4 [N^-0.33]."""
MEAN_DIAMETER = 16.75e-3
"""d_m that the slope of table 4 against N^(2/3) gives [m]."""
LEAD_ANGLE = math.atan(5e-3 / (math.pi * MEAN_DIAMETER))
CONTACT_MIDDLE = (125.0, 155.93)
"""Mean of the two sides in table 5 at 670 and 1300 N [W/(m² K)]."""

FILMS = Films(screw=SCREW_FILM * 250 ** (2 / 3), screw_least=0.0, nut_free=4.857, nut_forced=5.024)
BEARING_FILM = 9.7


GRID = Cells(100, 4, 20, 6)
"""Within 3 mK of one twice as fine; the paper's own would take ten times as long."""


class Assumptions(Enum):
    """The two sets."""

    PRINTED = "set P: all that is printed; heat 0.5 ωT and a nut of 80 mm chosen so that figure 7 comes out"
    FITTED = "set F: heat 0.609 ωT on the nut's side, contact x10, ρc and nut length fitted"


@dataclass(frozen=True, eq=False)
class WarmUp:
    """Rise of the nut over 180 min.

    Attributes:
        minutes: (k,) [min].
        nut, shaft: rise of the nut's surface and mean of the shaft over the travel, (k,) [K].
    """

    minutes: FloatArray
    nut: FloatArray
    shaft: FloatArray

    @property
    def rise(self) -> float:
        """At 180 min [K]."""
        return float(self.nut[-1])

    @property
    def time_constant(self) -> float:
        """Time to 1 - 1/e of the rise at 180 min [min]."""
        return float(np.interp((1 - math.exp(-1)) * self.rise, self.nut, self.minutes))


def plant(assumptions: Assumptions, preload: float) -> Heat:
    """The paper's machine at a preload [N]."""
    printed = assumptions is Assumptions.PRINTED
    travel = Travel(0.2, 0.3)
    rig = Rig(
        0.008, 0.5, Nut(0.020, 0.080 if printed else 0.100), travel,
        front=Seat(0.010, BEARING_FILM if printed else None),
        steel=Steel(heat_capacity=3.8e6 if printed else 3.926e6), nut_heat_share=0.5 if printed else 1.0,
    )  # fmt: skip
    contact = CONTACT_MIDDLE[PRELOADS.index(int(preload))] * (1 if printed else 10)
    return Heat(
        "paper 002", rig, FILMS, contact, preload, 5e-3 / (2 * math.pi),
        nut=nut_friction(preload, 0.5 if printed else 0.609), front=bearing_friction() if printed else None,
    )  # fmt: skip


def nut_friction(preload: float, heat_share: float = 1.0) -> Friction:
    """Friction of the double nut: grease, f0 = 2, two nuts of 2.5 turns, 170 mm²/s."""
    load = nut_load_torque(LOAD_CONSTANT, preload, MEAN_DIAMETER, LEAD_ANGLE)
    return Friction(load, 2 * 2 * 2.5, 170e-6, MEAN_DIAMETER, heat_share)


def bearing_friction() -> Friction:
    """Friction of the support bearing through table 4: 0.539 mN m and f0 = 3.915 at d_m 22 mm, 32 mm²/s."""
    return Friction(0.539e-3, 3.915, 32e-6, 0.022)


def torque(friction: Friction, speed: float) -> float:
    """Total torque [N m] at a speed [rev/min]."""
    return friction.load_torque + float(friction.viscous_torques(np.array([speed * math.pi / 30]))[0])


def warm_up(assumptions: Assumptions, preload: float, speed: float, *, with_contact: bool = True) -> WarmUp:
    """The paper's run: 180 min from rest, the nut moving (second-order average).

    Args:
        assumptions: which set.
        preload: [N].
        speed: [rev/min].
        with_contact: False for perfect contact between nut and shaft, a thousand times the conductance (averaged).
    """
    machine = plant(assumptions, preload)
    if not with_contact:
        machine = replace(machine, contact=1000 * machine.contact)
    turning = speed * math.pi / 30
    parts, conductances = discretise(machine.rig, GRID), machine.at_speed(turning)
    full = model_of(parts, machine.rig.travel).at(conductances)
    system = full
    if with_contact:
        system = moving_system(parts, conductances, machine.feed(turning), compressed_basis(full), harmonics=6)
    given = np.zeros(len(system.input_names))
    for name, heat in machine.heats(np.array([turning])).items():
        given[system.column(name)] = heat[0]
    outputs = system.outputs(system.simulate(np.tile(given, (360, 1)), 30.0))
    minutes = np.arange(361) / 2
    nut, shaft = (np.append(0.0, outputs[:, system.row(name)]) for name in (NUT, "shaft_travel"))
    return WarmUp(minutes, nut, shaft)
