"""The state of the equations of motion and the decorator that compiles them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


class State(NamedTuple):
    """What the equations of motion carry along, SI units; a new field at the end leaves the others where they are.

    angle, speed: motor [rad], [rad/s]. screw_angle, screw_speed. position, velocity: table [m], [m/s].
    bristle: deflection of the guide's bristle [m]. mass_deflection: of the further mass against the table [m].
    mass_velocity: of the further mass, absolute [m/s]. time: since the first sample [s].
    """

    angle: float
    speed: float
    screw_angle: float
    screw_speed: float
    position: float
    velocity: float
    bristle: float = 0.0
    mass_deflection: float = 0.0
    mass_velocity: float = 0.0
    time: float = 0.0


WIDTH = len(State._fields)


def _cache() -> Path:
    """Return the folder of compiled code: one for each state of the generator's sources.

    Numba looks for changes in the file of a function alone, not in those of the functions that it calls.
    """
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return Path(__file__).parents[2] / "build" / "generator" / digest.hexdigest()[:16]


setattr(numba.config, "CACHE_DIR", str(_cache()))  # noqa: B010  numba declares none of its settings


def compiled(function: Function) -> Function:
    """Return `function` compiled by numba and kept on disk, with its own type."""
    return cast(Function, numba.njit(cache=True)(function))
