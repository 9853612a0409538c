"""Sizes of a step, and the error of a run that could not go on."""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.errors import InputError


class SimulationError(InputError):
    """A run that cannot be begun or could not go on; nothing of it is handed out."""


@dataclass(frozen=True)
class Layout:
    """Sizes of a step.

    Attributes:
        driven: whether the motor angle is prescribed; else the motor torque.
        lagging: whether the motor torque follows its command with a time constant.
        coordinates: free ones.
        states: of the linear part.
        forced: coordinates with effect forces that are not identically zero.
        bristles: deflections.
        inputs: held over a step, or the ends of a cubic.
    """

    driven: bool
    lagging: bool
    coordinates: int
    states: int
    forced: tuple[int, ...]
    bristles: int
    inputs: int

    @property
    def watched(self) -> int:
        """Quantities whose curvature tells the error: forces; rates of bristles where no force moves anything."""
        return len(self.forced) or self.bristles

    @property
    def memory(self) -> int:
        """Length of what is carried from step to step: states, bristles; value, curvature and slope of the watched."""
        return self.states + self.bristles + 3 * self.watched

    @property
    def unknowns(self) -> int:
        """Node forces and bristle deflections."""
        return 2 * (len(self.forced) + self.bristles)
