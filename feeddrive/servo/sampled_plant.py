"""The linearised plant with its current loop, sampled exactly: torque held over a tick, then a dead time and a lag.

| symbol | meaning | unit |
|---|---|---|
| T | tick | s |
| d = k T + f | dead time in whole ticks and the rest | s |
| tau | lag of the current loop | s |

Source: Åström, Wittenmark, Computer-Controlled Systems, 3rd ed., section 2.3 (sampling a system with a time delay).

What every sampled controller is to the engine and to the linear loop: one function of one tick.

The simulation runs the function, the linear loop differentiates it, the export prints it; nobody writes it twice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.base import TimingEffect
from feeddrive.errors import InputError
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade
from feeddrive.thermal.reduced.stepping import exact_propagator
from feeddrive.typing import FloatArray

MEASUREMENTS: dict[str, str] = {
    "motor_angle": "rad",
    "motor_speed": "rad/s",
    "table_position": "m",
    "table_velocity": "m/s",
}
"""What a controller may measure, with its SI unit: readings of the plant at the instant of the tick."""


@dataclass(frozen=True)
class SampledController:
    """A controller that is called once per tick and whose torque is held until the next.

    The tick counts from zero and is an integer: slower loops run where it is a multiple of their divider, so that no
    rate depends on rounded times.

    Attributes:
        function: (state (nc,), reference (nr,), measurement (nm,), tick (), parameters (np,)) ->
            (state after (nc,), torque command () [N m], signals (ns,)), CasADi SX.
        initial: state before tick 0, shape (nc,).
        parameters: values of the last argument, SI, shape (np,).
        sample_time: from one tick to the next [s].
        references: names of what is fed, in order.
        measurements: keys of `MEASUREMENTS`, in order.
        signals: names of what it shows of itself, in order.

    Raises:
        InputError: sizes that do not fit the function, an unknown measurement, a sample time that is not positive.
    """

    function: ca.Function
    initial: FloatArray
    parameters: FloatArray
    sample_time: float
    references: tuple[str, ...]
    measurements: tuple[str, ...]
    signals: tuple[str, ...]

    def __post_init__(self) -> None:
        name = self.function.name()
        given = (len(self.initial), len(self.references), len(self.measurements), 1, len(self.parameters))
        needed = tuple(self.function.size1_in(i) for i in range(5))
        if given != needed:
            raise InputError(f"sizes {given} of a controller whose function takes {needed}", name)
        shown = tuple(self.function.size1_out(i) for i in range(3))
        if shown != (given[0], 1, len(self.signals)):
            raise InputError(f"the function returns sizes {shown}", name, "return state after, torque and signals")
        unknown = [measurement for measurement in self.measurements if measurement not in MEASUREMENTS]
        if unknown:
            raise InputError(f"unknown measurement {unknown[0]!r}", name, f"known are {', '.join(MEASUREMENTS)}")
        if not self.sample_time > 0:
            raise InputError(f"sample time {self.sample_time:g} s is not positive", name)


SPLIT = 1e-9
"""Part of a tick below which the rest of a delay counts as none."""


def whole_and_rest(delay: float) -> tuple[int, float]:
    """Whole ticks of a delay, in ticks, and the rest as part of a tick."""
    late = math.floor(delay + SPLIT)
    return late, delay - late if delay - late > SPLIT else 0.0


@dataclass(frozen=True)
class Matrices:
    """x+ = A x + B u, y = C x + D u; shapes (n, n), (n, m), (p, n), (p, m)."""

    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray


def sampled_plant(plant: Plant, cascade: Cascade, velocity: float = MOVING, position: float = 0.0) -> Matrices:
    """Plant and current loop from the held torque and cutting force to the readings `plant.linear.OUTPUTS`.

    Linearised at a velocity and position [m/s, m]; a declared drive delay adds to the dead time of the cascade. The
    states per tick are those of the plant, the lagged torque, and torques under way. Errors as
    `plant.linear.state_space`.
    """
    a, b, c = _with_lag(linear_matrices(plant, velocity, position), cascade.current_lag)
    tick = cascade.sample_time
    delays = (effect.delay(effect.values) for effect in plant.effects if isinstance(effect, TimingEffect))
    dead = (cascade.dead_time + max(0.0, float(sum(delays)))) / tick
    late, rest = whole_and_rest(dead)
    whole, held = exact_propagator(-a, b, tick)
    if rest:
        _, newest = exact_propagator(-a, b[:, :1], (1 - rest) * tick)
        torques = [held[:, :1] - newest, newest]
    else:
        torques = [held[:, :1]]
    return _with_torques_under_way(whole, torques, held[:, 1:], c, late)


def _with_lag(matrices: tuple[FloatArray, ...], lag: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A, B, C with the torque through a first-order lag [s]."""
    a, b, c, _ = matrices
    if not lag:
        return a, b, c
    n = len(a)
    lagged = np.block([[a, b[:, :1]], [np.zeros((1, n)), np.array([[-1 / lag]])]])
    inputs = np.block([[np.zeros((n, 1)), b[:, 1:]], [np.array([[1 / lag]]), np.zeros((1, b.shape[1] - 1))]])
    return lagged, inputs, np.hstack([c, np.zeros((len(c), 1))])


def _with_torques_under_way(
    a: FloatArray, torques: list[FloatArray], force: FloatArray, c: FloatArray, late: int
) -> Matrices:
    """Matrices whose torque input acts `late` ticks later; `torques` holds the responses to older and newer torque."""
    waiting = late + len(torques) - 1
    n, m = len(a), force.shape[1]
    whole, inputs = np.zeros((n + waiting, n + waiting)), np.zeros((n + waiting, 1 + m))
    whole[:n, :n], inputs[:n, 1:] = a, force
    # torques waiting, oldest first, then the new one; the oldest act now
    columns = [whole[:n, n + i : n + i + 1] for i in range(waiting)] + [inputs[:n, :1]]
    for column, response in zip(columns, torques, strict=False):
        column += response
    for i in range(waiting - 1):
        whole[n + i, n + i + 1] = 1.0
    if waiting:
        inputs[n + waiting - 1, 0] = 1.0
    return Matrices(whole, inputs, np.hstack([c, np.zeros((len(c), waiting))]), np.zeros((len(c), 1 + m)))
