"""The machine while its motor turns at constant speed, row by row: what torque it takes and where its table is.

    0 = f(q, q', z, t, T; p),    motor angle = θ,    q' that of a motion without stretch

| symbol | meaning | unit |
|---|---|---|
| q, z | coordinates of the chain, bristle deflections: unknown | rad, m |
| T | motor torque: unknown | N m |
| θ, ω | angle and speed of the motor, given | rad, rad/s |

The equations are the plant's own (`plant.ode`), solved by Newton for all rows at once. Valid where speed has been
constant for longer than the chain rings; at rest friction holds any force up to its level, and nothing follows.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.base import BristleEffect, TransmissionEffect
from feeddrive.plant.analysis.ode import timed_ode
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import chain_symbols, parameter_symbols, parameter_values, per_structure
from feeddrive.simulate.scenario.cycle_losses import POWERS, power_function
from feeddrive.typing import FloatArray

_STEPS = 8
"""Newton steps: springs are straight on a flank, friction bends a little, a bristle a little more."""

_START_STRETCH = 1e-6
"""Beyond the free play [m]: inside it there is no slope."""

_MISSED = 1e-9
"""Motor angle [rad] by which a last Newton step may still move the solution: far below what encoders read."""


@dataclass(frozen=True, eq=False)
class UniformMotion:
    """What the plant does at k rows; not finite where no such motion was found.

    Attributes:
        torque: of the motor, without timing effects [N m].
        table_position: [m].
        powers: taken by the parts of `cycle_losses.POWERS` [W], to each (k,).
    """

    torque: FloatArray
    table_position: FloatArray
    powers: dict[str, FloatArray]


def uniform_motion(
    plant: Plant,
    angle: FloatArray,
    speed: FloatArray,
    time: FloatArray,
    values: FloatArray | None = None,
    with_powers: bool = True,
) -> UniformMotion:
    """Uniform motion at k rows.

    Args:
        plant: of an elastic structure; its timing effects are left out.
        angle, speed: of the motor, the speed never zero, (k,) [rad, rad/s].
        time: from the start, (k,) [s].
        values: of its parameters, a column each row, (p, k); None for its own everywhere.
        with_powers: whether powers are worked out.
    """
    count, n = len(angle), len(plant.chain.coordinates)
    p = np.tile(np.array(parameter_values(plant))[:, None], count) if values is None else values
    radius = plant.chain.motor_radius
    rigid = np.array([float(one) for one in plant.chain.rigid_motion(plant.chain_values())])
    given = np.vstack([angle, speed, time])
    unknown = np.vstack([np.outer(rigid, radius * angle), np.zeros((1 + bristle_count(plant), count))])
    play = float(sum(e.free_play(e.values) for e in plant.effects if isinstance(e, TransmissionEffect)))
    unknown[n - 1] -= np.sign(speed) * rigid[-1] * (0.5 * play + _START_STRETCH)
    for i, effect in enumerate(plant.effects_of(BristleEffect)):
        unknown[n + 1 + i] = np.sign(speed) / float(effect.values["stiffness"])  # type: ignore[arg-type]
    step = _newton(plant)
    least = _MISSED * np.abs(rigid[:, None]) * radius
    for _ in range(_STEPS):
        after = ca.DM(step(unknown, given, p)).full()
        missed = np.abs(after - unknown)[:n] - 1e-12 * np.abs(after[:n])
        unknown, settled = after, np.all(missed < least, axis=0)
        if settled.all():
            break
    bad = ~(settled & np.all(np.isfinite(unknown), axis=0))
    found, named = np.where(bad, np.nan, unknown), {}
    if with_powers:
        rates = np.outer(rigid, radius * speed)
        state = np.vstack([unknown[:n], rates, unknown[n + 1 :]])
        powers = ca.DM(power_function(plant)(state, time[None, :], p)).full()
        named = {name: np.where(bad, np.nan, row) for name, row in zip(POWERS, powers, strict=False)}
    return UniformMotion(found[n], found[n - 1], named)


@per_structure
def _newton(plant: Plant) -> ca.Function:
    """(unknown, (angle, speed, time), p) -> unknown after one step; unknown is q, T, z."""
    n, count, symbols = len(plant.chain.coordinates), bristle_count(plant), parameter_symbols(plant)
    unknown, given = ca.SX.sym("unknown", n + 1 + count), ca.SX.sym("given", 3)
    p = chain_symbols(plant, symbols)
    rigid = ca.vertcat(*[ca.SX(one) for one in plant.chain.rigid_motion(p)])
    motor = ca.horzcat(*plant.chain.motor(p))
    rate = rigid * given[1] / ca.mtimes(motor, rigid)
    x = ca.vertcat(unknown[:n], rate, unknown[n + 1 :] if count else ca.SX.zeros(0, 1))
    xdot, _ = timed_ode(plant)(given[2], x, ca.vertcat(unknown[n], 0), symbols.vector)
    residual = ca.vertcat(xdot[n : 2 * n], ca.mtimes(motor, unknown[:n]) - given[0], xdot[2 * n :] if count else [])
    slope = ca.densify(ca.jacobian(residual, unknown))
    return ca.Function("uniform", [unknown, given, symbols.vector], [unknown - ca.solve(slope, residual)])
