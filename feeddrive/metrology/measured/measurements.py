"""What was measured in a test of ISO 230, whatever it was read from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from feeddrive.errors import InputError
from feeddrive.metrology.axis_heating import AxisHeating, axis_heating
from feeddrive.metrology.circular import CircularPath, circular_path, least_squares_circle, whole_turns
from feeddrive.metrology.positioning import OneDirection, Positioning, one_direction, positioning
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class LinearTest:
    """Deviations of a positioning test (-2), actual minus target.

    Attributes:
        target: ascending, (m,) [m].
        up, down: of every approach along + and along -, (m, n) [m]; None where there is none.
    """

    target: FloatArray
    up: FloatArray | None
    down: FloatArray | None

    @property
    def both(self) -> Positioning | None:
        """The figures of both directions; None for a unidirectional test."""
        if self.up is None or self.down is None:
            return None
        return positioning(self.target, self.up, self.down)

    @property
    def sides(self) -> dict[str, OneDirection]:
        """The figures of each direction that was approached from: "up" along +, "down" along -."""
        given = {"up": self.up, "down": self.down}
        return {name: one_direction(part) for name, part in given.items() if part is not None}

    def less(self, up: FloatArray, down: FloatArray) -> LinearTest:
        """The test with deviations, (m,) [m] along + and along -, taken off."""
        return LinearTest(
            self.target,
            None if self.up is None else self.up - up[:, None],
            None if self.down is None else self.down - down[:, None],
        )


@dataclass(frozen=True, eq=False)
class DriftTest:
    """Error over time at targets while the axis warms itself (-3).

    Attributes:
        times: since the first reading, (k,) [s].
        error: since then, (k, p) [m].
        positions: ascending, (p,) [m].
        stop: when the axis stops [s].
        temperatures: read beside, name to (k,) [degC].
    """

    times: FloatArray
    error: FloatArray
    positions: FloatArray
    stop: float
    temperatures: Mapping[str, FloatArray] = field(default_factory=dict)

    @property
    def heating(self) -> AxisHeating:
        """The figures.

        Raises:
            InputError: less than an hour.
        """
        return axis_heating(self.times, self.error, self.positions, self.stop)


@dataclass(frozen=True, eq=False)
class CircleTest:
    """Points along circles (-4).

    Attributes:
        paths: x and y in their order in time, (n,) [m] each; one path, or one in each direction.
        nominal: radius [m]; that of the least-squares circle where it is not known.
    """

    paths: tuple[tuple[FloatArray, FloatArray], ...]
    nominal: float | None

    @property
    def circles(self) -> tuple[CircularPath, ...]:
        """The figures of each path.

        Raises:
            InputError: less than a turn.
        """
        found = [circular_path(x, y, self.nominal or 0.0) for x, y in self.paths]
        if self.nominal is None:
            mean = float(np.mean([one.radius for one in found]))
            found = [circular_path(x, y, mean) for x, y in self.paths]
        return tuple(found)

    @property
    def bidirectional(self) -> float | None:
        """G(b), the range of the radius over both directions about their common centre [m]; None for one direction."""
        if {one.direction for one in self.circles} != {1, -1}:
            return None
        turns = [whole_turns(x, y) for x, y in self.paths]
        x, y = (np.concatenate([path[i] for path in turns]) for i in (0, 1))
        centre, _ = least_squares_circle(x, y)
        return float(np.ptp(np.hypot(x - centre[0], y - centre[1])))


def refuse_radius(radius: float | None) -> None:
    """Refuse a nominal radius that is none.

    Raises:
        InputError: not above zero.
    """
    if radius is not None and not radius > 0:
        raise InputError(f"a radius of {radius:g} m", "radius", "give one above zero")
