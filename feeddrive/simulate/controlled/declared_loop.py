"""The controller that a plant declares, made ready for a recording: what it is fed, where it begins, how it ticks.

A recording holds the set-point of the position alone. Its velocity and acceleration, where the controller forwards
them, are taken as a drive takes them: differences over one tick of the position loop, here of the set-point smoothed
over a few milliseconds, because a recorded set-point is rounded.

    v_i = x'(t_i - h / 2),    a_i = x''(t_i - h)        h: from one position tick to the next

A test signal that was injected and recorded is fed as it is: held over the ticks of a sample, which keeps its mean.

The declared cascade of a position and a velocity gain as the function of one tick that engine and replay take.

    u = K_vel (K_pos (x_set - x) + r w_e - v),   |u| <= limit,   T = gain u + T_e,     v = (x_i - x_(i-m)) / (m h)

| symbol | meaning | unit |
|---|---|---|
| x_set, x, v | set-point, position and velocity read at the sample | m, m, m/s |
| u, T | controller output and motor torque, from the sample to the next | V, N m |
| w_e, T_e, r | injected speed and torque at the motor, travel per radian of it | rad/s, N m, m |
| m, h | samples over which the position is differenced, sample time; m = 0: v is the velocity itself | 1, s |

A drive with an encoder alone has no velocity but such a difference, and reads it m h / 2 late. The position is read at
the table, or from the motor angle where the sensor of the channel `table_position` is declared to sit at the motor.

What a declared controller commands when it is fed the recorded set-point and motion, no plant in between.

Beside the recorded torque this says whether the declared controller is the one that was recorded, and where something
else had a part in the torque, such as a test signal that was injected and not recorded.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np
from scipy.interpolate import CubicSpline

from feeddrive.errors import InputError
from feeddrive.plant.plant import DeclaredCascade, Plant, PositionVelocityController
from feeddrive.recording import Recording
from feeddrive.schema.table import Origins, Table
from feeddrive.servo.cascade import Feedback
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.sampled_plant import SampledController
from feeddrive.simulate.controlled.acting_torque import ActingTorque
from feeddrive.simulate.controlled.controlled import (
    ControlledRun,
    ControlledState,
    TorqueLoop,
    resting_state,
    simulate_controlled,
)
from feeddrive.simulate.scenario.scenario_controller import read_cascade
from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.typing import Expression, FloatArray

PARAMETERS = ("position_gain", "velocity_gain", "output_limit", "torque_per_output", "radius", "sample_time")
"""Parameters of the function, in order."""

REFERENCES = ("position", "speed_excitation", "torque_excitation")
"""References: of the table [m]; injected at the motor [rad/s, N m]."""


def position_velocity_controller(
    plant: Plant, declared: PositionVelocityController, sample_time: float
) -> SampledController:
    """The declared controller, its earlier positions at 0.

    Args:
        plant: says where the position is read, and how far the table goes per radian of the motor.
        declared: gains, limit and how the velocity is read.
        sample_time: from one tick to the next [s].
    """
    at_motor = any(sensor.channel == "table_position" and sensor.at == "motor" for sensor in plant.sensors)
    samples = declared.velocity_samples
    # with differences the motor angle alone is read, as a drive does; a rigid table is there too
    position = "motor_angle" if at_motor else "table_position"
    rates = () if samples else ("motor_speed" if at_motor else "table_velocity",)
    values = [declared.position_gain, declared.velocity_gain, declared.output_limit, declared.torque_per_output]
    parameters = np.array([*values, plant.chain.motor_radius, sample_time])
    function = _function(samples, at_motor)
    return SampledController(
        function, np.zeros(samples), parameters, sample_time, REFERENCES, (position, *rates), ("output",)
    )


@lru_cache(maxsize=16)
@SYMBOLS.taken()
def _function(samples: int, at_motor: bool) -> ca.Function:
    state, fed, tick = ca.SX.sym("state", samples), ca.SX.sym("fed", len(REFERENCES)), ca.SX.sym("tick")
    measured = ca.SX.sym("measured", 1 if samples else 2)
    p = ca.SX.sym("p", len(PARAMETERS))
    scale = p[4] if at_motor else ca.SX(1.0)
    position = scale * measured[0]
    velocity = (position - state[0]) / (samples * p[5]) if samples else scale * measured[1]
    output = _clipped(p[1] * (p[0] * (fed[0] - position) + p[4] * fed[1] - velocity), p[2])
    after = ca.vertcat(*[state[i] for i in range(1, samples)], position) if samples else state
    return ca.Function("position_velocity", [state, fed, measured, tick, p], [after, p[3] * output + fed[2], output])


def _clipped(value: Expression, limit: Expression) -> Expression:
    return ca.fmin(ca.fmax(value, -limit), limit)


SMOOTHING = 5e-3
"""Half width of the polynomial that smooths a recorded set-point for its derivatives [s]; a cubic."""

_FED = {"speed_excitation": "injected_speed", "torque_excitation": "injected_torque"}
"""Reference of a controller to the recorded channel."""

TICKS = 1e-6
"""Deviation of the sample time from whole ticks of the controller that is rounding."""


@dataclass(frozen=True)
class DeclaredLoop:
    """A declared controller, ready for recordings of one sample time.

    Attributes:
        controller: what is called at every tick.
        torque_loop: lag and dead time of the torque.
        ticks: per sample of the recording.
        position_tick: from one call of the position loop to the next [s].
        at_motor: whether the position is read at the motor.
    """

    controller: SampledController
    torque_loop: TorqueLoop
    ticks: int
    position_tick: float
    at_motor: bool

    def reference(self, setpoint: FloatArray, channels: Mapping[str, FloatArray]) -> FloatArray:
        """What the controller is fed, shape (n ticks, references), from the recorded set-point [m], shape (n,).

        Of the channels `injected_torque` [N m] and `injected_speed` [rad/s] are added where they were recorded, shape
        (n,). Raises InputError where the set-point is too short for its derivatives.
        """
        h = self.controller.sample_time
        sample, count = h * self.ticks, len(setpoint)
        recorded = sample * np.arange(count)
        time: FloatArray = h * np.arange((count - 1) * self.ticks + 1, dtype=np.float64)
        position = setpoint if self.ticks == 1 else CubicSpline(recorded, setpoint)(time)
        columns = {"position": position}
        if "velocity" in self.controller.references:
            columns["velocity"] = self._slope(setpoint, 1, time - self.position_tick / 2)
            columns["acceleration"] = self._slope(setpoint, 2, time - self.position_tick)
        for name, channel in _FED.items():
            columns[name] = np.repeat(channels[channel], self.ticks) if channel in channels else np.zeros(len(time))
        return np.column_stack([columns[name][: len(time)] for name in self.controller.references])

    def _slope(self, setpoint: FloatArray, order: int, time: FloatArray) -> FloatArray:
        from scipy.signal import savgol_filter  # takes a second to import

        sample = self.controller.sample_time * self.ticks
        width = max(2 * round(SMOOTHING / sample) + 1, 5)
        if len(setpoint) <= width:
            raise InputError("the set-point is too short", "recording", f"record more than {width} samples")
        smooth = savgol_filter(setpoint, width, 3, deriv=order, delta=sample)
        slope: FloatArray = CubicSpline(sample * np.arange(len(setpoint)), smooth)(np.maximum(time, 0.0))
        return slope

    def begin(self, plant: Plant, position: float, velocity: float = 0.0) -> ControlledState:
        """The axis at `position` [m] and `velocity` [m/s], no torque, the controller without history."""
        return resting_state(plant, self.started(plant, position, velocity), self.torque_loop, position, velocity)

    def simulated(self, plant: Plant, reference: FloatArray, position: float, velocity: float = 0.0) -> ControlledRun:
        """The plant under the controller, fed by `reference`, no torque before the start; sensors without their steps.

        The table starts at a position and velocity [m, m/s], the transmission without force.
        """
        start, controller = self.begin(plant, position, velocity), self.started(plant, position, velocity)
        return simulate_controlled(plant, controller, reference, None, self.torque_loop, start, quantised=False)

    def recorded_torque(self, command: FloatArray) -> FloatArray:
        """Motor torque as it is recorded, through dead time and lag and averaged over each sample [N m], shape (n,).

        Args:
            command: at the ticks [N m], shape (n ticks,).
        """
        tick = self.controller.sample_time
        means, _ = ActingTorque.at_rest(self.torque_loop, tick).means(self.torque_loop, tick, command)
        whole = np.pad(means, (0, -len(means) % self.ticks), mode="edge")
        torque: FloatArray = whole.reshape(-1, self.ticks).mean(axis=1)
        return torque

    def started(self, plant: Plant, position: float, velocity: float = 0.0) -> SampledController:
        """The controller with the positions that it remembers set to those of a steady motion [m, m/s]."""
        if "velocity" in self.controller.references or not len(self.controller.initial):
            return self.controller
        back = np.arange(len(self.controller.initial), 0, -1, dtype=np.float64) * self.controller.sample_time
        initial: FloatArray = position - velocity * back
        return replace(self.controller, initial=initial)


def declared_loop(plant: Plant, sample_time: float) -> DeclaredLoop | None:
    """The loop that a plant declares, for recordings of a sample time [s]; None where it declares no controller.

    Raises InputError: a cascade that cannot be read, or whose rate is no whole multiple of the recording's.
    """
    declared = plant.controller
    if declared is None:
        return None
    if not isinstance(declared, DeclaredCascade):
        controller = position_velocity_controller(plant, declared, sample_time)
        return DeclaredLoop(controller, TorqueLoop(), 1, sample_time, controller.measurements[0] == "motor_angle")
    cascade, _ = read_cascade(Table(declared.entries, declared.where, Origins()), plant)
    ticks = round(sample_time / cascade.sample_time)
    if ticks < 1 or abs(sample_time / cascade.sample_time - ticks) > TICKS * ticks:
        rate = 1 / cascade.sample_time
        what = f"the recording's sample time of {sample_time:g} s is no whole number of ticks at {rate:g} Hz"
        raise InputError(what, declared.where, "declare velocity_rate as the recording's rate or a multiple of it")
    slow = cascade.sample_time * cascade.position_divider
    loop = TorqueLoop(cascade.current_lag, cascade.dead_time)
    return DeclaredLoop(cascade_controller(cascade), loop, ticks, slow, cascade.feedback is Feedback.MOTOR)


AT_ONCE = 1000
"""Ticks that are computed in one call."""


def replayed_command(plant: Plant, loop: DeclaredLoop, recording: Recording) -> FloatArray:
    """Torque that the controller brings about over a recording [N m], shape (n,), within the torque limit.

    Args:
        plant: gives the torque limit, and the table's motion where it was not recorded.
        loop: from `declared_loop`, for the recording's sample time.
        recording: with setpoint and motor_angle; what was injected counts where it was recorded.
    """
    controller = loop.controller
    fed = loop.reference(recording["setpoint"], recording.channels)
    time: FloatArray = controller.sample_time * np.arange(len(fed), dtype=np.float64)
    readings = _readings(plant, loop, recording, time)
    measured = np.column_stack([readings[name] for name in controller.measurements])
    position = readings["motor_angle"][0] * plant.chain.motor_radius if loop.at_motor else readings["table_position"][0]
    state = loop.started(plant, float(position)).initial
    many, parts = controller.function.mapaccum("replay", AT_ONCE), []
    for first in range(0, len(fed), AT_ONCE):
        ticks = np.minimum(np.arange(first, first + AT_ONCE), len(fed) - 1)  # the last tick fills up the last part
        states, asked, _ = many(
            state, fed[ticks].T, measured[ticks].T, ticks[None, :].astype(float), controller.parameters
        )
        state = states[:, -1]
        parts.append(np.array(asked).ravel())
    command = np.concatenate(parts)[: len(fed)]
    return loop.recorded_torque(np.clip(command, -plant.torque_limit, plant.torque_limit))


def _readings(plant: Plant, loop: DeclaredLoop, recording: Recording, time: FloatArray) -> dict[str, FloatArray]:
    """All that a controller may measure, at its ticks; the table follows the motor where it was not recorded."""
    angle = recording["motor_angle"]
    table = recording["table_position"] if "table_position" in recording else plant.chain.motor_radius * angle
    recorded = recording.sample_time * np.arange(len(recording))
    readings: dict[str, FloatArray] = {}
    for position, rate, series in (("motor_angle", "motor_speed", angle), ("table_position", "table_velocity", table)):
        followed = CubicSpline(recorded, series)
        readings[position], readings[rate] = followed(time), followed(time, 1)
    return readings
