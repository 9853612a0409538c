"""What can be planted, of either kind of machine: examples, values, and the same effect in the package's own terms."""

from __future__ import annotations

import dataclasses
from functools import cache

from feeddrive.effects.base import Effect as PackageEffect
from feeddrive.effects.base import Port
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from tests.generator.axis import AXES
from tests.generator.effects import Effect
from tests.generator.examples import examples
from tests.recovery.suite.heat import RUNS, HeatEffect, heat_examples

Planting = Effect | HeatEffect
Values = dict[str, float | str]

MACHINES = (*AXES, *RUNS)
"""Two axes in motion and two warm-ups."""

PLACES = ("port", "where", "channel")
"""Keys that say where an effect acts."""


def is_warm_up(machine: str) -> bool:
    """Whether a machine is recorded in its temperatures."""
    return machine in RUNS


@cache
def declared(machine: str) -> Plant:
    """The declared plant of a machine."""
    if is_warm_up(machine):
        return read_plant(plants_folder() / "thermal_bench.toml")
    return read_plant(plants_folder() / f"{machine}_axis.toml")


@cache
def variants(machine: str) -> dict[str, tuple[Planting, ...]]:
    """Effect name to its examples for a machine, of the size that a service engineer would meet."""
    made: dict[str, tuple[Planting, ...]] = {}
    for effect in heat_examples(machine) if is_warm_up(machine) else examples(AXES[machine]):
        made[effect.name] = (*made.get(effect.name, ()), effect)
    return made


def values_of(effect: Planting) -> Values:
    """Its parameters by key (SI)."""
    return dict(effect.values) if isinstance(effect, HeatEffect) else dataclasses.asdict(effect)


def place_of(values: Values) -> str:
    """Where it acts; empty where only one place is possible."""
    return next((str(values[key]) for key in PLACES if key in values), "")


def in_the_package(machine: str, name: str, values: Values) -> PackageEffect | None:
    """The effect with the planted values in the package's own terms; None where the package cannot hold it."""
    kind = {**EFFECTS, **THERMAL_EFFECTS}.get(name)
    if kind is None:
        return None
    keys = {parameter.key for parameter in kind.parameters}
    numbers = {key: float(value) for key, value in values.items() if key in keys and not isinstance(value, str)}
    if name == "stiffness_vs_position":
        numbers |= dict(zip(("low", "high"), AXES[machine].travel, strict=True))
    place = place_of(values)
    try:
        if kind.place_key:
            return kind.of(None, place, **numbers)
        return kind.of(Port(place) if place else None, **numbers)
    except (InputError, ValueError):
        return None
