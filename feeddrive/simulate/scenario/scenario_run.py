"""Running a scenario in stretches, its state written between them so that a stopped run goes on where it was.

A resumed run is bit for bit the run that was never stopped: the engine's state, the torque under way and everything
recorded so far are in the checkpoint, and nothing depends on how the stretches are cut.
"""

from __future__ import annotations

import io
import time as clock
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from feeddrive.engine.lateness import LateChannels
from feeddrive.errors import InputError
from feeddrive.files import write_bytes_atomically
from feeddrive.servo.cascade_function import cascade_controller
from feeddrive.simulate.controlled.acting_torque import ActingTorque
from feeddrive.simulate.controlled.controlled import (
    ControlledState,
    TorqueLoop,
    resting_state,
    simulate_controlled,
    state_from,
)
from feeddrive.simulate.scenario.scenario import MEANS, SERIES, Place, Scenario, ScenarioResult, recorded
from feeddrive.simulate.setpoints.cutting_force import held
from feeddrive.typing import FloatArray

STRETCH = 40_000
"""Ticks between looks at the clock, about; 5 s at 8 kHz."""

CHECKPOINT_EVERY = 5.0
"""Seconds of work between checkpoints; shorter runs write none."""

CHECKPOINT_SHARE = 0.05
"""Share of the time that writing checkpoints may take: large ones are written more seldom."""

_DAMAGE = (
    ValueError,
    KeyError,
    OSError,
    EOFError,
    TypeError,
    AttributeError,
    MemoryError,
    NotImplementedError,
    SyntaxError,
    BadZipFile,
    zlib.error,
)
"""What numpy and zipfile raise where bytes of an archive were lost or changed."""

Progress = Callable[[float], None]
"""Called with the share of the run that is done."""


@dataclass(frozen=True)
class _Done:
    """A run so far: state of the engine, torque under way, rows of `_columns`, one per sample, what late channels hold.

    late: None at the start.
    """

    state: ControlledState
    torque: ActingTorque
    rows: tuple[FloatArray, ...]
    late: LateChannels | None = None


