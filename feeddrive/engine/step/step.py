"""One step of a plant as CasADi functions: exact linear chain, effect forces on Radau nodes, an estimate of the error.

At the two Radau nodes the coordinates follow exactly from the state at the start, the input and the node forces; the
node forces follow from the coordinates through the effects. The small system for node forces and bristle deflections
is solved by Newton with the exact Jacobian, one correction per call, so that whoever steps decides when it ends.

    s_i = E_i s_0 + I_i w + sum_j W_ij f_j,     f_i = f(q_i, q_i', z_i, t_i),     z_i = z_0 + h sum_j a_ij z_j'

A force that is no straight line over the step is seen where the line through the nodes misses its value at the start:

    d = f(0) - (3 f_1 - f_2) / 2,     error = sum_k u_k |d_k| + v_k |d_k - (h / h_before)^2 d_k,before|

u weighs what a parabola does to the state, v the impulse of what is more than a parabola (see `step_constants`).
Source: Hairer and Wanner, Solving ODEs II, sections IV.5 (Radau IIA) and IV.8 (embedded estimates); own combination.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from feeddrive.effects.base import TransmissionEffect
from feeddrive.engine.step.linear_part import Layout
from feeddrive.engine.step.node_forces import Pull, node_forces
from feeddrive.engine.step.propagators import NODES, part
from feeddrive.engine.step.step_nodes import NodeEquations
from feeddrive.engine.step.step_symbols import StepSymbols, torque_beyond
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import Symbols, parameter_symbols, without_left_out
from feeddrive.typing import Expression


def driven_step(plant: Plant) -> StepModel:
    """The step of the load side with the motor angle prescribed as a cubic, of which the step may be a part.

    Input: theta and theta' at the cubic's start and end [rad, rad/s].
    """
    return _build(plant, driven=True, lagging=False)


def torque_step(plant: Plant, lagging: bool = False) -> StepModel:
    """The step of the whole plant with motor torque [N m] and cutting force [N] held over the step.

    A torque that lags, by a time constant, is the one asked for, and what it makes the motor do is worked out here; one
    that does not lag is held as it acts (see `feeddrive.plant.motor_torque`).
    """
    return _build(plant, driven=False, lagging=lagging)


def _build(plant: Plant, driven: bool, lagging: bool) -> StepModel:
    symbols = without_left_out(plant, parameter_symbols(plant))
    layout = _layout(plant, symbols, driven, lagging)
    return StepModel(StepSymbols(plant, symbols, layout))


def _layout(plant: Plant, symbols: Symbols, driven: bool, lagging: bool) -> Layout:
    n = len(plant.chain.coordinates)
    q, rate, z = ca.SX.sym("q", n), ca.SX.sym("rate", n), ca.SX.sym("z", bristle_count(plant))
    torque = ca.SX.sym("torque")
    pull = Pull(torque, ca.SX.sym("force"), driven, torque_beyond(plant, symbols, torque) if lagging else None)
    forces = node_forces(plant, symbols, q, rate, z, ca.SX.sym("t"), ca.SX.sym("x"), pull).on_coordinates
    first = 1 if driven else 0
    forced = tuple(i for i in range(first, n) if not forces[i].is_zero())
    free = n - first
    bristles, inputs = bristle_count(plant), 4 if driven else 2
    sharp = bristles > 0 or any(isinstance(one, TransmissionEffect) and one.has_play for one in plant.effects)
    return Layout(driven, lagging, free, 2 * free + lagging, forced, bristles, inputs, sharp)


class StepModel:
    """The functions of a step; `fixed` are the constants of `step_constants`, `values` the plant's parameters.

    Those that compiled runs do not ask for are made when they are.

    Attributes:
        layout: sizes.
        read: rows that the effects read of a node's states, behind which come the held inputs, or angle, speed and
            acceleration of a driven motor.
        watch: (memory, input, place, time, fixed, values) -> memory, its watched part set from the state. At a start,
            and where the fixed constants are those of another reference.
        iterate: (memory, base, guess, time, fixed, values) -> (better guess, correction over its limit).
    """

    def __init__(self, symbols: StepSymbols) -> None:
        self.symbols, self.layout = symbols, symbols.layout
        self.nodes = NodeEquations(symbols)
        self.read = tuple(self.nodes.read)
        self.watch = self._watch()
        given = [symbols.memory, self.nodes.base, symbols.guess, symbols.time, symbols.fixed, symbols.values]
        self.iterate = ca.Function("feeddrive_iterate", given, list(self.nodes.corrected()))

    @cached_property
    def begin(self) -> ca.Function:
        """(memory, input, place, time, fixed) -> (what the coordinates at the nodes are without node forces, first
        guess of the unknowns).
        """
        s = self.symbols
        return ca.Function("feeddrive_begin", [s.memory, s.input, s.place, s.time, s.fixed], self._begun(self.open))

    @cached_property
    def finish(self) -> ca.Function:
        """(memory, input, place, guess, fixed) -> (memory after, error over the tolerance)."""
        s = self.symbols
        finished = self._finished(self.close)
        return ca.Function("feeddrive_finish", [s.memory, s.input, s.place, s.guess, s.fixed], finished)

    @cached_property
    def open(self) -> ca.Function:
        """`begin` for who has the states without node forces: those read at the first node, then all at the end.

        (memory, input, place, fixed, these) -> results of begin.
        """
        return self._opened()

    @cached_property
    def close(self) -> ca.Function:
        """`finish` for the same: (memory, guess, fixed) -> (memory after but for the states, error)."""
        s = self.symbols
        return ca.Function("close", [s.memory, s.guess, s.fixed], self._closed())

    @cached_property
    def tangent(self) -> ca.Function:
        """(memory, base, guess, time, fixed, values, then how memory, base, fixed and values change) -> how the solved
        guess changes.
        """
        return self.nodes.tangent()

    def _watch(self) -> ca.Function:
        """Memory whose watched part belongs to its state, at rest in curvature and slope."""
        s, layout = self.symbols, self.layout
        held = s.motor_at(s.place) if layout.driven else s.input
        found = s.forces(ca.vertcat(s.state, held), s.bristles, s.time)
        kept = s.memory[: layout.states + layout.bristles]
        after = ca.vertcat(kept, s.watched(found), ca.SX.zeros(2 * layout.watched, 1))
        return ca.Function("feeddrive_watch", [s.memory, s.input, s.place, s.time, s.fixed, s.values], [after])

    def _free_states(self, node: int) -> Expression:
        """States at a node without node forces."""
        s = self.symbols
        return ca.mtimes(s.blocks[4 * node], s.state) + ca.mtimes(s.blocks[4 * node + 1], s.step_input())

    def _begun(self, opened: ca.Function) -> list[Expression]:
        s = self.symbols
        read = [row for row in self.nodes.read if row < self.layout.states]
        free = ca.vertcat(self._free_states(0)[read], self._free_states(1))
        return opened.call([s.memory, s.input, s.place, s.fixed, free])

    def _opened(self) -> ca.Function:
        s, read = self.symbols, self.nodes.read
        early = [row for row in read if row < self.layout.states]
        free = ca.SX.sym("free", len(early) + self.layout.states)
        first = ca.SX(self.layout.states, 1)
        first[early] = free[: len(early)]
        responses = [ca.vertcat(states, s.held_at(i)) for i, states in enumerate((first, free[len(early) :]))]
        base = ca.vertcat(*[response[read] for response in responses])
        return ca.Function("open", [s.memory, s.input, s.place, s.fixed, free], [base, self._first_guess()])

    def _first_guess(self) -> Expression:
        """Node forces on the parabola of the last step, bristles where they are."""
        s, z0 = self.symbols, self.symbols.bristles
        if not s.forced:
            return ca.vertcat(z0, z0)
        value, curvature, slope = (s.history(i) for i in range(3))
        times = [node * s.step for node in NODES]
        # a parabola that is 1 at the start of its step and 0 at both nodes has the second derivative 6
        return ca.vertcat(*[value + time * (slope + 3 * time * curvature) for time in times], z0, z0)

    def _finished(self, closed: ca.Function) -> list[Expression]:
        s, m = self.symbols, self.symbols.forced
        end = self._free_states(1) + (
            ca.mtimes(s.blocks[6], part(s.guess, 0, m)) + ca.mtimes(s.blocks[7], part(s.guess, m, m))
        )
        rest, error = closed(s.memory, s.guess, s.fixed)
        return [ca.vertcat(end, rest), error]

    def _closed(self) -> list[Expression]:
        s, m = self.symbols, self.symbols.forced
        if m:
            first, second = part(s.guess, 0, m), part(s.guess, m, m)
        else:  # rates of the bristles, from what Radau made of them
            one, two = s.node_bristles(0) - s.bristles, s.node_bristles(1) - s.bristles
            first, second = (1.5 * one + 0.5 * two) / s.step, (2.5 * two - 4.5 * one) / s.step
        missed = s.history(0) - 1.5 * first + 0.5 * second
        curvature = missed / s.step**2
        change = missed - s.history(1) * s.step**2
        error = ca.dot(s.on_curvature, ca.fabs(missed)) + ca.dot(s.on_change, ca.fabs(change))
        slope = (1.5 * (second - first) + 2 * missed) / s.step  # of the parabola, at its end
        return [ca.vertcat(s.node_bristles(1), second, curvature, slope), error]
