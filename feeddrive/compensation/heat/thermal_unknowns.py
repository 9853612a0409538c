"""What a thermal compensation does not know, and how far and how fast it wanders; a machine that deviates so.

Every unknown is a mean-reverting walk, d/dt z = -z/T + white noise, of stationary standard deviation σ: it has a bound,
as the tolerances have, and is forgotten where no sensor sees it (a heat while the axis rests).

| unknown | σ | T | reasoning |
|---|---|---|---|
| heat of nut and bearings | 10 % | 8 h | catalogues' friction is no better; it drifts with the lubricant over a shift |
| film of screw and seats | 10 % | 8 h | correlations scatter by as much; it changes with the draught in the hall |
| film of the nut | 10 % | 8 h | as above; the nut's surroundings are others than the screw's |
| surroundings | 2 K | 4 h | a hall without air conditioning between morning and noon |
| heat at the front bearing | 2 W | 8 h | of motor and bearing, not declared; a few watts on an axis of half a metre |

They are stated before any run, not fitted to one. Left out, 1.8 W at the front would let two sensors take away two
thirds of the error and no more; carried, it costs them half of their precision where there is no such heat (and one
sensor most of it). State the size of your own machine's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.thermal.full.full_model import FRONT
from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, Path
from feeddrive.thermal.rig import refuse_negative, refuse_unless_positive
from feeddrive.thermal.run.warm_up import Rows
from feeddrive.typing import FloatArray

SCREW_FILMS = (Path.SCREW_FILM, Path.FRONT_FILM, Path.REAR_FILM)
"""Air on the turning screw and on its seats."""
NUT_FILMS = (Path.NUT_FILM,)
"""Air on the nut."""


def deviating(rows: Rows, heat: float = 1.0, screw_film: float = 1.0, nut_film: float = 1.0) -> Rows:
    """Rows with all heats and the films (screw with seats, nut) multiplied; temperatures of the surroundings stay.

    Raises InputError for a negative factor.
    """
    for factor, where in ((heat, "heat"), (screw_film, "screw_film"), (nut_film, "nut_film")):
        refuse_negative(factor, "1", where)
    following = rows.following
    films = {**dict.fromkeys(SCREW_FILMS, screw_film), **dict.fromkeys(NUT_FILMS, nut_film)}
    conductances: Mapping[Path, FloatArray] = {
        path: values * films.get(path, 1.0) for path, values in rows.conductances.items()
    }
    inputs = {name: values if name in (AMBIENT, COOLANT) else heat * values for name, values in rows.inputs.items()}
    scaled = None if following is None else lambda row, rises: heat * following(row, rises)
    return replace(rows, conductances=conductances, inputs=inputs, following=scaled)


HOUR = 3600.0


@dataclass(frozen=True)
class Unknowns:
    """Standard deviations and times of what is not known.

    Attributes:
        heat: of the factor on the declared heats [1].
        screw_film: of the factor on the films of screw and seats [1].
        nut_film: of the factor on the film of the nut [1].
        ambient: of the surroundings beside what is recorded (0.1 K, say), or beside the start where nothing is [K].
        factor_time: T of the factors and of `heats` [s].
        ambient_time: T of the surroundings [s].
        heats: names of inputs that may give heat beside the declared one, and their standard deviations [W].
    """

    heat: float = 0.10
    screw_film: float = 0.10
    nut_film: float = 0.10
    ambient: float = 2.0
    factor_time: float = 8 * HOUR
    ambient_time: float = 4 * HOUR
    heats: tuple[tuple[str, float], ...] = ((FRONT, 2.0),)

    def __post_init__(self) -> None:
        for key, unit in (("heat", "1"), ("screw_film", "1"), ("nut_film", "1"), ("ambient", "K")):
            refuse_negative(getattr(self, key), unit, f"unknowns.{key}")
        for name, value in self.heats:
            refuse_negative(value, "W", f"unknowns.heats.{name}")
        refuse_unless_positive(self.factor_time, "s", "unknowns.factor_time")
        refuse_unless_positive(self.ambient_time, "s", "unknowns.ambient_time")

    @property
    def deviations(self) -> FloatArray:
        """σ in the order heat, screw film, nut film, ambient, heats, (u,)."""
        named = [value for _, value in self.heats]
        return np.array([self.heat, self.screw_film, self.nut_film, self.ambient, *named])

    def kept(self, step: float) -> FloatArray:
        """Share exp(-step/T) of each that is left after a step [s], (u,)."""
        times = np.full(4 + len(self.heats), self.factor_time)
        times[3] = self.ambient_time
        return np.exp(-step / times)

    @property
    def names(self) -> tuple[str, ...]:
        """Their names, u of them."""
        return ("heat", "screw_film", "nut_film", "ambient", *(name for name, _ in self.heats))


def stationary_step(unknowns: Unknowns, step: float) -> FloatArray:
    """Variance that each walk gains in a step [s] so that its σ stays, (u,)."""
    return np.asarray(unknowns.deviations**2 * -np.expm1(2 * np.log(unknowns.kept(step))))
