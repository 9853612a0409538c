"""The distributed screw with standing waves in its spans, so that it holds up to any frequency that is asked for.

Between its ends a span of the screw moves as a straight line and `waves` sines on top of it,

    u(s) = u_1 (1 - s) + u_2 s + sum_k a_k sin(k pi s),     0 <= s <= 1,  k = 1 .. waves

with mass per length mu, length l and rigidity R (EA; inertia j and GJ in torsion), y = w l / c, c^2 = R / mu:

    M: mu l [1/3 1/6; 1/6 1/3] of the ends,  mu l / 2 of a_k,  mu l / (k pi) and (-1)^(k+1) mu l / (k pi) between them
    K: R / l of u_1 - u_2,  (k pi)^2 R / (2 l) of a_k

The sines are held at both ends, so that the static stiffness stays exact and a rigid motion leaves every a_k at zero.
What k > waves would add to the dynamic stiffness of the ends is, exactly,

    Delta = -sum_{k > waves} (R / l) 2 y^4 / ((k pi)^4 (1 - (y / k pi)^2)) [1 -(-1)^k; -(-1)^k 1]

A mode's w^2 is too high by u' Delta u over w^2 times twice its kinetic energy. Ends that move against each other (even
k) have the least kinetic energy for it, mu l u^2 / 3. So a frequency is too high by at most, to first order in Delta,

    12 y^2 sum_{k > waves} 1 / ((k pi)^4 (1 - (y / k pi)^2))

as if all kinetic energy were in this one span. `reach` is the y at which this is `tolerance`.

Hubs and wheels between motor and screw move by h_j beside the place that the static chain gives them, (1 - a_j) thm / i
+ a_j p1: mass J_j with (1 - a_j) / i, a_j and 1, and springs k_d / (a_j+1 - a_j) between the h of neighbours (0 at both
ends). What h adds to the stiffness stands by itself, since the static chain is in balance.

Supports, nut, coupling and gear are springs without mass, as in `feeddrive.plant.chain.distributed_screw`; the stub
outside the near bearing and the end outside the far one move axially with their bearing.

Source: Craig and Bampton, AIAA Journal 6 (1968) 1313, for the shapes; the bound follows from the expansion given.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from scipy.optimize import brentq

from feeddrive.plant.chain.distributed_screw import DistributedScrew
from feeddrive.plant.chain.linear_chain import Hubs, Matrix, Spring, Values
from feeddrive.typing import Expression

MOST_WAVES = 40
"""Per span; beyond them the screw is no rod any more: 40 half waves of 1 m are as short as its diameter."""

_SUMMED = 400  # terms of the sum; what follows is below 1e-7 of it


@dataclass(frozen=True)
class _Span:
    """A length of the screw: names of its ends, of its waves; length, rigidity, mass per length."""

    ends: tuple[str, str]
    name: str
    length: Expression
    rigidity: Expression
    per_length: Expression


@dataclass(frozen=True)
class ScrewWithWaves(DistributedScrew):
    """The distributed screw with standing waves between the ends of its spans.

    Attributes:
        waves: of each span, 0 or more.
        hubs: (a_j, J_j) of what turns between motor and screw, a ascending between 0 and 1 [1, kg m^2].
    """

    waves: int = 0
    hubs: Hubs = ()

    @property
    def coordinates(self) -> tuple[str, ...]:
        def names(span: str) -> list[str]:
            return [f"{span}_wave_{k}" for k in range(1, self.waves + 1)]

        hubs = [f"hub_{j}" for j in range(1, len(self.hubs) + 1)]
        turning = ["motor", *hubs, "drive_end", *names("main"), "screw", *names("overhang"), "free_end"]
        along = ["near_axial", *names("near_axial"), "axial", *names("far_axial"), "far_axial"]
        return (*turning, *along, "table")

    @property
    def key(self) -> tuple[object, ...]:
        return (self.structure, "waves", self.waves, self.hubs)

    def springs(self, p: Values, position: Expression = 0.0) -> tuple[Spring, ...]:
        tau = p["damping_time"]
        drive = self._row(motor=1 / p["ratio"], drive_end=-1.0)
        springs = [Spring("drive", drive, p["drive_stiffness"], p["drive_damping"])]
        shares = [0.0, *(share for share, _ in self.hubs), 1.0]
        for j in range(1, len(shares) if self.hubs else 0):
            between = {f"hub_{at}": sign for at, sign in ((j - 1, 1.0), (j, -1.0)) if 0 < at <= len(self.hubs)}
            part = shares[j] - shares[j - 1]
            springs.append(
                Spring("drive", self._row(**between), p["drive_stiffness"] / part, p["drive_damping"] / part)
            )
        for span, kind in zip(self._rods(p, position), _KINDS, strict=True):
            k = span.rigidity / span.length
            springs.append(Spring(kind, self._row(**{span.ends[0]: 1.0, span.ends[1]: -1.0}), k, tau * k))
            for number in range(1, self.waves + 1):
                own = 0.5 * (number * math.pi) ** 2 * k
                springs.append(Spring(kind, self._row(**{f"{span.name}_wave_{number}": 1.0}), own, tau * own))
        for end, key in (("near_axial", "bearing_stiffness"), ("far_axial", "far_bearing_stiffness")):
            springs.append(
                Spring("far_bearing" if "far" in key else "bearing", self._row(**{end: 1.0}), p[key], tau * p[key])
            )
        return (*springs, self.nut(p))

    def mass(self, p: Values, position: Expression = 0.0) -> Matrix:
        names = self.coordinates
        place = {name: i for i, name in enumerate(names)}
        matrix: Matrix = [[0.0] * len(names) for _ in names]

        def add(one: str, other: str, value: Expression) -> None:
            i, j = place[one], place[other]
            matrix[i][j] += value
            if i != j:
                matrix[j][i] += value

        add("motor", "motor", p["motor_inertia"])
        add("motor", "drive_end", p["shared_inertia"] / p["ratio"])
        add("drive_end", "drive_end", p["drive_end_inertia"])
        for j, (share, inertia) in enumerate(self.hubs, 1):
            add(f"hub_{j}", f"hub_{j}", inertia)
            add(f"hub_{j}", "motor", inertia * (1 - share) / p["ratio"])
            add(f"hub_{j}", "drive_end", inertia * share)
        add("table", "table", p["table_mass"])
        add("near_axial", "near_axial", p["mass_per_length"] * p["drive_length"])
        beyond = p["screw_length"] - p["bearing_distance"]
        add("far_axial", "far_axial", p["mass_per_length"] * beyond)
        for span in self._rods(p, position):
            whole, (first, last) = span.per_length * span.length, span.ends
            for end in span.ends:
                add(end, end, whole / 3)
            add(first, last, whole / 6)
            for number in range(1, self.waves + 1):
                wave, share = f"{span.name}_wave_{number}", whole / (number * math.pi)
                add(wave, wave, whole / 2)
                add(first, wave, share)
                add(last, wave, share if number % 2 else -share)
        return matrix

    def _rods(self, p: Values, position: Expression) -> tuple[_Span, ...]:
        main, over, far = self._spans(p, position)
        near = self.nut_place(p, position)
        turning = p["torsional_rigidity"], p["inertia_per_length"]
        along = p["axial_rigidity"], p["mass_per_length"]
        return (
            _Span(("drive_end", "screw"), "main", main, *turning),
            _Span(("screw", "free_end"), "overhang", over, *turning),
            _Span(("near_axial", "axial"), "near_axial", near, *along),
            _Span(("axial", "far_axial"), "far_axial", far, *along),
        )


_KINDS = ("screw_torsion", "overhang_torsion", "axial", "far_axial")
"""Names of the springs of the spans, in their order."""


def waves_needed(chain: DistributedScrew, frequency: float, position: float, tolerance: float = 0.01) -> int:
    """Waves of each span with which frequencies up to one [Hz] are too high by a share of `tolerance` [1] at most.

    The spans are those of the chain, as its values say, with the table at `position` [m].
    """
    longest = 0.0
    for span in ScrewWithWaves(chain.values, 1, 0)._rods(chain.values, position):
        speed = math.sqrt(float(span.rigidity) / float(span.per_length))
        longest = max(longest, 2 * math.pi * frequency * float(span.length) / speed)
    return next((m for m in range(MOST_WAVES) if longest <= reach(m, tolerance)), MOST_WAVES)


@lru_cache(maxsize=512)
def reach(waves: int, tolerance: float) -> float:
    """y = w l / c of a span up to which a frequency is at most `tolerance` too high with so many waves."""

    def excess(y: float) -> float:
        terms = ((k * math.pi, y / (k * math.pi)) for k in range(waves + 1, waves + 1 + _SUMMED))
        return 12 * y**2 * math.fsum(1 / (at**4 * (1 - ratio**2)) for at, ratio in terms) - tolerance

    first_left_out = (waves + 1) * math.pi
    return float(brentq(excess, 1e-9, first_left_out * (1 - 1e-9)))
