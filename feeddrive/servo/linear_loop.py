"""The controller on the linearised plant, discrete and exact: open loops, closed loops, eigenvalues.

The controller's matrices are the derivatives of the one function that the simulation runs, away from its limits. The
plant with its current loop is sampled exactly (`servo.sampled_plant`).
A position loop slower than the velocity loop makes the closed loop periodic; it is composed over one period of the
slowest loop, T_s = n T, and is time-invariant there.

| symbol | meaning | unit |
|---|---|---|
| T, n, T_s | tick, ticks per position tick, their product | s, 1, s |

Valid for small deviations about a moving point, `velocity` and `position` of the table (see `plant.linear`): limits are
not reached, nothing reverses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS
from feeddrive.plant.analysis.steady import MOVING
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, FeedForward
from feeddrive.servo.cascade_function import cascade_controller, velocity_loop_of
from feeddrive.servo.margins import GROWTH
from feeddrive.servo.sampled_plant import Matrices, SampledController, sampled_plant
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    import control


def open_velocity_loop(
    plant: Plant, cascade: Cascade, velocity: float = MOVING, position: float = 0.0
) -> control.StateSpace:
    """Velocity loop cut at the torque command, the position loop open; its margins are those of the speed controller.

    Returns:
        Discrete state space of one input and one output, T.

    Raises:
        InputError: as `sampled_plant`.
    """
    alone = replace(velocity_loop_of(cascade), position_divider=1)
    machine, controller = sampled_plant(plant, alone, velocity, position), _Linear.of(cascade_controller(alone), 1)
    readings = controller.reading @ machine.c
    a = np.block([[machine.a, np.zeros((len(machine.a), len(controller.a)))], [controller.by_reading @ readings,
                  controller.a]])  # fmt: skip
    b = np.vstack([machine.b[:, :1], np.zeros((len(controller.a), 1))])
    c = -np.hstack([controller.torque_by_reading @ readings, controller.torque])
    import control

    return control.ss(a, b, c, 0, alone.sample_time, inputs=["torque"], outputs=["torque_command"])


def closed_velocity_loop(
    plant: Plant, cascade: Cascade, velocity: float = MOVING, position: float = 0.0
) -> control.StateSpace:
    """From the speed set-point [rad/s], before its filters, to the measured speed [rad/s], the position loop open."""
    alone = replace(velocity_loop_of(cascade), position_divider=1)
    loop = closed_loop(plant, alone, velocity, position)
    return loop["measured_speed", "speed_excitation"]


def open_position_loop(
    plant: Plant, cascade: Cascade, velocity: float = MOVING, position: float = 0.0
) -> control.StateSpace:
    """Position loop cut at its error, the velocity loop closed: L = T / (1 - T) of the loop without feed-forward.

    Returns:
        Discrete state space of one input and one output, T_s.
    """
    import control

    bare = replace(cascade, feed_forward=FeedForward(), balancing_time=0.0)
    followed = closed_loop(plant, bare, velocity, position)["measured_position", "position"]
    return control.feedback(followed, control.ss([], [], [], 1, bare.sample_time * bare.position_divider), sign=1)


def closed_loop(plant: Plant, cascade: Cascade, velocity: float = MOVING, position: float = 0.0) -> control.StateSpace:
    """The whole loop, sampled at the position ticks.

    Inputs: the references of the cascade and the cutting force, held over T_s. Outputs: the readings of the plant,
    the signals of the controller and `measured_position`, what the position loop reads [m].

    Returns:
        Discrete state space with named inputs and outputs, SI, T_s.

    Raises:
        InputError: as `sampled_plant`.
    """
    import control  # takes half a second, with the plotting that it brings

    whole = _closed(plant, cascade, velocity, position)
    period = cascade.sample_time * cascade.position_divider
    controller = cascade_controller(cascade)
    names = (*OUTPUTS, *controller.signals, "measured_position")
    inputs = [*controller.references, INPUTS[1]]
    return control.ss(whole.a, whole.b, whole.c, whole.d, period, inputs=inputs, outputs=list(names))


def _closed(plant: Plant, cascade: Cascade, velocity: float, position: float) -> Matrices:
    """Matrices of `closed_loop`."""
    controller = cascade_controller(cascade)
    machine = sampled_plant(plant, cascade, velocity, position)
    ticks = cascade.position_divider
    # the ticks between two of the position loop are all alike
    whole, step = (_tick(machine, _Linear.of(controller, tick)) for tick in (ticks, ticks + 1))
    for _ in range(ticks - 1):
        whole = Matrices(step.a @ whole.a, step.a @ whole.b + step.b, whole.c, whole.d)
    measured = _position_row(cascade, whole)
    c, d = (np.vstack([rows, extra]) for rows, extra in ((whole.c, measured[0]), (whole.d, measured[1])))
    return Matrices(whole.a, whole.b, c, d)


def worst_eigenvalue(
    plant: Plant, cascade: Cascade, velocity: float = MOVING, position: float = 0.0
) -> tuple[complex, float, float]:
    """The eigenvalue of largest magnitude of the closed loop over T_s, its growth [1/s] and its frequency [Hz].

    A growth above zero means an unstable loop. Without position loop the position is free and its eigenvalue is 1.
    The frequency is as the position ticks see it: one above half their rate appears folded about it.

    Raises:
        InputError: as `sampled_plant`, and gains so large that the matrices overflow.
    """
    a = _closed(plant, cascade, velocity, position).a
    if not np.isfinite(a).all():
        raise InputError("the gains are too large for numbers", "controller", "check their units")
    values = np.linalg.eigvals(a)
    worst = complex(values[np.argmax(np.abs(values))])
    period = cascade.sample_time * cascade.position_divider
    return worst, math.log(abs(worst)) / period, abs(math.atan2(worst.imag, worst.real)) / (2 * math.pi * period)


def refuse_unstable(plant: Plant, cascade: Cascade, where: str, position: float = 0.0) -> None:
    """Refuse a loop that is unstable, before it is run.

    Raises:
        InputError: growth of the worst eigenvalue above 0.1 1/s; names the eigenvalue.
    """
    value, growth, frequency = worst_eigenvalue(plant, cascade, position=position)
    if growth > GROWTH:
        what = f"the loop is unstable: eigenvalue {value:.4g} grows by {growth:.3g} 1/s, seen at {frequency:.0f} Hz"
        raise InputError(what, where, "lower position_gain or velocity_gain, or set allow_unstable = true")


def _position_row(cascade: Cascade, whole: Matrices) -> tuple[FloatArray, FloatArray]:
    angle = cascade.feedback == "motor"
    row = OUTPUTS.index("motor_angle" if angle else "table_position")
    factor = cascade.radius if angle else 1.0
    return factor * whole.c[row : row + 1], factor * whole.d[row : row + 1]


@dataclass(frozen=True)
class _Linear:
    """A controller's derivatives at one tick: with respect to state, reference and reading.

    `reading` picks what is measured from the readings of the plant.
    """

    reading: FloatArray
    a: FloatArray
    by_reference: FloatArray
    by_reading: FloatArray
    torque: FloatArray
    torque_by_reference: FloatArray
    torque_by_reading: FloatArray
    signal: FloatArray
    signal_by_reference: FloatArray
    signal_by_reading: FloatArray

    @classmethod
    @SYMBOLS.taken()
    def of(cls, controller: SampledController, tick: int) -> _Linear:
        function = controller.function
        arguments = [ca.SX.sym(function.name_in(i), function.size1_in(i)) for i in range(5)]
        results = function(*arguments)
        blocks = [ca.jacobian(result, argument) for result in results for argument in arguments[:3]]
        zeros = [np.zeros(function.size1_in(i)) for i in range(3)]
        values = ca.Function("linear", arguments, blocks)(*zeros, tick, controller.parameters)
        chosen = np.zeros((len(controller.measurements), len(OUTPUTS)))
        for row, name in enumerate(controller.measurements):
            chosen[row, OUTPUTS.index(name)] = 1.0
        return cls(chosen, *(np.array(value.full()) for value in values))


def _tick(machine: Matrices, controller: _Linear) -> Matrices:
    """Plant and controller over one tick; states (plant, controller), inputs (references, force)."""
    readings, size = controller.reading @ machine.c, len(controller.a)
    torque, force = machine.b[:, :1], machine.b[:, 1:]
    a = np.block([
        [machine.a + torque @ controller.torque_by_reading @ readings, torque @ controller.torque],
        [controller.by_reading @ readings, controller.a],
    ])  # fmt: skip
    b = np.block([
        [torque @ controller.torque_by_reference, force],
        [controller.by_reference, np.zeros((size, force.shape[1]))],
    ])  # fmt: skip
    c = np.block([
        [machine.c, np.zeros((len(machine.c), size))],
        [controller.signal_by_reading @ readings, controller.signal],
    ])  # fmt: skip
    d = np.zeros((len(c), b.shape[1]))
    d[len(machine.c) :, : controller.signal_by_reference.shape[1]] = controller.signal_by_reference
    return Matrices(a, b, c, d)
