"""Where the power of a controlled run goes: friction of nut, bearings and guide, damping, loads, what is stored.

    ∫ T ω dt = Σ ∫ P_i dt + ΔE

| symbol | meaning | unit |
|---|---|---|
| T, ω | motor torque and speed | N m, rad/s |
| P_i | friction force times speed at a port; c s'² of a damper; force times speed of sources and of the load | W |
| E | kinetic energy, and that of the springs | J |

What is lost at the screw is shared between nut and bearings as their declared drags are. The motor's work is
mean torque times angle from tick to tick, the losses are sums of trapezoids. Bristles, and the travel
deviation in the nut's stretch, are left out of E: over a whole cycle they return what they took.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from feeddrive.effects.base import FrictionEffect, Motion, Port, SourceEffect
from feeddrive.effects.shaft_drag import BearingDrag
from feeddrive.plant.equations import bristle_count, chain_symbols, parameter_symbols, parameter_values
from feeddrive.plant.friction_law import resisting_force
from feeddrive.plant.motor_torque import acting_torques
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import per_structure
from feeddrive.plant.symbols import Symbols
from feeddrive.plant.transmission_law import nut_force
from feeddrive.simulate.controlled import ControlledRun, TorqueLoop
from feeddrive.simulate.timing import timing_of
from feeddrive.typing import Expression, FloatArray

_NAMES = ("nut", "bearings", "guide", "motor", "damping", "sources")


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
    """Losses of a run.

    Args:
        plant: that ran.
        run: all of its ticks.
        loop: of its torque.
        load: cutting force on the table along + motion at the ticks, (n,) [N]; none if None.
    """
    function = _power_function(plant)
    shown = function.map(len(run.time))(run.states.T, run.time[None, :], ca.repmat(_values(plant), 1, len(run.time)))
    table = np.array(shown.full())
    step = np.diff(run.time)
    works = {name: _integral(row, step) for name, row in zip(_NAMES, table, strict=False)}
    pushed = 0.0 if load is None else -_integral(load * run.table_velocity, step)
    torque = mean_torque(plant, run, loop)
    work, squared = float(acting_torques(plant, torque) @ np.diff(run.motor_angle)), float(torque**2 @ step)
    return CycleLosses(
        float(np.sum(step)), work, works["nut"], works["bearings"], works["guide"], works["motor"], works["damping"],
        works["sources"], pushed, float(table[-1, -1] - table[-1, 0]), squared,
    )  # fmt: skip


def mean_torque(plant: Plant, run: ControlledRun, loop: TorqueLoop) -> FloatArray:
    """Motor torque, constant times current, averaged from tick to tick, (n - 1,) [N m].

    The command acts late, in parts of a tick, and the lag takes its share of every change: lag ΔT = ∫ (u - T) dt.
    Before the first tick the first command is taken to have acted, as it has at rest.
    """
    tick = float(run.time[1] - run.time[0])
    timing = timing_of(plant, tick, loop.dead_time)
    asked = np.concatenate([np.full(timing.past, run.command[0]), run.command])
    count = len(run.command)
    acting = sum(part * asked[i : i + count] for i, part in enumerate(timing.parts)) + np.zeros(count)
    return np.asarray(acting[:-1] - loop.lag / tick * np.diff(run.torque))


def _values(plant: Plant) -> FloatArray:
    return np.array(parameter_values(plant))


def _integral(values: FloatArray, step: FloatArray) -> float:
    return float(np.sum(step * (values[1:] + values[:-1])) / 2)


@per_structure
def _power_function(plant: Plant) -> ca.Function:
    """(state, time, values) -> powers in the order of `_NAMES` [W], then E [J]."""
    symbols = parameter_symbols(plant)
    n = len(plant.chain.coordinates)
    state, time = ca.SX.sym("state", 2 * n + bristle_count(plant)), ca.SX.sym("time")
    q, rate = state[:n], state[n : 2 * n]
    z = state[2 * n :] if bristle_count(plant) else ca.SX.zeros(0, 1)
    p = chain_symbols(plant, symbols)
    chain = plant.chain
    ways = ((Port.MOTOR, chain.motor), (Port.SCREW, chain.screw), (Port.TABLE, chain.table))
    rows = {port: ca.horzcat(*row(p)) for port, row in ways}
    pushed: Expression = 0.0
    if plant.chain.elastic:
        pushed = nut_force(
            plant, symbols, plant.chain.nut(p), (rows[Port.SCREW], rows[Port.TABLE]), q, rate, time
        ).force
    lost: dict[Port, Expression] = {}
    given: Expression = 0.0
    for port, row in rows.items():
        force = pushed if port in (Port.SCREW, Port.TABLE) else 0.0
        motion = Motion(ca.mtimes(row, q), ca.mtimes(row, rate), time, force, p["lead"] / (2 * np.pi))
        total, _ = resisting_force(plant, symbols, port, motion, z)
        sources = _source_force(plant, symbols, port, motion)
        lost[port] = (total - sources) * motion.velocity
        given += sources * motion.velocity
        if port is Port.SCREW:
            bearings = lost[port] * _bearing_share(plant, symbols, motion)
    position = ca.mtimes(rows[Port.TABLE], q)
    springs = plant.chain.springs(p, position)
    stretches = [(spring, ca.mtimes(ca.horzcat(*spring.row), q), ca.mtimes(ca.horzcat(*spring.row), rate))
                 for spring in springs]  # fmt: skip
    damping = sum((spring.damping * speed**2 for spring, _, speed in stretches), ca.SX(0))
    mass = ca.vertcat(*[ca.horzcat(*row) for row in plant.chain.mass(p, position)])
    energy = ca.mtimes([rate.T, mass, rate]) / 2
    energy += sum((spring.stiffness * stretch**2 / 2 for spring, stretch, _ in stretches), ca.SX(0))
    shown = ca.vertcat(
        lost[Port.SCREW] - bearings, bearings, lost[Port.TABLE], lost[Port.MOTOR], damping, given, energy
    )
    return ca.Function("feeddrive_powers", [state, time, symbols.vector], [shown])


def _source_force(plant: Plant, symbols: Symbols, port: Port, motion: Motion) -> Expression:
    found = [e for e in plant.effects if isinstance(e, SourceEffect) and e.port == port]
    return sum((effect.force(motion, symbols.effects[effect.label]) for effect in found), ca.SX(0))


def _bearing_share(plant: Plant, symbols: Symbols, motion: Motion) -> Expression:
    """Share of the declared drag on the screw that is the bearings' [1]."""
    declared: Expression = ca.SX(1e-30)
    bearings: Expression = ca.SX(0)
    for effect in plant.effects:
        if isinstance(effect, FrictionEffect) and effect.port == Port.SCREW and effect.declared:
            values = symbols.effects[effect.label]
            drag = ca.fabs(effect.level(motion, values) * effect.shape(motion, values) + effect.viscous(motion, values))
            declared += drag
            if isinstance(effect, BearingDrag):
                bearings += drag
    return bearings / declared
