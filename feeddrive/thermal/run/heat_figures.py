"""The heat of a machine at a glance: films, contact and heats against speed, settled rises, time constants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path

SHARES = (0.0, 0.25, 0.5, 1.0)
"""Speeds of the table over the highest declared one."""

TIME_CONSTANTS = 3
"""Slowest ones that are shown."""


@dataclass(frozen=True)
class HeatRow:
    """The heat of a machine at one constant speed, effects not counted.

    Attributes:
        speed: of the screw [rad/s].
        screw_film, nut_film, contact: conductances per area [W/(m² K)].
        nut_heat, front_heat, rear_heat: friction heat [W].
        nut_rise, end_rise: settled rise of the nut and of the front seat [K].
        growth: settled growth at the last growth position [m].
        time_constants: the slowest, (3,) [s].
    """

    speed: float
    screw_film: float
    nut_film: float
    contact: float
    nut_heat: float
    front_heat: float
    rear_heat: float
    nut_rise: float
    end_rise: float
    growth: float
    time_constants: tuple[float, ...]


def heat_rows(heat: Heat) -> tuple[HeatRow, ...]:
    """The plant at rest and at a quarter, half and all of its highest speed."""
    model = heat.full_model()
    return tuple(_row(heat, model, share * heat.highest_speed) for share in SHARES)


def _row(heat: Heat, model: HeatModel, speed: float) -> HeatRow:
    conductances = heat.at_speed(speed)
    system = model.at(conductances)
    heats = {name: float(values[0]) for name, values in heat.heats(np.array([speed])).items()}
    settled = system.steady(np.array([heats.get(name, 0.0) for name in system.input_names]))
    outputs = dict(zip(system.output_names, system.outputs(settled), strict=True))
    slowest = tuple(float(1 / rate) for rate in sorted(abs(system.poles(TIME_CONSTANTS))))
    last = [name for name in system.output_names if name.startswith("growth_") and name != "growth_end"]
    return HeatRow(
        speed, conductances[Path.SCREW_FILM], conductances[Path.NUT_FILM], conductances[Path.CONTACT],
        heats["nut"], heats["front"], heats["rear"], float(outputs["nut"]), float(outputs["front"]),
        float(outputs[last[-1] if last else "growth_end"]), slowest,
    )  # fmt: skip
