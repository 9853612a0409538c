"""The controller that a plant declares, made ready for a recording: what it is fed, where it begins, how it ticks.

A recording holds the set-point of the position alone. Its velocity and acceleration, where the controller forwards
them, are taken as a drive takes them: differences over one tick of the position loop, here of the set-point smoothed
over a few milliseconds, because a recorded set-point is rounded.

    v_i = x'(t_i - h / 2),    a_i = x''(t_i - h)        h: from one position tick to the next
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_filter

from feeddrive.errors import InputError
from feeddrive.plant.file.entries import Origins, Table
from feeddrive.plant.plant import DeclaredCascade, Plant
from feeddrive.servo.cascade import Feedback
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.servo.sampled import SampledController
from feeddrive.simulate.controlled.controlled import ControlledState, TorqueLoop, resting_state
from feeddrive.simulate.controlled.position_velocity import position_velocity_controller
from feeddrive.simulate.scenario.scenario_controller import read_cascade
from feeddrive.typing import FloatArray

SMOOTHING = 5e-3
"""Half width of the polynomial that smooths a recorded set-point for its derivatives [s]; a cubic."""

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

    def reference(self, setpoint: FloatArray) -> FloatArray:
        """What the controller is fed, from the recorded set-point [m], shape (n,); shape (n ticks, references)."""
        h = self.controller.sample_time
        sample, count = h * self.ticks, len(setpoint)
        recorded = sample * np.arange(count)
        time: FloatArray = h * np.arange((count - 1) * self.ticks + 1, dtype=np.float64)
        position = setpoint if self.ticks == 1 else CubicSpline(recorded, setpoint)(time)
        columns = {"position": position}
        if "velocity" in self.controller.references:
            columns["velocity"] = self._slope(setpoint, 1, time - self.position_tick / 2)
            columns["acceleration"] = self._slope(setpoint, 2, time - self.position_tick)
        nothing = np.zeros(len(time))
        return np.column_stack([columns.get(name, nothing) for name in self.controller.references])

    def _slope(self, setpoint: FloatArray, order: int, time: FloatArray) -> FloatArray:
        sample = self.controller.sample_time * self.ticks
        width = max(2 * round(SMOOTHING / sample) + 1, 5)
        if len(setpoint) <= width:
            raise InputError("the set-point is too short", "recording", f"record more than {width} samples")
        smooth = savgol_filter(setpoint, width, 3, deriv=order, delta=sample, mode="nearest")
        slope: FloatArray = CubicSpline(sample * np.arange(len(setpoint)), smooth)(np.maximum(time, 0.0))
        return slope

    def begin(self, plant: Plant, position: float, velocity: float = 0.0) -> ControlledState:
        """The axis at `position` [m] and `velocity` [m/s], no torque, the controller without history."""
        return resting_state(plant, self.started(plant, position, velocity), self.torque_loop, position, velocity)

    def started(self, plant: Plant, position: float, velocity: float = 0.0) -> SampledController:
        """The controller with the positions that it remembers set to those of a steady motion [m, m/s]."""
        if "velocity" in self.controller.references or not len(self.controller.initial):
            return self.controller
        back = np.arange(len(self.controller.initial), 0, -1, dtype=np.float64) * self.controller.sample_time
        initial: FloatArray = position - velocity * back
        return replace(self.controller, initial=initial)


def declared_loop(plant: Plant, sample_time: float) -> DeclaredLoop | None:
    """The loop that a plant declares; None where it declares no controller.

    Args:
        plant: with its controller.
        sample_time: of the recording [s].

    Raises:
        InputError: a cascade that cannot be read, or whose rate is no whole multiple of the recording's.
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
