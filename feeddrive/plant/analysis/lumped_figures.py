"""How near three inertias are to the machine that they stand for: figures of both, here and along the stroke."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.plant.analysis.modes import inertia_at_motor
from feeddrive.plant.analysis.stiffness_budget import static_stiffness, stiffness_budget
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.chain.resolution import resolved_modes
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

PLACES = 21
"""Table positions of the least squares along the stroke: a parabola needs three, the rest tells whether it is one."""


@dataclass(frozen=True)
class Compared:
    """A figure of the machine, and of the three inertias: name, unit, both values [unit]."""

    name: str
    unit: str
    machine: float
    lumped: float

    @property
    def error(self) -> float:
        """Relative error of the three inertias."""
        return self.lumped / self.machine - 1


def first_modes(plant: Plant, position: float) -> FloatArray:
    """First anti-resonance and first resonance [Hz], shape (2,)."""
    found = resolved_modes(plant, position, 1)
    return np.array([found.braked.frequencies[0], found.free.frequencies[1]])


def compared_figures(machine: Plant, model: Plant, position: float) -> tuple[Compared, ...]:
    there, here = resolved_modes(machine, position, 2), resolved_modes(model, position, 2)
    of, by = stiffness_budget(machine, position), stiffness_budget(model, position)
    rows = [
        Compared("static stiffness at the table, motor held", "N/m", of.total, by.total),
        Compared("torsional stiffness, felt at the table", "N/m", of.torsional, by.torsional),
        Compared("axial stiffness", "N/m", of.axial, by.axial),
        Compared(
            "inertia at the motor", "kg m^2", inertia_at_motor(machine, position), inertia_at_motor(model, position)
        ),
    ]
    names = ("first", "second")
    for i, name in enumerate(names):
        pair = there.braked.frequencies[i], here.braked.frequencies[i]
        rows.append(Compared(f"{name} anti-resonance, motor held", "Hz", *map(float, pair)))
    for i, name in enumerate(names):
        pair = there.free.frequencies[i + 1], here.free.frequencies[i + 1]
        rows.append(Compared(f"{name} resonance, motor free", "Hz", *map(float, pair)))
    for kind, a, b in (("held", there.braked, here.braked), ("free", there.free, here.free)):
        i = 0 if kind == "held" else 1
        if a.damping[i] > 0:
            rows.append(Compared(f"damping ratio of the first mode, motor {kind}", "1", float(a.damping[i]),
                                 float(b.damping[i])))  # fmt: skip
    return tuple(rows)


def compared_along(machine: Plant, model: Plant, along: StiffnessVsPosition | None) -> tuple[Compared, ...]:
    """Static stiffness and first modes at the ends of the stroke, and where the static stiffness is furthest off."""
    if along is None or machine.stroke is None:
        return ()
    values = model.chain.values

    def there(x: float) -> Plant:
        factor = float(along.stiffness_factor(ca.DM(x), along.values))
        return replace(
            model, mechanics=ThreeInertias({**values, "axial_stiffness": factor * values["axial_stiffness"]})
        )

    def stiffnesses(x: float) -> tuple[float, float]:
        return static_stiffness(machine, x), static_stiffness(there(x), x)

    rows = []
    for x in machine.stroke:
        at = f"table at {format_quantity(x, 'm')}"
        rows.append(Compared(f"static stiffness, {at}", "N/m", *stiffnesses(x)))
        names = "first anti-resonance, motor held", "first resonance, motor free"
        pairs = zip(names, first_modes(machine, x), first_modes(there(x), x), strict=True)
        rows += [Compared(f"{name}, {at}", "Hz", float(one), float(other)) for name, one, other in pairs]
    places = np.linspace(*machine.stroke, PLACES)
    worst = max(map(stiffnesses, map(float, places)), key=lambda pair: abs(pair[1] / pair[0] - 1))
    return (*rows, Compared("static stiffness, where along the stroke it is furthest off", "N/m", *worst))
