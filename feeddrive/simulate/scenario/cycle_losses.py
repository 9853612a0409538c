"""Where the power of a controlled run goes: friction of nut, bearings and guide, damping, loads, what is stored.

    ∫ T ω dt = Σ ∫ P_i dt + ΔE

| symbol | meaning | unit |
|---|---|---|
| T, ω | motor torque and speed | N m, rad/s |
| P_i | friction times speed at a port, less what its bristle stores; power of dampers, sources and load | W |
| E | kinetic energy, and that of the springs and of the bristles | J |

Forces and energies are those of the plant's own laws (`transmission_law`, `friction_law`): free play, a stiffness along
the stroke and travel errors count as they act. What is lost at the screw is the bearings' where it is their drag, and
the nut's otherwise. The motor's work is mean torque times angle from tick to tick, the losses are sums of trapezoids. A
travel error that grows with time (`thermal_growth`) does work on the nut that is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.base import Motion, Port
from feeddrive.effects.friction.shaft_drag import BearingDrag
from feeddrive.engine.timing import timing_of
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.friction_law import bristle_energy, friction_parts, resisting_force, source_force
from feeddrive.plant.motor_torque import acting_torques
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols, chain_symbols, parameter_symbols, parameter_values, per_structure
from feeddrive.plant.transmission_law import nut_force
from feeddrive.simulate.controlled.acting_torque import entered, mean_torque
from feeddrive.simulate.controlled.controlled import ControlledRun, TorqueLoop
from feeddrive.typing import Expression, FloatArray

POWERS = ("nut", "bearings", "guide", "motor", "damping", "sources")
"""What takes power, in the order of `power_function`."""


@dataclass(frozen=True)
class CycleLosses:
    """Works of a run from its first to its last tick [J]; those into parts are positive.

    Attributes:
        duration: [s].
        motor: mechanical work of the motor.
        nut, bearings, guide, motor_friction, damping: lost there.
        sources: done against weight, springs and other sources.
        load: done by the table on the cutting force.
        stored: gained by masses and springs.
        squared_torque: ∫ T² dt [(N m)² s].
    """

    duration: float
    motor: float
    nut: float
    bearings: float
    guide: float
    motor_friction: float
    damping: float
    sources: float
    load: float
    stored: float
    squared_torque: float

    @property
    def imbalance(self) -> float:
        """What is missing of the motor's work, over the sum of all losses [1]."""
        lost = self.nut + self.bearings + self.guide + self.motor_friction + self.damping
        missing = self.motor - lost - self.sources - self.load - self.stored
        return missing / max(lost, 1e-12)


def cycle_losses(plant: Plant, run: ControlledRun, loop: TorqueLoop, load: FloatArray | None = None) -> CycleLosses:
    """Losses of all ticks of a run, with a cutting force on the table along + motion, (n,) [N], if any."""
    function = power_function(plant)
    shown = function.map(len(run.time))(run.states.T, run.time[None, :], ca.repmat(_values(plant), 1, len(run.time)))
    table = np.array(shown.full())
    step = np.diff(run.time)
    works = {name: _integral(row, step) for name, row in zip(POWERS, table, strict=False)}
    pushed = 0.0 if load is None else -_integral(load * run.table_velocity, step)
    torque = motor_torque(plant, run, loop)
    work, squared = float(acting_torques(plant, torque) @ np.diff(run.motor_angle)), float(torque**2 @ step)
    return CycleLosses(
        float(np.sum(step)),
        work,
        works["nut"],
        works["bearings"],
        works["guide"],
        works["motor"],
        works["damping"],
        works["sources"],
        pushed,
        float(table[-1, -1] - table[-1, 0]),
        squared,
    )


def motor_torque(plant: Plant, run: ControlledRun, loop: TorqueLoop) -> FloatArray:
    """Motor torque, constant times current, averaged from tick to tick, (n - 1,) [N m].

    The command acts late, in parts of a tick, and the lag takes its share of every change. Before the first tick the
    first command is taken to have acted, as it has at rest.
    """
    tick = float(run.time[1] - run.time[0])
    timing = timing_of(plant, tick, loop.dead_time)
    asked = np.concatenate([np.full(timing.past, run.command[0]), run.command])
    return mean_torque(entered(asked, timing.parts, len(run.command) - 1), run.torque, loop.lag, tick)


def _values(plant: Plant) -> FloatArray:
    return np.array(parameter_values(plant))


def _integral(values: FloatArray, step: FloatArray) -> float:
    return float(np.sum(step * (values[1:] + values[:-1])) / 2)


@per_structure
def power_function(plant: Plant) -> ca.Function:
    """(state, time, values) -> powers in the order of `POWERS` [W], then E [J]."""
    symbols = parameter_symbols(plant)
    n, chain = len(plant.chain.coordinates), plant.chain
    state, time = ca.SX.sym("state", 2 * n + bristle_count(plant)), ca.SX.sym("time")
    q, rate = state[:n], state[n : 2 * n]
    z = state[2 * n :] if bristle_count(plant) else ca.SX.zeros(0, 1)
    p = chain_symbols(plant, symbols)
    ways = ((Port.MOTOR, chain.motor), (Port.SCREW, chain.screw), (Port.TABLE, chain.table))
    rows = {port: ca.horzcat(*row(p)) for port, row in ways}
    position = ca.mtimes(rows[Port.TABLE], q)
    energy = ca.mtimes([rate.T, ca.vertcat(*[ca.horzcat(*row) for row in chain.mass(p, position)]), rate]) / 2
    damping, pushed = ca.SX(0), ca.SX(0)
    if chain.elastic:
        nut = nut_force(plant, symbols, chain.nut(p), (rows[Port.SCREW], rows[Port.TABLE]), q, rate, time)
        energy, damping, pushed = energy + nut.energy, nut.damped, nut.force
        for spring in chain.springs(p, position)[:-1]:  # the nut's is the last
            row = ca.horzcat(*spring.row)
            energy += spring.stiffness * ca.mtimes(row, q) ** 2 / 2
            damping += spring.damping * ca.mtimes(row, rate) ** 2
    lost: dict[Port, Expression] = {}
    given, bearings = ca.SX(0), ca.SX(0)
    for port, row in rows.items():
        force = pushed if port in (Port.SCREW, Port.TABLE) else 0.0
        mass = chain.moving_mass(p) if port is Port.TABLE else 0.0
        motion = Motion(ca.mtimes(row, q), ca.mtimes(row, rate), time, force, p["lead"] / (2 * np.pi), mass)
        total, rates = resisting_force(plant, symbols, port, motion, z)
        sources, held = source_force(plant, symbols, port, motion), bristle_energy(plant, symbols, port, z)
        energy += held
        lost[port] = (total - sources) * motion.velocity
        if rates:
            lost[port] -= ca.mtimes(ca.jacobian(held, z), ca.vertcat(*rates))
        given += sources * motion.velocity
        if port is Port.SCREW:
            bearings += motion.velocity * _bearing_drag(plant, symbols, motion)
    shown = ca.vertcat(
        lost[Port.SCREW] - bearings, bearings, lost[Port.TABLE], lost[Port.MOTOR], damping, given, energy
    )
    return ca.Function("feeddrive_powers", [state, time, symbols.vector], [shown])


def _bearing_drag(plant: Plant, symbols: Symbols, motion: Motion) -> Expression:
    """What the bearings have of the friction at the screw [N m]."""
    parts = friction_parts(plant, symbols, Port.SCREW, motion)
    drags = [effect.label for effect in plant.effects if isinstance(effect, BearingDrag)]
    return sum((parts[label] for label in drags if label in parts), ca.SX(0))
