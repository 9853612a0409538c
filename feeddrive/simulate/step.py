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

from dataclasses import dataclass

import casadi as ca

from feeddrive.effects.base import DriveEffect
from feeddrive.plant.equations import (
    Forces,
    Symbols,
    bristle_count,
    chain_symbols,
    parameter_symbols,
)
from feeddrive.plant.motor_torque import acting_torque
from feeddrive.plant.plant import Plant
from feeddrive.simulate.algebra import cubic, newton_correction, part
from feeddrive.simulate.node_forces import Pull, node_forces
from feeddrive.simulate.propagators import NODES, RADAU
from feeddrive.simulate.step_constants import CONVERGED, Layout, constant_shapes, unflatten
from feeddrive.simulate.structure import without_left_out
from feeddrive.typing import Expression


@dataclass(frozen=True)
class StepModel:
    """The functions of a step; `fixed` are the constants of `step_constants`, `values` the plant's parameters.

    Attributes:
        layout: sizes.
        needed: per node, the rows of the state without node forces that the effects read; the held inputs, or angle,
            speed and acceleration of a driven motor, follow the states.
        watch: (memory, input, place, time, fixed, values) -> memory, its watched part set from the state. At a start,
            and where the fixed constants are those of another reference.
        begin: (memory, input, place, time, fixed) -> (what the coordinates at the nodes are without node forces,
            first guess of the unknowns).
        iterate: (memory, base, guess, time, fixed, values) -> (better guess, correction over its limit).
        tangent: (memory, base, guess, time, fixed, values, then how memory, base, fixed and values change) -> how
            the solved guess changes.
        finish: (memory, input, place, guess, fixed) -> (memory after, error over the tolerance).
    """

    layout: Layout
    needed: tuple[tuple[int, ...], tuple[int, ...]]
    watch: ca.Function
    begin: ca.Function
    iterate: ca.Function
    tangent: ca.Function
    finish: ca.Function


def driven_step(plant: Plant) -> StepModel:
    """The step of the load side with the motor angle prescribed as a cubic, of which the step may be a part.

    Input: theta and theta' at the cubic's start and end [rad, rad/s].
    """
    return _build(plant, driven=True, lagging=False)


def torque_step(plant: Plant, lagging: bool = False) -> StepModel:
    """The step of the whole plant with motor torque [N m] and cutting force [N] held over the step.

    A torque that lags is the one asked for, and what it makes the motor do is worked out here; one that does not lag is
    held as it acts (see `feeddrive.plant.motor_torque`).

    Args:
        plant: whose structure counts.
        lagging: whether the motor torque follows the held one with a time constant.
    """
    return _build(plant, driven=False, lagging=lagging)


def _build(plant: Plant, driven: bool, lagging: bool) -> StepModel:
    symbols = without_left_out(plant, parameter_symbols(plant))
    layout = _layout(plant, symbols, driven, lagging)
    return _Maker(plant, symbols, layout).model()


def _layout(plant: Plant, symbols: Symbols, driven: bool, lagging: bool) -> Layout:
    n = len(plant.chain.coordinates)
    q, rate, z = ca.SX.sym("q", n), ca.SX.sym("rate", n), ca.SX.sym("z", bristle_count(plant))
    torque = ca.SX.sym("torque")
    pull = Pull(torque, ca.SX.sym("force"), driven, _beyond(plant, symbols, torque) if lagging else None)
    forces = node_forces(plant, symbols, q, rate, z, ca.SX.sym("t"), ca.SX.sym("x"), pull).on_coordinates
    first = 1 if driven else 0
    forced = tuple(i for i in range(first, n) if not forces[i].is_zero())
    free = n - first
    return Layout(driven, lagging, free, 2 * free + lagging, forced, bristle_count(plant), 4 if driven else 2)


def _beyond(plant: Plant, symbols: Symbols, torque: Expression) -> Expression | None:
    """Acting less lagging motor torque [N m]; a torque that does not lag is held as it acts, and needs none."""
    return acting_torque(plant, symbols, torque) - torque if plant.effects_of(DriveEffect) else None


