"""What the linearised plant says to a measured frequency response; the difference is friction, free play and limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.plant.analysis.linear import MOVING, OUTPUTS
from feeddrive.servo.cascade_function import velocity_loop_of
from feeddrive.servo.linear_loop import closed_loop
from feeddrive.servo.margins import frequency_response
from feeddrive.servo.sampled_plant import sampled_plant
from feeddrive.simulate.scenario.scenario_result import ScenarioResult
from feeddrive.typing import ComplexArray, FloatArray


def linear_response(result: ScenarioResult, given: str, output: str, frequency: FloatArray) -> ComplexArray | None:
    """The response of the linear plant, or of the closed velocity loop, sampled like the recording.

    Args:
        result: of a run; linearised about its mean velocity.
        given, output: series.
        frequency: [Hz], shape (n,).

    Returns:
        Complex response, shape (n,); None for a pair that is neither torque to a reading nor, with the position loop
        open, speed command to motor speed.

    Raises:
        InputError: no steady motion at that velocity.
    """
    scenario = result.scenario
    mean = float(np.mean(result.series["table_velocity"]))
    velocity = mean if abs(mean) > 1e-3 else MOVING
    if given == "motor_torque" and output in OUTPUTS:
        alone = replace(
            scenario.cascade,
            sample_time=scenario.sample_time,
            current_lag=0.0,
            dead_time=0.0,
            torque_filters=(),
            speed_filters=(),
            tracking_time=1.0,
        )
        machine = sampled_plant(scenario.plant, alone, velocity)
        return _transfer(machine.a, machine.b[:, 0], machine.c[OUTPUTS.index(output)], frequency, scenario.sample_time)
    if (given, output) == ("speed_command", "motor_speed") and not scenario.cascade.position_gain:
        loop = closed_loop(scenario.plant, replace(velocity_loop_of(scenario.cascade), position_divider=1), velocity)
        command, speed = (
            frequency_response(loop[name, "speed_excitation"], frequency) for name in ("speed_command", "motor_speed")
        )
        ratio: ComplexArray = speed / command
        return ratio
    return None


def _transfer(a: FloatArray, b: FloatArray, c: FloatArray, frequency: FloatArray, step: float) -> ComplexArray:
    """c (z - A)^-1 b."""
    z = np.exp(2j * np.pi * frequency * step)
    values: ComplexArray = np.array([c @ np.linalg.solve(one * np.eye(len(a)) - a, b) for one in z])
    return values
