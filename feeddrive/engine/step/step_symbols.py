"""The symbols that the functions of one step share, and what the effects see of them.

| symbol | meaning |
|---|---|
| memory | states, bristles; value, curvature over h^2 and slope of the watched forces |
| guess | unknowns at the nodes: forces at both, then bristle deflections at both |
| fixed | constants of the step, see `feeddrive.engine.step.step_constants` |
| response | states at a node, then the held inputs, or angle, speed and acceleration of a driven motor |
"""

from __future__ import annotations

import casadi as ca

from feeddrive.effects.base import DriveEffect
from feeddrive.engine.step.linear_part import Layout
from feeddrive.engine.step.node_forces import Pull, node_forces
from feeddrive.engine.step.propagators import NODES, cubic, part
from feeddrive.engine.step.step_constants import constant_shapes, unflatten
from feeddrive.plant.equations import Forces
from feeddrive.plant.motor_torque import acting_torque
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols, chain_symbols
from feeddrive.typing import Expression


class StepSymbols:
    """Symbols shared by the functions of one step."""

    def __init__(self, plant: Plant, symbols: Symbols, layout: Layout) -> None:
        self.plant, self.symbols, self.layout = plant, symbols, layout
        self.forced = len(layout.forced)
        self.memory = ca.SX.sym("memory", layout.memory)
        self.input = ca.SX.sym("input", layout.inputs)
        self.place, self.time = ca.SX.sym("place"), ca.SX.sym("time")
        self.guess = ca.SX.sym("guess", layout.unknowns)
        shapes = constant_shapes(layout)
        self.fixed = ca.SX.sym("fixed", sum(rows * columns for rows, columns in shapes))
        *self.blocks, span, self.scales, self.on_curvature, self.on_change = unflatten(self.fixed, shapes)
        self.step, self.share, self.reference = span[0], span[1], span[2]
        self.values = symbols.vector

    @property
    def rows(self) -> int:
        """Rows of a response."""
        return self.layout.states + (3 if self.layout.driven else self.layout.inputs)

    @property
    def state(self) -> Expression:
        """States at the start."""
        return part(self.memory, 0, self.layout.states)

    @property
    def bristles(self) -> Expression:
        """Deflections at the start."""
        return part(self.memory, self.layout.states, self.layout.bristles)

    def history(self, index: int) -> Expression:
        """Value, curvature over h^2 or slope of the watched quantities at the start."""
        at = self.layout.states + self.layout.bristles
        return part(self.memory, at + index * self.layout.watched, self.layout.watched)

    def node_bristles(self, node: int) -> Expression:
        """Deflections at a node."""
        return part(self.guess, 2 * self.forced + node * self.layout.bristles, self.layout.bristles)

    def forces(self, response: Expression, z: Expression, time: Expression) -> Forces:
        """What the effects do where the states and inputs are those of a response."""
        state, held = response[: self.layout.states], response[self.layout.states :]
        q, rate = self._with_motor(state, held[0], held[1])
        return node_forces(self.plant, self.symbols, q, rate, z, time, self.reference, self._pull(state, held))

    def motor_at(self, place: Expression) -> Expression:
        """Angle, speed and acceleration of a driven motor at a place of its cubic; zeros where it is not driven."""
        if not self.layout.driven:
            return ca.SX.zeros(3, 1)
        return ca.vertcat(*cubic(self.input, place, self.step / self.share))

    def held_at(self, node: int) -> Expression:
        """The held inputs, or the motion of a driven motor at a node."""
        return self.motor_at(self.place + NODES[node] * self.share) if self.layout.driven else self.input

    def step_input(self) -> Expression:
        """The input as this step sees it: of a cubic, the part from `place` on."""
        if not self.layout.driven:
            return self.input
        ends = [self.motor_at(self.place + end * self.share) for end in (0, 1)]
        return ca.vertcat(ends[0][:2], ends[1][:2])

    def watched(self, found: Forces) -> Expression:
        """The quantities whose curvature tells the error."""
        return self.on_forced(found) if self.forced else found.bristle_rates

    def on_forced(self, found: Forces) -> Expression:
        """Forces on the coordinates that have any."""
        return ca.reshape(found.on_coordinates[list(self.layout.forced)], self.forced, 1)

    def _pull(self, state: Expression, held: Expression) -> Pull:
        """From the state and the held inputs, or the motion of a driven motor."""
        if self.layout.driven:
            return Pull(held[2], ca.SX(0), True)
        if not self.layout.lagging:
            return Pull(held[0], held[1], False)
        torque = state[self.layout.states - 1]
        return Pull(torque, held[1], False, torque_beyond(self.plant, self.symbols, torque))

    def _with_motor(self, state: Expression, theta: Expression, speed: Expression) -> tuple[Expression, Expression]:
        """q and q' of the whole chain."""
        half = self.layout.coordinates
        if not self.layout.driven:
            return state[:half], state[half : 2 * half]
        if not self.plant.chain.elastic:
            ratio = self.plant.chain.motor(chain_symbols(self.plant, self.symbols))[0]
            return theta / ratio, speed / ratio
        return ca.vertcat(theta, state[:half]), ca.vertcat(speed, state[half : 2 * half])


def torque_beyond(plant: Plant, symbols: Symbols, torque: Expression) -> Expression | None:
    """Acting less lagging motor torque [N m]; a torque that does not lag is held as it acts, and needs none."""
    return acting_torque(plant, symbols, torque) - torque if plant.effects_of(DriveEffect) else None
