"""Names, units and values of what a plant's equations take and give, row by row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from feeddrive.plant.analysis.linear import INPUTS, OUTPUTS, ode_parameters, state_names
from feeddrive.plant.plant import Plant

INPUT_UNITS = ("N m", "N")
OUTPUT_UNITS = ("rad", "rad/s", "m", "m/s")
_INPUT_COMMENTS = ("torque of the motor on its rotor", "force on the table, along + motion")
_OUTPUT_COMMENTS = ("of the rotor", "of the rotor", "of the table", "of the table")
_STATE_UNITS = {"angle": "rad", "speed": "rad/s", "position": "m", "velocity": "m/s"}


@dataclass(frozen=True)
class Quantity:
    """One row: a state, an input, an output or a parameter.

    Attributes:
        name: of the row.
        unit: SI unit; "1" for none.
        value: at the start, or of the parameter [unit].
        comment: remarks: what it is, or the source of a value.
        of_chain: whether it is a parameter of inertias and springs, and not of an effect.
    """

    name: str
    unit: str
    value: float = 0.0
    comment: str = ""
    of_chain: bool = False


def states(plant: Plant, values: Sequence[float]) -> tuple[Quantity, ...]:
    """States with the values [SI] given; bristle deflections are in m."""
    named = zip(state_names(plant), values, strict=True)
    return tuple(Quantity(name, _STATE_UNITS.get(name.rsplit("_", 1)[-1], "m"), float(value)) for name, value in named)


def inputs(torque: float) -> tuple[Quantity, ...]:
    """Inputs; the motor torque has the value given [N m]."""
    rows = zip(INPUTS, INPUT_UNITS, (torque, 0.0), _INPUT_COMMENTS, strict=True)
    return tuple(Quantity(*row) for row in rows)


def outputs() -> tuple[Quantity, ...]:
    """Outputs."""
    rows = zip(OUTPUTS, OUTPUT_UNITS, _OUTPUT_COMMENTS, strict=True)
    return tuple(Quantity(name, unit, comment=comment) for name, unit, comment in rows)


def parameters(plant: Plant) -> tuple[Quantity, ...]:
    """Parameters with values and sources, in the order of `ode_parameters`."""
    units = {value.key: value.unit for value in plant.chain.known_values}
    units |= {f"{effect.label}.{p.key}": p.unit for effect in plant.motion_effects for p in effect.parameters}
    rows = []
    for name, value in ode_parameters(plant).items():
        key = name.partition("[")[0]
        rows.append(Quantity(name, units[key], value, plant.origins.get(key, ""), key in plant.chain.values))
    return tuple(rows)