def run_scenario(
    scenario: Scenario, checkpoint: Path | None = None, progress: Progress | None = None
) -> ScenarioResult:
    """Run a scenario from its start, or from the checkpoint of the same scenario where there is one.

    Args:
        scenario: to run.
        checkpoint: file for the state of a long run; removed at the end. None writes none.
        progress: called after every stretch.

    Returns:
        The finished run.

    Raises:
        InputError: fewer than two samples, a checkpoint that cannot be read or written.
        SimulationError: a motion that cannot be followed.
    """
    divider = scenario.recorder.divider
    samples = scenario.ticks // divider
    if samples < 2:
        raise InputError("the run is shorter than two samples", scenario.name, "make it longer or the rate higher")
    done = _resumed(scenario, checkpoint) or _start(scenario)
    due = clock.monotonic() + CHECKPOINT_EVERY
    stretch = divider * max(1, STRETCH // divider)
    while done.state.tick < samples * divider:
        try:
            done = _further(scenario, done, min(stretch, samples * divider - done.state.tick))
        except KeyboardInterrupt:
            if checkpoint is not None:
                write_checkpoint(scenario, done, checkpoint)
            raise
        if checkpoint is not None and clock.monotonic() > due:
            begun = clock.monotonic()
            write_checkpoint(scenario, done, checkpoint)
            due = clock.monotonic() + max(CHECKPOINT_EVERY, (clock.monotonic() - begun) / CHECKPOINT_SHARE)
        if progress is not None:
            progress(done.state.tick / (samples * divider))
    if checkpoint is not None:
        checkpoint.unlink(missing_ok=True)
    return _finished(scenario, done)


def _start(scenario: Scenario) -> _Done:
    controller, loop = cascade_controller(scenario.cascade), _torque_loop(scenario)
    position = float(scenario.trajectory.at(np.zeros(1)).position[0])
    state = resting_state(scenario.plant, controller, loop, position)
    return _Done(state, ActingTorque.at_rest(loop, scenario.cascade.sample_time), ())


def _torque_loop(scenario: Scenario) -> TorqueLoop:
    return TorqueLoop(scenario.cascade.current_lag, scenario.cascade.dead_time)


def _further(scenario: Scenario, done: _Done, count: int) -> _Done:
    """The run some ticks further."""
    tick, first = scenario.cascade.sample_time, done.state.tick
    time = np.arange(first, first + count, dtype=np.float64) * tick
    motion = scenario.trajectory.at(time)
    speed, torque = _excitations(scenario, time)
    reference = np.column_stack([motion.position, motion.velocity, motion.acceleration, speed, torque])
    load = held(scenario.force, first, count, tick)
    controller = cascade_controller(scenario.cascade)
    loop = _torque_loop(scenario)
    run = simulate_controlled(scenario.plant, controller, reference, load, loop, done.state)
    means, under_way = done.torque.means(loop, tick, run.command)
    readings = {
        "motor_torque": means,
        "motor_angle": run.motor_angle,
        "motor_speed": run.motor_speed,
        "table_position": run.table_position,
        "table_velocity": run.table_velocity,
    }
    at_start = {name: float(values[0]) for name, values in readings.items()}
    late, held_on = (done.late or LateChannels.at_rest(scenario.plant, tick, at_start)).read(readings)
    series = {**readings, "setpoint": motion.position, "cutting_force": load}
    series |= {"injected_speed": speed, "injected_torque": torque}
    series["speed_command"] = run.signals["speed_command"]
    rows = _rows(scenario, series, late)
    return _Done(run.end, under_way, (*done.rows, rows), held_on)


def _excitations(scenario: Scenario, time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What is added to the speed set-point [rad/s] and to the torque command [N m]."""
    nothing, given = np.zeros_like(time), scenario.excitation
    if given is None:
        return nothing, nothing
    since = time - given.start
    acting = (since > -1e-9) & (since < given.waveform.duration - 1e-9)
    values = np.where(acting, given.amplitude * given.waveform.values(np.maximum(since, 0.0))[1], 0.0)
    return (values, nothing) if given.place is Place.SPEED else (nothing, values)


def _columns(scenario: Scenario) -> tuple[str, ...]:
    """Names of what is kept per sample: `SERIES`, then the channels as they are recorded late."""
    return (*SERIES, *LateChannels.at_rest(scenario.plant, scenario.cascade.sample_time, {}).delays)


def _rows(scenario: Scenario, series: Mapping[str, FloatArray], late: Mapping[str, FloatArray]) -> FloatArray:
    """Samples of `_columns` of a stretch, shape (samples, columns); `series` and `late` per tick."""
    divider = scenario.recorder.divider
    pairs = [*((name, series[name]) for name in SERIES), *late.items()]
    return np.column_stack(
        [values.reshape(-1, divider).mean(axis=1) if name in MEANS else values[::divider] for name, values in pairs]
    )


def _finished(scenario: Scenario, done: _Done) -> ScenarioResult:
    table = np.ascontiguousarray(np.vstack(done.rows).T)
    time = np.arange(table.shape[1], dtype=np.float64) * scenario.sample_time
    series = dict(zip(SERIES, table, strict=False))
    late = dict(zip(_columns(scenario)[len(SERIES) :], table[len(SERIES) :], strict=True))
    return ScenarioResult(scenario, recorded(scenario, time, {**series, **late}), time, series)


def write_checkpoint(scenario: Scenario, done: _Done, path: Path) -> None:
    """Write the state of a run, whole or not at all.

    Raises:
        InputError: the file cannot be written.
    """
    buffer = io.BytesIO()
    rows = np.vstack(done.rows) if done.rows else np.zeros((0, len(_columns(scenario))))
    digest = np.frombuffer(scenario.digest.encode(), dtype=np.uint8)
    late = done.late.vector if done.late is not None else np.zeros(0)
    np.savez(buffer, digest=digest, state=done.state.vector, torque=done.torque.state, rows=rows, late=late)
    write_bytes_atomically(path, buffer.getvalue())


def _resumed(scenario: Scenario, path: Path | None) -> _Done | None:
    """What a checkpoint of this scenario holds; None where there is none, or that of another scenario."""
    if path is None or not path.is_file():
        return None
    mend = "remove it to start anew"
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            digest, state, torque, rows, late = (file[name] for name in ("digest", "state", "torque", "rows", "late"))
    except _DAMAGE:
        raise InputError("is not a checkpoint", str(path), mend) from None
    if bytes(digest).decode(errors="replace") != scenario.digest:
        return None
    if not len(rows):
        return None  # stopped before anything was done
    _refuse_other_shapes(scenario, {"state": state, "torque": torque, "rows": rows, "late": late}, str(path), mend)
    held_on = LateChannels.at_rest(scenario.plant, scenario.cascade.sample_time, {}).resumed(late)
    return _Done(state_from(state), ActingTorque(torque), (rows,), held_on)


def _refuse_other_shapes(scenario: Scenario, found: Mapping[str, FloatArray], where: str, mend: str) -> None:
    """Refuse a checkpoint whose arrays are not those that a run of this scenario writes."""
    start = _start(scenario)
    late = LateChannels.at_rest(scenario.plant, scenario.cascade.sample_time, dict.fromkeys(SERIES, 0.0))
    shapes = {
        "state": start.state.vector.shape,
        "torque": start.torque.state.shape,
        "late": late.vector.shape,
        "rows": (len(found["rows"]), len(_columns(scenario))),
    }
    same = all(found[name].dtype == np.float64 and found[name].shape == shape for name, shape in shapes.items())
    if not same or not np.isfinite(found["state"]).all() or found["state"][3] != start.state.vector[3]:
        raise InputError("is a checkpoint that was changed or damaged", where, mend)
