"""Declared friction of the linear guide on the table.

    F = [Fc + T(|v|)] tanh(v / v0) + Fv v + Ff v (v^2 + eps^2)^((n - 1) / 2)

| symbol | key | meaning | unit |
|---|---|---|---|
| Fc | coulomb | Coulomb level | N |
| v0 | smoothing_velocity | velocity at which tanh turns | m/s |
| Fv | viscous | viscous coefficient | N s/m |
| Ff | film_force | force of the oil film at 1 m/s | N |
| n | film_exponent | its exponent: F = Ff (v / 1 m/s)^n | 1 |
| T | velocity | speeds of a measured curve, ascending from 0 or more | m/s |
| T | force | friction at those speeds above Fc and Fv v; all of it with coulomb and viscous 0 | N |

Film and curve may be left out, and then cost nothing. The film's slope at rest, infinite as a power, is made finite
within eps = 10 µm/s; at ten times that it is 0.4 % low. Between its points the curve is a monotone cubic, outside it is
constant: let it cover the speeds that are run. The tanh creeps under a static load F < Fc at v0 atanh(F/Fc); where
sticking matters, add `presliding`.
Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 2; film: paper 003, (9).

Curves through a table of points that do not overshoot, as CasADi expressions of the points.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from feeddrive.effects.base import FrictionEffect, Motion, Parameter, Port, Signature, Value, listed
from feeddrive.errors import InputError
from feeddrive.typing import Expression

_NO_SLOPE = 1e-300
"""Keeps the slope of a flat table from 0/0, and changes no other."""


def smooth_curve(x: Expression, nodes: Expression, values: Expression) -> Expression:
    """Monotone cubic through the points (k, 1), constant outside.

    Between points it rises and falls where they do, and its slope is continuous; at an end point the slope is that of
    the neighbouring chord. Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300.
    """
    count = nodes.numel()
    if count == 1:
        return values[0]
    widths = [nodes[i + 1] - nodes[i] for i in range(count - 1)]
    chords = [(values[i + 1] - values[i]) / widths[i] for i in range(count - 1)]
    slopes = [chords[0], *(_slope(widths[i : i + 2], chords[i : i + 2]) for i in range(count - 2)), chords[-1]]
    result = values[0]
    for i in range(count - 1):
        s = ca.fmin(ca.fmax((x - nodes[i]) / widths[i], 0), 1)
        result += widths[i] * _rise(s, chords[i], slopes[i], slopes[i + 1])
    return result


def _slope(widths: list[Expression], chords: list[Expression]) -> Expression:
    """Weighted harmonic mean of two chords, 0 where they differ in sign."""
    first, second = 2 * widths[1] + widths[0], widths[1] + 2 * widths[0]
    same = ca.fmax(chords[0] * chords[1], 0) * ca.sign(chords[0])
    return (first + second) * same / (first * ca.fabs(chords[1]) + second * ca.fabs(chords[0]) + _NO_SLOPE)


def _rise(s: Expression, chord: Expression, start: Expression, end: Expression) -> Expression:
    """Rise of Hermite's cubic over its width, from 0 at s = 0 to the chord at s = 1."""
    return s * (start + s * ((3 * chord - 2 * start - end) + s * (start + end - 2 * chord)))


if TYPE_CHECKING:
    from feeddrive.parts.guide.guide_coefficients import GuideCoefficients
    from feeddrive.parts.guide.guide_geometry import BallGuide

REST_VELOCITY = 1e-5
"""eps [m/s]: below this velocity the force of the film is linear."""

_OPTIONAL = (("film_force", "film_exponent"), ("velocity", "force"))
"""Keys that come together or not at all."""


