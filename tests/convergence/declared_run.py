"""The plant under the controller that it declares: sampled, its output held until the next tick."""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.engine.program import TOLERANCE, StepReport
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.simulate.controlled.controlled import simulate_controlled
from feeddrive.simulate.controlled.declared_loop import declared_loop
from feeddrive.simulate.held_torque import even_sample_time
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class ClosedLoopRun:
    """Motion of a plant under its controller, at the samples, shape (n,).

    Attributes:
        time: [s] as given.
        torque: motor torque commanded at the sample, before any delay [N m].
        output: of the controller, in its unit; of a cascade the torque.
        position, velocity: of the table [m, m/s].
        motor_angle: [rad].
        report: how the steps went.
    """

    time: FloatArray
    torque: FloatArray
    output: FloatArray
    position: FloatArray
    velocity: FloatArray
    motor_angle: FloatArray
    report: StepReport


def simulate_closed_loop(
    plant: Plant, time: FloatArray, setpoint: FloatArray, initial_position: float, initial_velocity: float = 0.0,
    tolerance: float = TOLERANCE,
) -> ClosedLoopRun:  # fmt: skip
    """The plant under its declared controller; no torque before the start; sensors are read without their steps.

    Args:
        plant: with its values and a controller.
        time: sample times, evenly spaced [s], shape (n,).
        setpoint: of the table position at the samples [m], shape (n,).
        initial_position: of the table [m]; the transmission starts without force.
        initial_velocity: of the table [m/s].
        tolerance: error of the table position that a step may make [m].

    Returns:
        The motion and what the controller did.

    Raises:
        InputError: no controller declared, one that does not fit the sample time, times that are not evenly spaced,
            lengths that differ, or a motion that cannot be followed.
    """
    sample = even_sample_time(plant.name, time, len(setpoint), setpoint)
    loop = declared_loop(plant, sample)
    if loop is None:
        raise InputError("no controller is declared", plant.name, "add a [controller] table to the plant")
    start = loop.begin(plant, initial_position, initial_velocity)
    run = simulate_controlled(
        plant, loop.controller, loop.reference(setpoint), None, loop.torque_loop, start, False, tolerance
    )
    every = slice(None, None, loop.ticks)
    output = run.signals.get("output", run.command)
    return ClosedLoopRun(
        time, run.command[every], output[every], run.table_position[every], run.table_velocity[every],
        run.motor_angle[every], run.report,
    )  # fmt: skip