class _Maker:
    """Symbols shared by the functions of one step."""

    def __init__(self, plant: Plant, symbols: Symbols, layout: Layout) -> None:
        self.plant, self.symbols, self.layout = plant, symbols, layout
        self.count = len(layout.forced)
        self.memory = ca.SX.sym("memory", layout.memory)
        self.input = ca.SX.sym("input", layout.inputs)
        self.place, self.time = ca.SX.sym("place"), ca.SX.sym("time")
        self.guess = ca.SX.sym("guess", layout.unknowns)
        shapes = constant_shapes(layout)
        self.fixed = ca.SX.sym("fixed", sum(rows * columns for rows, columns in shapes))
        *self.blocks, span, self.scales, self.on_curvature, self.on_change = unflatten(self.fixed, shapes)
        self.step, self.share, self.reference = span[0], span[1], span[2]

    def model(self) -> StepModel:
        values = self.symbols.vector
        bases = [self._free_response(i) for i in range(2)]
        needed = self._needed_rows()
        base = ca.vertcat(*[bases[i][needed[i]] for i in range(2)])
        begin = [self.memory, self.input, self.place, self.time, self.fixed]
        known = ca.SX.sym("base", base.numel())
        spread = self._spread(known, needed)
        improved, change = self._corrected(spread)
        after, error = self._finished()
        return StepModel(
            self.layout,
            (tuple(needed[0]), tuple(needed[1])),
            self._watch(),
            ca.Function("feeddrive_begin", begin, [base, self._first_guess()]),
            ca.Function(
                "feeddrive_iterate", [self.memory, known, self.guess, self.time, self.fixed, values], [improved, change]
            ),
            self._tangent(known, spread),
            ca.Function(
                "feeddrive_finish",
                [self.memory, self.input, self.place, self.guess, self.fixed],
                [after, error],
            ),
        )

    def _watch(self) -> ca.Function:
        """Memory whose watched part belongs to its state, at rest in curvature and slope."""
        layout = self.layout
        motor = self._motor_at(self.place)
        q, rate = self._with_motor(self._state(), motor[0], motor[1])
        bristles = part(self.memory, layout.states, layout.bristles)
        held = motor if layout.driven else self.input
        found = self._forces(q, rate, bristles, self.time, self._pull(self._state(), held))
        kept = self.memory[: layout.states + layout.bristles]
        after = ca.vertcat(kept, self._watched(found), ca.SX.zeros(2 * layout.watched, 1))
        arguments = [self.memory, self.input, self.place, self.time, self.fixed, self.symbols.vector]
        return ca.Function("feeddrive_watch", arguments, [after])

    def _state(self) -> Expression:
        return part(self.memory, 0, self.layout.states)

    def _history(self, index: int) -> Expression:
        """Value, curvature over h^2 or slope of the watched quantities at the start."""
        at = self.layout.states + self.layout.bristles
        return part(self.memory, at + index * self.layout.watched, self.layout.watched)

    def _forces(self, q: Expression, rate: Expression, z: Expression, time: Expression, pull: Pull) -> Forces:
        return node_forces(self.plant, self.symbols, q, rate, z, time, self.reference, pull)

    def _pull(self, state: Expression, held: Expression) -> Pull:
        """From the state and the held inputs, or the motion of a driven motor."""
        if self.layout.driven:
            return Pull(held[2], ca.SX(0), True)
        if not self.layout.lagging:
            return Pull(held[0], held[1], False)
        torque = state[self.layout.states - 1]
        return Pull(torque, held[1], False, _beyond(self.plant, self.symbols, torque))

    def _motor_at(self, place: Expression) -> Expression:
        """Angle, speed and acceleration of a driven motor at a place of its cubic; zeros where it is not driven."""
        if not self.layout.driven:
            return ca.SX.zeros(3, 1)
        return ca.vertcat(*cubic(self.input, place, self.step / self.share))

    def _watched(self, found: Forces) -> Expression:
        on_coordinates = ca.reshape(found.on_coordinates[list(self.layout.forced)], self.count, 1)
        return on_coordinates if self.count else found.bristle_rates

    def _with_motor(self, state: Expression, theta: Expression, speed: Expression) -> tuple[Expression, Expression]:
        """q and q' of the whole chain."""
        half = self.layout.coordinates
        if not self.layout.driven:
            return state[:half], state[half : 2 * half]
        if not self.plant.chain.elastic:
            ratio = self.plant.chain.motor(chain_symbols(self.plant, self.symbols))[0]
            return theta / ratio, speed / ratio
        return ca.vertcat(theta, state[:half]), ca.vertcat(speed, state[half : 2 * half])

    def _step_input(self) -> Expression:
        """The input as this step sees it: of a cubic, the part from `place` on."""
        if not self.layout.driven:
            return self.input
        ends = [self._motor_at(self.place + end * self.share) for end in (0, 1)]
        return ca.vertcat(ends[0][:2], ends[1][:2])

    def _free_response(self, node: int) -> Expression:
        """State at a node without node forces; below it the held inputs, or the motion of a driven motor there."""
        exponential, from_input = self.blocks[4 * node], self.blocks[4 * node + 1]
        state = ca.mtimes(exponential, self._state()) + ca.mtimes(from_input, self._step_input())
        held = self._motor_at(self.place + NODES[node] * self.share) if self.layout.driven else self.input
        return ca.vertcat(state, held)

    @property
    def _rows(self) -> int:
        """Rows of a free response."""
        return self.layout.states + (3 if self.layout.driven else self.layout.inputs)

    def _needed_rows(self) -> list[list[int]]:
        """Rows of the free response, per node, that the effects read."""
        rows = self._rows
        states = [ca.SX.sym(f"at_{i}", rows) for i in range(2)]
        residual = self._residual(states)
        return [[k for k, used in enumerate(ca.which_depends(residual, s, 1, False)) if used] for s in states]

    def _spread(self, known: Expression, needed: list[list[int]]) -> list[Expression]:
        """Free responses with the known rows in place; the other rows are not read."""
        rows, at = self._rows, 0
        result = []
        for wanted in needed:
            response = ca.SX.zeros(rows, 1)
            for k in wanted:
                response[k] = known[at]
                at += 1
            result.append(response)
        return result

    def _node_state(self, node: int, response: Expression) -> Expression:
        first, second = self.blocks[4 * node + 2], self.blocks[4 * node + 3]
        m = self.count
        forced = ca.mtimes(first, part(self.guess, 0, m)) + ca.mtimes(second, part(self.guess, m, m))
        return response[: self.layout.states] + forced

    def _node_effects(self, responses: list[Expression]) -> list[Forces]:
        layout, found = self.layout, []
        for i, node in enumerate(NODES):
            state = self._node_state(i, responses[i])
            held = responses[i][layout.states :]
            q, rate = self._with_motor(state, held[0], held[1])
            pull = self._pull(state, held)
            found.append(self._forces(q, rate, self._node_bristles(i), self.time + node * self.step, pull))
        return found

    def _node_bristles(self, node: int) -> Expression:
        return part(self.guess, 2 * self.count + node * self.layout.bristles, self.layout.bristles)

    def _residual(self, responses: list[Expression]) -> Expression:
        layout, m = self.layout, self.count
        found = self._node_effects(responses)
        z0 = part(self.memory, layout.states, layout.bristles)
        residual = []
        for i, forces in enumerate(found):
            on_forced = ca.reshape(forces.on_coordinates[list(layout.forced)], m, 1)
            residual.append(part(self.guess, i * m, m) - on_forced)
        for i in range(2):
            moved = self.step * (RADAU[i, 0] * found[0].bristle_rates + RADAU[i, 1] * found[1].bristle_rates)
            residual.append(self._node_bristles(i) - z0 - moved)
        return ca.vertcat(*residual)

    def _corrected(self, responses: list[Expression]) -> tuple[Expression, Expression]:
        """A Newton correction, and the largest correction over its limit."""
        pairs = self._pairs()
        in_pairs = newton_correction(self._residual(responses)[pairs], self.guess[pairs])
        correction = ca.SX.zeros(len(pairs), 1)
        correction[pairs] = in_pairs
        improved = self.guess - correction
        count = 2 * (self.count or self.layout.bristles)
        ratios = []
        for k in range(count):
            limit = ca.fmax(CONVERGED * ca.fabs(improved[k]), self.scales[k % (count // 2)])
            ratios.append(ca.fabs(correction[k]) / limit)
        largest: Expression = ca.SX(0)
        for ratio in ratios:
            largest = ca.fmax(largest, ratio)
        return improved, largest

    def _tangent(self, known: Expression, responses: list[Expression]) -> ca.Function:
        """The implicit function theorem at the nodes: J d(guess) = -d(residual)."""
        given = [self.memory, known, self.fixed, self.symbols.vector]
        changes = [ca.SX.sym(f"change_{i}", symbol.numel()) for i, symbol in enumerate(given)]
        residual, pairs = self._residual(responses), self._pairs()
        changed = ca.jtimes(residual, ca.vertcat(*given), ca.vertcat(*changes))
        change = ca.SX.zeros(len(pairs), 1)
        change[pairs] = -newton_correction(residual[pairs], self.guess[pairs], changed[pairs])
        arguments = [self.memory, known, self.guess, self.time, self.fixed, self.symbols.vector, *changes]
        return ca.Function("feeddrive_tangent", arguments, [change])

    def _pairs(self) -> list[int]:
        """The unknowns, each quantity at both nodes: first the bristles, which their own equations hold best."""
        m, nz = self.count, self.layout.bristles
        bristles = [2 * m + node * nz + k for k in range(nz) for node in range(2)]
        return [*bristles, *(node * m + k for k in range(m) for node in range(2))]

    def _first_guess(self) -> Expression:
        """Node forces on the parabola of the last step, bristles where they are."""
        z0 = part(self.memory, self.layout.states, self.layout.bristles)
        if not self.count:
            return ca.vertcat(z0, z0)
        value, curvature, slope = (self._history(i) for i in range(3))
        times = [node * self.step for node in NODES]
        # a parabola that is 1 at the start of its step and 0 at both nodes has the second derivative 6
        return ca.vertcat(*[value + time * (slope + 3 * time * curvature) for time in times], z0, z0)

    def _finished(self) -> tuple[Expression, Expression]:
        m = self.count
        end = self._node_state(1, self._free_response(1))
        if m:
            first, second = part(self.guess, 0, m), part(self.guess, m, m)
        else:  # rates of the bristles, from what Radau made of them
            z0 = part(self.memory, self.layout.states, self.layout.bristles)
            one, two = self._node_bristles(0) - z0, self._node_bristles(1) - z0
            first, second = (1.5 * one + 0.5 * two) / self.step, (2.5 * two - 4.5 * one) / self.step
        missed = self._history(0) - 1.5 * first + 0.5 * second
        curvature = missed / self.step**2
        change = missed - self._history(1) * self.step**2
        error = ca.dot(self.on_curvature, ca.fabs(missed)) + ca.dot(self.on_change, ca.fabs(change))
        slope = (1.5 * (second - first) + 2 * missed) / self.step  # of the parabola, at its end
        return ca.vertcat(end, self._node_bristles(1), second, curvature, slope), error
