"""An axis under any controller, or under a torque: the nonlinear machine, tick by tick."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.errors import InputError
from feeddrive.interface.plants import plant_of
from feeddrive.interface.quantities import Quantity, positive, si
from feeddrive.interface.runs.controllers import Controller
from feeddrive.interface.shown import Listing, Shown, needed_pandas
from feeddrive.metrology.response import Response, StepResponse, recorded_response, step_response
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.plant import Plant
from feeddrive.recording.recording import Recording
from feeddrive.simulate.controlled.controlled import resting_state, simulate_controlled
from feeddrive.simulate.held_torque import simulate_torque
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

if TYPE_CHECKING:
    import pandas

    from feeddrive.interface.axis import Axis
    from feeddrive.report.figures.drawing import ReportFigure

Course = Quantity | Callable[[FloatArray], FloatArray] | FloatArray
"""A value over time: a quantity that stays, samples in SI, or what gives them from the times [s]."""

UNITS = {
    "position": "m",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "speed_excitation": "rad/s",
    "torque_excitation": "N m",
}
"""Units of what a controller may be fed."""

SERIES = {
    "command": "N m",
    "motor_torque": "N m",
    "motor_angle": "rad",
    "motor_speed": "rad/s",
    "table_position": "m",
    "table_velocity": "m/s",
}


@dataclass(frozen=True, repr=False, eq=False)
class Motion(Shown):
    """What `move` gives: exact series at the ticks.

    Attributes:
        axis_name: of the machine.
        time: [s], shape (n,).
        series: "table_position", "motor_torque", ... and the signals of the controller, SI, shape (n,) each.
        sample_time: from tick to tick [s].
    """

    axis_name: str
    time: FloatArray
    series: Mapping[str, FloatArray]
    sample_time: float

    def __getitem__(self, name: str) -> FloatArray:
        """Samples of a series, shape (n,), SI.

        Raises:
            InputError: no such series; names those there are.
        """
        if name not in self.series:
            raise InputError(f'no series "{name}"', self.axis_name, f"it has {', '.join(self.series)}")
        return self.series[name]

    def step(self, name: str, at: Quantity) -> StepResponse:
        """Rise, overshoot and settling of a series that steps at a time.

        Raises:
            InputError: too few samples about the step, or a series that does not change.
        """
        return step_response(self.time, self[name], si(at, "s", "at"))

    def response(self, given: str, output: str) -> Response:
        """Frequency response between two series as it is measured: averaged spectra, H1, with its coherence.

        Args:
            given: `motor_torque`, which was excited.
            output: such as `table_velocity`.

        Raises:
            InputError: too few samples, or an input that does not change.
        """
        channels = {name: self.series[name] for name in SERIES if name in self.series}
        return recorded_response(Recording(self.axis_name, self.time, channels, self.sample_time), given, output)

    def listing(self) -> Listing:
        """One row per series: least, largest, at the end."""
        rows, records = [], []
        for name, values in self.series.items():
            unit = SERIES.get(name, "")
            ends = (float(values.min()), float(values.max()), float(values[-1]))
            rows.append([name, *(format_quantity(end, unit) if unit else f"{end:.6g}" for end in ends)])
            records.append({"series": name, "unit": unit, "least": ends[0], "largest": ends[1], "end": ends[2]})
        span = format_quantity(len(self.time) * self.sample_time, "s")
        return Listing(f"{self.axis_name}, {span}", ("series", "least", "largest", "at the end"), rows, records)

    def to_pandas(self) -> pandas.DataFrame:
        """The series over the time [s]; columns SI.

        Raises:
            InputError: pandas is not installed.
        """
        pandas = needed_pandas()
        return pandas.DataFrame(dict(self.series), index=pandas.Index(self.time, name="time [s]"))

    def _figures(self) -> list[ReportFigure]:
        from feeddrive.report.figures.figure_scenario import run_figure

        return [run_figure(self.axis_name, self.time, self.series)]


MOST_TICKS = 50_000_000
"""Samples of a run at most: three hours at 4 kHz, some gigabytes."""


def move(
    axis: Axis | str | Path,
    controller: Controller | None = None,
    *,
    duration: Quantity,
    torque: Course | None = None,
    rate: Quantity = "4 kHz",
    force: Course = 0.0,
    start: Quantity = 0.0,
    moving: Quantity = 0.0,
    **references: Course,
) -> Motion:
    """Run the nonlinear axis under a controller that is fed anything, or under a torque.

    Args:
        axis: the machine.
        controller: of `cascade`, `schedule` or `state_feedback`; none to give the torque.
        duration: of the run.
        torque: of the motor, beyond what holds the starting motion, without a controller; held over each sample.
        rate: of the samples, without a controller.
        force: on the table, along + motion, with a controller.
        start: table position at the beginning.
        moving: table velocity at the beginning.
        references: what the controller is fed, "position", "velocity", ...; each a quantity that stays, samples, or a
            function of the times [s], such as lambda t: 0.1 + 0.02 * t. Zero where not given; the position stays at
            `start`.

    Raises:
        InputError: a name or a shape that does not fit; both or none of controller and torque.

    >>> import feeddrive as fd
    >>> axis = fd.load("bench_axis")
    >>> loop = fd.cascade(axis, velocity_gain="1 N m s/rad", reset_time="10 ms")
    >>> run = fd.move(axis, loop, duration="0.2 s", velocity=lambda t: 0.05 + 0.01 * (t >= 0.1), moving="0.05 m/s")
    >>> round(run.step("table_velocity", at="0.1 s").final, 2)
    0.06
    """
    plant = plant_of(axis)
    if (controller is None) == (torque is None):
        raise InputError("a controller or a torque is needed, not both", "move", "give fd.cascade(...), or torque=...")
    place, speed = si(start, "m", "start"), si(moving, "m/s", "moving")
    if torque is not None:
        return _under_torque(plant, torque, duration, 1 / positive(rate, "Hz", "rate", "4 kHz"), place, speed)
    assert controller is not None
    return _under_control(plant, controller, references, force, duration, place, speed)


def _under_torque(plant: Plant, torque: Course, duration: Quantity, tick: float, place: float, speed: float) -> Motion:
    """From a steady motion on, driven by a torque beyond what holds it."""
    time = _ticks(duration, tick)
    given = steady_motion(plant, speed, place).torque + _course(torque, time, "N m", "torque")
    run = simulate_torque(plant, time, given, place, speed)
    named = {
        "motor_torque": run.torque,
        "motor_angle": run.motor_angle,
        "table_position": run.position,
        "table_velocity": run.velocity,
    }
    return Motion(plant.name, time, named, tick)


def _under_control(
    plant: Plant, controller: Controller, references: dict[str, Course], force: Course, duration: Quantity,
    place: float, speed: float,
) -> Motion:  # fmt: skip
    """From a motion at constant speed on, under a controller that is fed the references."""
    fed, tick = controller.sampled.references, controller.sampled.sample_time
    unknown = [name for name in references if name not in fed]
    if unknown:
        raise InputError(f"the controller is not fed with {', '.join(unknown)}", "move", f"give {', '.join(fed)}")
    time, given = _ticks(duration, tick), {"position": place, **references}
    columns = [_course(given.get(name, 0.0), time, UNITS.get(name, "1"), name) for name in fed]
    sampled, loop = controller.starting_at(place), controller.torque_loop
    begin = resting_state(plant, sampled, loop, place, speed)
    load = _course(force, time, "N", "force")
    run = simulate_controlled(plant, sampled, np.column_stack(columns), load, loop, begin)
    names = ("command", "torque", "motor_angle", "motor_speed", "table_position", "table_velocity")
    shown = {"motor_torque" if name == "torque" else name: getattr(run, name) for name in names}
    return Motion(plant.name, run.time, {**shown, **run.signals}, tick)


def _ticks(duration: Quantity, tick: float) -> FloatArray:
    count = round(si(duration, "s", "duration") / tick)
    if count < 1:
        raise InputError(f"{duration} is less than a sample", "duration", "write a longer one")
    if count > MOST_TICKS:
        raise InputError(f"{duration} are {count:.3g} samples", "duration", "write a shorter one, or a lower rate")
    return np.arange(count, dtype=float) * tick


def _course(given: Course, time: FloatArray, unit: str, name: str) -> FloatArray:
    """Values at the times, (n,)."""
    if callable(given):
        given = np.asarray(given(time), dtype=float)
    if isinstance(given, np.ndarray | list | tuple):
        values = np.asarray(given, dtype=float)
        if values.shape not in (time.shape, ()):
            raise InputError(f"samples of shape {values.shape}", name, f"give {len(time)} of them, one a tick")
        return np.broadcast_to(values, time.shape).copy()
    return np.full(time.shape, si(given, unit, name))
