"""What a warm-up run gives: cycle by cycle what the drive was, and where its energy went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.simulate.warm.warm_up_cycle import Cycle
from feeddrive.thermal.machine_heat import Heat
from feeddrive.typing import FloatArray

CLOSES = 2e-4
"""Share of the work in to which the energy of a run closes: sums over the ticks, and what a cycle's start remembers."""


@dataclass(frozen=True)
class WarmUpPoint:
    """One macro step's end: time [s], temperatures of parts and bodies [degC], the cycle as it was then."""

    time: float
    temperatures: Mapping[str, float]
    cycle: Cycle


@dataclass(frozen=True)
class RunEnergy:
    """Energies of a run [J].

    Attributes:
        motor: mechanical work of the motor.
        winding: heat of its winding, 0 where that is not counted; electrical in = motor + winding.
        into_network: heats that the thermal model took.
        to_bed: heat that the model does not follow: guide, dampers, winding without a body for it.
        work_out: on cutting forces and sources.
        kept_by_drive: in masses and springs.
        to_surroundings: from the thermal model to the air.
        stored: heat in screw, nut and bodies.
    """

    motor: float
    winding: float
    into_network: float
    to_bed: float
    work_out: float
    kept_by_drive: float
    to_surroundings: float = 0.0
    stored: float = 0.0

    @staticmethod
    def zero() -> RunEnergy:
        """Before the first step."""
        return RunEnergy(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def plus(self, first: Cycle, last: Cycle, length: float) -> RunEnergy:
        """After a macro step of `length` [s] under the mean of two cycles."""
        powers = [(getattr(first.power, name) + getattr(last.power, name)) / 2 * length for name in _SUMMED]
        return replace(self, **{name: getattr(self, name) + more for name, more in zip(_SUMMED, powers, strict=True)})

    def closed(self, to_surroundings: float, stored: float) -> RunEnergy:
        """With what the thermal model says at the end."""
        return replace(self, to_surroundings=to_surroundings, stored=stored)

    @property
    def electrical(self) -> float:
        """Work in [J]."""
        return self.motor + self.winding

    @property
    def imbalance(self) -> float:
        """Work in less everything that became of it, over the work in [1]."""
        found = self.to_surroundings + self.stored + self.to_bed + self.work_out + self.kept_by_drive
        return (self.electrical - found) / self.electrical


_SUMMED = ("motor", "winding", "into_network", "to_bed", "work_out", "kept_by_drive")


@dataclass(frozen=True, eq=False)
class WarmUpRun:
    """A finished run.

    Attributes:
        points: ends of the macro steps, the first at time 0.
        energy: of the run.
        cycle_duration: [s].
        cycles: servo cycles that were simulated.
        refused: macro steps that were tried and found too long.
        stops: positions at which the table comes to rest in a cycle [m], in their order.
        thermal: heat of the machine.
        name: of the scenario.
    """

    points: tuple[WarmUpPoint, ...]
    energy: RunEnergy
    cycle_duration: float
    cycles: int
    refused: int
    stops: tuple[float, ...]
    thermal: Heat
    name: str

    @property
    def time(self) -> FloatArray:
        """(k,) [s]."""
        return np.array([point.time for point in self.points])

    def temperature(self, name: str) -> FloatArray:
        """Temperature of a part or body at the macro steps, (k,) [degC]."""
        return np.array([point.temperatures[name] for point in self.points])

    @property
    def stop_errors(self) -> FloatArray:
        """Table position less its target at the stops, (k, stops) [m]."""
        return np.array([point.cycle.stop_errors for point in self.points])

    def figure_of_cycle(self, name: str) -> FloatArray:
        """A number of `Cycle`, such as "nut_torque", (k,)."""
        return np.array([getattr(point.cycle, name) for point in self.points])
