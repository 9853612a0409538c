"""How large each effect is planted: the sizes at which the true plant lowers the validation error by a given share.

What an effect brings adds to the noise in squares. Its rms E(s) is simulated without noise at a few sizes s, and lies
on straight lines between them in logarithms; the noise N is that of a recording with nothing planted. The true plant
then lowers the rms from sqrt(N^2 + E^2) to N, on the channel that it lowers most. Both come from the package's
prediction by the declared plant alone (thermal: from the generator alone), so that sizes do not change with what the
package can name.
"""

from __future__ import annotations

import bisect
import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Self, cast

import numpy as np

from tests.generator.effects import Effect
from tests.generator.sizing import SHARES, sized
from tests.recovery.suite.heat import RUNS, HeatEffect, exact, noise_of
from tests.recovery.suite.motion import SECONDS, quiet_validation, twins_without_effects
from tests.recovery.suite.planting import MACHINES, PLACES, Planting, declared, is_warm_up, values_of, variants
from tests.recovery.suite.truth import Errors, declared_errors

NOISES = (1.0, 3.0)
"""Noise of the sensors over that declared."""

FILE = Path(__file__).with_name("sizes.json")

NEAR = math.log(2.5)
"""Sizes nearer than this are interpolated between."""

DECADES = (1e-3, 1e-2, 1e-1, 1.0)
"""Sizes that are simulated first in a warm-up, and interpolated between: what an effect of heat brings is nearly
proportional to it."""

NEVER_SMALL = {"presliding": (0.5, 1.0, 2.0)}
"""Sizes over the example's of an effect that does not vanish when it is made small: a stiff bristle is a sharp step at
standstill, where the declared plant has a smooth one, and that alone is many times the noise."""

SPAN = (1e-6, 100.0)
"""Sizes over the example's that are tried."""

SEED = 11
"""Of the noise by which errors without an effect are found; another seed changes them by one or two percent."""

Sizes = dict[str, dict[str, list[float | None]]]
"""Machine and effect -> noise -> size over the example's for each share; None where no size reaches it."""


@dataclass(frozen=True)
class Scale:
    """An example and how many times as large it is."""

    example: Planting
    factor: float = 1.0

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.example.name

    @property
    def effect(self) -> Planting:
        """The effect of that size; ValueError where it cannot be that large."""
        return self.example.scaled(self.factor)

    def scaled(self, factor: float) -> Scale:
        """`factor` times as large; ValueError where it cannot be."""
        made = Scale(self.example, self.factor * factor)
        _ = made.effect
        return made


@dataclass
class Curve:
    """What an effect brings over its size; it remembers the simulations."""

    brings: Callable[[Planting], Errors]
    example: Planting
    near: float
    known: dict[float, Errors] = field(default_factory=dict)

    def __call__(self, factor: float) -> Errors:
        """Channel to rms, between the nearest simulated sizes or simulated."""
        here = math.log(factor)
        sizes = sorted(self.known)
        at = bisect.bisect_left(sizes, here)
        around = sizes[max(at - 1, 0) : at + 1]
        if len(around) == 2 and around[1] - around[0] <= self.near:
            share = (here - around[0]) / (around[1] - around[0])
            low, high = (self.known[size] for size in around)
            return {name: low[name] ** (1 - share) * high[name] ** share for name in low}
        self.known[here] = self.brings(self.example.scaled(factor))
        return self.known[here]

    def begin(self, *factors: float) -> Self:
        """With these sizes simulated."""
        for factor in factors:
            self.known[math.log(factor)] = self.brings(self.example.scaled(factor))
        return self


def factors(curve: Curve, quiet: Errors) -> list[float | None]:
    """Size over the example's for each share, above noise `quiet`."""
    if curve.example.name in NEVER_SMALL:
        return [*NEVER_SMALL[curve.example.name]]
    found: list[float | None] = []

    def ratio(scale: Scale) -> float:
        brought = curve(scale.factor)
        return min(quiet[name] / math.hypot(quiet[name], brought[name]) for name in quiet)

    for share in SHARES:
        try:
            start = cast(Effect, Scale(curve.example))
            larger = cast(Scale, sized(start, share, cast(Callable[[Effect], float], ratio), 0.01, SPAN))
            found.append(float(f"{larger.factor:.4g}"))
        except (ValueError, FloatingPointError, ZeroDivisionError):
            found.append(None)
    return found


def key_of(machine: str, effect: Planting) -> str:
    """Where the sizes of an example stand: machine, effect, and what tells its examples apart."""
    values = values_of(effect)
    words = [str(values[key]) for key in PLACES if key in values]
    return "/".join([machine, effect.name, *(words or [str(variants(machine)[effect.name].index(effect))])])


def made(machine: str, only: str = "") -> Sizes:
    """The sizes of all effects of a machine, or of one."""
    noises = {f"{factor:g}": quiet_errors(machine, factor) for factor in NOISES}
    result: Sizes = {}
    for examples in variants(machine).values():
        for example in examples:
            if only in ("", example.name):
                curve = _curve(machine, example)
                result[key_of(machine, example)] = {noise: factors(curve, q) for noise, q in noises.items()}
    return result


def _curve(machine: str, example: Planting) -> Curve:
    if is_warm_up(machine):
        return Curve(_warm_up_brings(machine), example, math.log(10.1)).begin(*DECADES)
    return Curve(_motion_brings(machine), example, NEAR)


@cache
def quiet_errors(machine: str, noise: float) -> Errors:
    """Errors of the declared plant with nothing planted."""
    if is_warm_up(machine):
        series = exact(RUNS[machine][1], ())
        return {name: noise * noise_of(name) for name in _compared(series)}
    twin = twins_without_effects(machine, (), noise, (SEED, SEED + 1), SECONDS[machine])[1]
    return declared_errors(declared(machine), twin)


def _motion_brings(machine: str) -> Callable[[Planting], Errors]:
    own = declared_errors(declared(machine), quiet_validation(machine, ()))

    def brings(effect: Planting) -> Errors:
        errors = declared_errors(declared(machine), quiet_validation(machine, (cast(Effect, effect),)))
        return {name: math.sqrt(max(errors[name] ** 2 - own[name] ** 2, 1e-40)) for name in own}

    return brings


def _warm_up_brings(machine: str) -> Callable[[Planting], Errors]:
    schedule = RUNS[machine][1]
    quiet = exact(schedule, ())

    def brings(effect: Planting) -> Errors:
        series = exact(schedule, (cast(HeatEffect, effect),))
        return {
            name: max(float(np.sqrt(np.mean((series[name] - quiet[name]) ** 2))), 1e-20) for name in _compared(quiet)
        }

    return brings


def _compared(series: dict[str, np.ndarray]) -> list[str]:
    known = ("nut_temperature", "front_bearing_temperature")
    return [name for name in series if name in known or name.startswith("table_growth")]


@cache
def kept() -> Sizes:
    """The sizes of the file."""
    sizes: Sizes = json.loads(FILE.read_text(encoding="utf-8"))
    return sizes


def write(machines: tuple[str, ...] = MACHINES, only: str = "") -> None:
    """Make sizes anew and keep the others."""
    sizes: Sizes = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    for machine in machines:
        sizes |= made(machine, only)
    FILE.write_text(json.dumps(dict(sorted(sizes.items())), indent=1) + "\n", encoding="utf-8")


def planted_size(machine: str, example: Planting, noise: float, share: float) -> Planting | None:
    """The example of the size for a share; None where no size reaches it."""
    factor = kept()[key_of(machine, example)][f"{noise:g}"][SHARES.index(share)]
    return None if factor is None else example.scaled(factor)