class GuideFriction(FrictionEffect):
    """Coulomb and viscous friction of the guide, its oil film, or a measured curve."""

    name = "guide_friction"
    ports = (Port.TABLE,)
    parameters = (
        Parameter("coulomb", "N", 0.0, size=50.0),
        Parameter("smoothing_velocity", "m/s", 1e-7, 1.0, size=1e-3),
        Parameter("viscous", "N s/m", 0.0, size=100.0, default=0.0),
        Parameter("film_force", "N", 0.0, size=10.0, default=0.0),
        Parameter("film_exponent", "1", 0.05, 1.0, size=0.1, default=0.325),
        Parameter("velocity", "m/s", 0.0, 100.0, size=0.1, default=0.0, table=True),
        Parameter("force", "N", 0.0, size=10.0, default=0.0, table=True),
    )
    signature = Signature(("motor_torque", "table_position"), "table_velocity", ("friction_deviation",))
    declared = True

    @classmethod
    def complete(cls, values: Mapping[str, Value]) -> dict[str, Value]:
        """Values with defaults, without the film or the curve where none is given.

        Raises:
            InputError: as every effect, and a curve of unequal lists or with speeds that do not ascend.
        """
        filled = super().complete(values)
        absent = {key for keys in _OPTIONAL if not any(key in values for key in keys) for key in keys}
        _refuse_bad_curve(filled["velocity"], filled["force"])
        return {key: value for key, value in filled.items() if key not in absent}

    def turning_points(self) -> dict[str, tuple[float, ...]]:
        """The speeds of the measured curve, which is monotone between them."""
        return {"speed": (0.0, *listed(self.values["velocity"]))} if "velocity" in self.values else {}

    def shape(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """tanh(v / v0)."""
        return ca.tanh(motion.velocity / p["smoothing_velocity"])

    def level(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Coulomb level and curve [N]."""
        if "velocity" not in p:
            return p["coulomb"]
        return p["coulomb"] + smooth_curve(ca.fabs(motion.velocity), p["velocity"], p["force"])

    def viscous(self, motion: Motion, p: Mapping[str, Expression]) -> Expression:
        """Viscous force and that of the film [N]."""
        v = motion.velocity
        if "film_force" not in p:
            return p["viscous"] * v
        return p["viscous"] * v + p["film_force"] * v * (v**2 + REST_VELOCITY**2) ** ((p["film_exponent"] - 1) / 2)


def guide_effect(
    guide: BallGuide,
    coefficients: GuideCoefficients,
    carriages: int,
    load_per_carriage: float = 0.0,
    seal_drag: float = 0.0,
    smoothing_velocity: float = 0.5e-3,
) -> GuideFriction:
    """Friction of a table on ball guides: rolling, slip and seals as Coulomb level, the oil film as power of speed.

    The power law leaves the film's force by less than 0.03 % from 1 mm/s to 2 m/s.

    Args:
        guide: geometry and preload of the guide.
        coefficients: of rolling and slip, and the oil.
        carriages: under the table.
        load_per_carriage: vertical, weight and process [N].
        seal_drag: of one carriage [N].
        smoothing_velocity: v0 [m/s].

    Raises:
        InputError: as `table_friction`.

    Warns:
        ValidityWarning: contact pressure that dents the races.
    """
    from feeddrive.parts.guide.guide_carriage import table_friction  # Hertz's contacts take time to import

    low, high = 0.01, 1.0
    forces = table_friction(guide, coefficients, carriages, np.array([low, high]), load_per_carriage, seal_drag)
    coulomb = float(forces.coulomb[0])
    at_low, at_high = (float(force) for force in forces.viscous)
    if at_high == 0.0:
        return GuideFriction.of(coulomb=coulomb, smoothing_velocity=smoothing_velocity)
    exponent = float(np.log(at_high / at_low) / np.log(high / low))
    return GuideFriction.of(
        coulomb=coulomb, smoothing_velocity=smoothing_velocity, film_force=at_high, film_exponent=exponent
    )


def _refuse_bad_curve(velocity: Value, force: Value) -> None:
    """Refuse lists of unequal length, or speeds that do not ascend."""
    speeds, forces = (value if isinstance(value, tuple) else (value,) for value in (velocity, force))
    if len(speeds) != len(forces):
        what = f"velocity has {len(speeds)} and force has {len(forces)} values"
        raise InputError(what, "guide_friction", "write lists of equal length")
    if any(b <= a for a, b in pairwise(speeds)):
        raise InputError("velocity does not ascend", "guide_friction", "write speeds in ascending order, none twice")
