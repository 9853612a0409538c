"""Controllers of any design around an axis: cascades by their gains, state feedback, gains that follow the table."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.errors import InputError
from feeddrive.export.point import export_point
from feeddrive.interface.plants import plant_of
from feeddrive.interface.quantities import Quantity, quantities, si
from feeddrive.interface.servo import Servo, cascade_for, feedback_of
from feeddrive.plant.analysis.ode import INPUTS, OUTPUTS
from feeddrive.plant.plant import Plant
from feeddrive.servo import state_feedback as observed
from feeddrive.servo.cascade import Cascade, FeedForward
from feeddrive.servo.cascade_function import cascade_controller, velocity_loop_of
from feeddrive.servo.linear_loop import open_position_loop, open_velocity_loop
from feeddrive.servo.margins import Margins, margins
from feeddrive.servo.mechanics_response import Case
from feeddrive.servo.sampled_plant import Matrices, SampledController, sampled_plant
from feeddrive.servo.scheduled import scheduled
from feeddrive.simulate.controlled.controlled_machine import TorqueLoop
from feeddrive.tuning.bare_drive import bare_drive
from feeddrive.tuning.position_loop import position_gain

if TYPE_CHECKING:
    import control

    from feeddrive.interface.axis import Axis
    from feeddrive.typing import FloatArray

UNDER_THE_LIMIT = 0.995
"""Share of the largest K_v that a schedule takes: between its positions the margins bend a little."""


@dataclass(frozen=True, repr=False, eq=False)
class Controller:
    """A controller as it runs tick by tick around an axis: `move` takes it.

    Attributes:
        plant: that it is for.
        sampled: the function of one tick, with its references, measurements and signals.
        torque_loop: lag and dead time between its torque command and the motor torque.
        loops: name of an open loop, "velocity", "position" or "torque", to what gives it at a velocity [m/s] and a
            position [m] of the table.
        known_place: what the state of the controller gains per metre at which the table stands at the start.
    """

    plant: Plant
    sampled: SampledController
    torque_loop: TorqueLoop
    loops: dict[str, Callable[[float, float], control.StateSpace]]
    known_place: FloatArray | float = 0.0

    def starting_at(self, position: float) -> SampledController:
        """The function of one tick, its state that of a table that stands at a position [m]."""
        return replace(self.sampled, initial=self.sampled.initial + position * np.asarray(self.known_place))

    def __repr__(self) -> str:
        """Rate, references, loops."""
        rate, fed = 1 / self.sampled.sample_time, ", ".join(self.sampled.references)
        return f"Controller for {self.plant.name!r} at {rate:g} Hz; fed with {fed}; loops {', '.join(self.loops)}"

    def margins(self, loop: str = "", at: str = "") -> Margins:
        """Gain and phase margin, sensitivity peak, and whether the closed loop is stable.

        Args:
            loop: a key of `loops`; the first if left out.
            at: operating point, "x=200 mm, v=3 m/min".

        Raises:
            InputError: no such loop, or a point off the stroke.
        """
        name = loop or next(iter(self.loops))
        if name not in self.loops:
            raise InputError(f'no loop "{loop}"', "margins", f"it has {', '.join(self.loops)}")
        point = export_point(self.plant, at, "at")
        return margins(self.loops[name](point.linearised_at, point.position))


def cascade(
    axis: Axis | str | Path,
    servo: Servo | str | None = None,
    *,
    velocity_gain: Quantity | None = None,
    reset_time: Quantity | None = None,
    position_gain: Quantity | None = None,
    velocity_rate: Quantity = "8 kHz",
    position_rate: Quantity = "2 kHz",
    current_bandwidth: Quantity = "1 kHz",
    dead_time: Quantity = "125 us",
    feedback: str | None = None,
    feed_forward: bool = True,
) -> Controller:
    """The usual cascade: gains as given, or those of a tuned servo or a controller file, changed where given.

    Args:
        axis: the machine.
        servo: of `tune`, or a controller or scenario file; then its rates, filters and feed-forward hold. Without it
            the cascade has neither filters nor feed-forward.
        velocity_gain: K_p, "1.2 N m s/rad".
        reset_time: T_n; none leaves the integrator out.
        position_gain: K_v; none leaves the position loop open, and the velocity is followed.
        velocity_rate, position_rate, current_bandwidth, dead_time: of the drive, without `servo`.
        feedback: "motor" or "table", what the position loop reads, without `servo`; a scale if declared.
        feed_forward: whether that of `servo` acts.

    Raises:
        InputError: a value that cannot be used, or an unknown controller.

    >>> import feeddrive as fd
    >>> axis = fd.load("bench_axis")
    >>> loop = fd.cascade(axis, velocity_gain="1 N m s/rad", reset_time="10 ms")
    >>> loop.margins().stable
    True
    """
    plant = plant_of(axis)
    if servo is None:
        rates = (si(velocity_rate, "Hz", "velocity_rate"), si(position_rate, "Hz", "position_rate"))
        place = feedback_of(feedback)
        lag, late = si(current_bandwidth, "Hz", "current_bandwidth"), si(dead_time, "s", "dead_time")
        if not min(*rates, lag) > 0:
            raise InputError("a rate or bandwidth is not above zero", "cascade", "write positive values")
        made = bare_drive(plant, *rates, lag, late, place)
    else:
        made = cascade_for(plant, servo)
    if not feed_forward:
        made = replace(made, feed_forward=FeedForward())
    if velocity_gain is not None:
        made = replace(made, velocity_gain=si(velocity_gain, "N m s/rad", "velocity_gain"))
    if reset_time is not None:
        reset = si(reset_time, "s", "reset_time")
        made = replace(made, reset_time=reset, tracking_time=reset)
    if position_gain is not None:
        made = replace(made, position_gain=si(position_gain, "1/s", "position_gain"))
    if not made.velocity_gain > 0:
        mend = 'give velocity_gain="1 N m s/rad", or a servo of fd.tune(axis)'
        raise InputError("the velocity loop has no gain", "cascade", mend)
    return _around(plant, made)


def schedule(
    axis: Axis | str | Path, servo: Servo, positions: Sequence[Quantity]
) -> tuple[Controller, dict[float, float]]:
    """A cascade whose K_v follows the table: at each position the largest that keeps the margins there.

    The velocity loop is that of the servo at all positions; feed-forward is left out.

    Args:
        axis: the machine, with a scale, which measures where the table is.
        servo: of `tune`; gives the velocity loop and the margins asked for.
        positions: of the table, ascending, two or more.

    Returns:
        The controller, and K_v [1/s] by position [m].

    Raises:
        InputError: positions that do not ascend, or a loop that does not read the table.
    """
    plant, demand = plant_of(axis), servo.recommendation.demand
    alike = replace(servo.cascade, feed_forward=FeedForward())
    places = quantities(positions, "m", "positions")
    gains = {place: UNDER_THE_LIMIT * position_gain(plant, alike, [Case(place)], demand).gain for place in places}
    designs = [replace(alike, position_gain=gain) for gain in gains.values()]
    following = scheduled(np.array(places), [cascade_controller(one) for one in designs])

    def open_loop(velocity: float, position: float) -> control.StateSpace:
        gain = float(np.interp(position, places, list(gains.values())))
        return open_position_loop(plant, replace(alike, position_gain=gain), velocity, position)

    return Controller(plant, following, _torque_loop(alike), {"position": open_loop}), gains


def sampled(
    axis: Axis | str | Path,
    rate: Quantity = "4 kHz",
    *,
    current_bandwidth: Quantity = "1 kHz",
    dead_time: Quantity | None = None,
    at: str = "",
) -> control.StateSpace:
    """The axis and its current loop as a drive sees them: sampled exactly, torque held over a tick.

    Args:
        axis: the machine.
        rate: of the controller.
        current_bandwidth: -3 dB of the current loop.
        dead_time: of the torque; one tick if left out.
        at: operating point, "x=200 mm, v=3 m/min".

    Returns:
        Discrete state space; inputs motor torque and cutting force, outputs the readings, SI.

    Raises:
        InputError: a value that cannot be used, or a point off the stroke.

    >>> import feeddrive as fd
    >>> fd.sampled(fd.load("bench_axis"), "4 kHz").output_labels[:2]
    ['motor_angle', 'motor_speed']
    """
    import control

    plant = plant_of(axis)
    point = export_point(plant, at, "at")
    drive = _drive(plant, rate, current_bandwidth, dead_time)
    found = sampled_plant(plant, drive, point.linearised_at, point.position)
    return control.ss(found.a, found.b, found.c, found.d, drive.sample_time, inputs=list(INPUTS), outputs=list(OUTPUTS))


def with_load(machine: control.StateSpace) -> control.StateSpace:
    """The `machine` of `sampled` with the force on the table as a further, constant state, to design an observer.

    Its outputs are motor angle and table position.
    """
    import control

    a, c = observed.with_load(_matrices(machine))
    inputs = np.vstack([machine.B, np.zeros((1, machine.ninputs))])
    rows = list(observed.MEASURED)
    return control.ss(a, inputs, c, 0, machine.dt, inputs=machine.input_labels, outputs=rows)


def state_feedback(
    axis: Axis | str | Path,
    gain: FloatArray,
    observer: FloatArray,
    rate: Quantity = "4 kHz",
    *,
    current_bandwidth: Quantity = "1 kHz",
    dead_time: Quantity | None = None,
    at: str = "",
) -> Controller:
    """State feedback with an observer of the state and of the force on the table.

    Args:
        axis: the machine.
        gain: K of u = -K x, by whatever method (`control.place`, `control.dlqr`) from `sampled`, shape (1, n).
        observer: gains of the estimates from motor angle and table position, by the dual of `with_load`, shape
            (n + 1, 2).
        rate, current_bandwidth, dead_time, at: as of the `sampled` that it was designed for.

    Raises:
        InputError: gains of another size.
    """
    plant = plant_of(axis)
    point = export_point(plant, at, "at")
    drive = _drive(plant, rate, current_bandwidth, dead_time)
    machine = sampled_plant(plant, drive, point.linearised_at, point.position)
    standing = [
        observed.state_feedback(machine, drive.sample_time, gain, observer, plant.torque_limit, place)
        for place in (0.0, 1.0)
    ]

    def loop(velocity: float, position: float) -> control.StateSpace:
        actual = sampled_plant(plant, drive, velocity, position)
        return observed.open_loop(machine, drive.sample_time, np.atleast_2d(gain), observer, actual)

    known = standing[1].initial - standing[0].initial
    return Controller(plant, standing[0], _torque_loop(drive), {"torque": loop}, known)


def _around(plant: Plant, made: Cascade) -> Controller:
    """A cascade as a controller; without position gain its velocity loop alone."""
    alone = not made.position_gain
    loops: dict[str, Callable[[float, float], control.StateSpace]] = {
        "velocity": lambda velocity, position: open_velocity_loop(plant, made, velocity, position)
    }
    if not alone:
        loops["position"] = lambda velocity, position: open_position_loop(plant, made, velocity, position)
    controller = cascade_controller(velocity_loop_of(made) if alone else made)
    return Controller(plant, controller, _torque_loop(made), loops)


def _torque_loop(made: Cascade) -> TorqueLoop:
    return TorqueLoop(made.current_lag, made.dead_time)


def _drive(plant: Plant, rate: Quantity, current_bandwidth: Quantity, dead_time: Quantity | None) -> Cascade:
    """A drive of one rate without gains."""
    ticks, bandwidth = si(rate, "Hz", "rate"), si(current_bandwidth, "Hz", "current_bandwidth")
    if not min(ticks, bandwidth) > 0:
        raise InputError("a rate or bandwidth is not above zero", "rate", 'write one such as "4 kHz"')
    late = 1 / ticks if dead_time is None else si(dead_time, "s", "dead_time")
    if not 0 <= late < math.inf:
        raise InputError(f"{dead_time} is no dead time", "dead_time", "write zero or more")
    return bare_drive(plant, ticks, ticks, bandwidth, late)


def _matrices(machine: control.StateSpace) -> Matrices:
    a, b, c, d = (np.asarray(matrix, dtype=float) for matrix in (machine.A, machine.B, machine.C, machine.D))
    return Matrices(a, b, c, d)
