"""A machine whose films and heats are not the declared ones: what a compensation has to cope with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from feeddrive.thermal.reduced.parametric_model import AMBIENT, COOLANT, Path
from feeddrive.thermal.rig import refuse_negative
from feeddrive.thermal.run.warm_up import Rows
from feeddrive.typing import FloatArray

SCREW_FILMS = (Path.SCREW_FILM, Path.FRONT_FILM, Path.REAR_FILM)
"""Air on the turning screw and on its seats."""
NUT_FILMS = (Path.NUT_FILM,)
"""Air on the nut."""


def deviating(rows: Rows, heat: float = 1.0, screw_film: float = 1.0, nut_film: float = 1.0) -> Rows:
    """Rows with all heats and the films multiplied; temperatures of the surroundings stay.

    Args:
        rows: as declared.
        heat: factor on every heat [1].
        screw_film: factor on the films of screw and seats [1].
        nut_film: factor on the film of the nut [1].

    Raises:
        InputError: a negative factor.
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
