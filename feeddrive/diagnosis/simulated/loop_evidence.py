"""A recording made ready for closed-loop simulation: the declared loop, where it starts, and which samples count.

The declared controller is first fed the recorded set-point and motion. Where it does not command what was recorded,
something else had a part in the torque (a test signal that no channel holds), and no simulation can know it: blocks of
time in which it misses more than a quarter of the torque's rms are left out, with their neighbours, as what is excited
rings on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.band import white_noise
from feeddrive.diagnosis.suspicion.channel_timing import lagging
from feeddrive.effects.timing.channel_delay import lateness
from feeddrive.engine.lateness import late_mean
from feeddrive.engine.step.linear_part import SimulationError
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.simulate.controlled.declared_loop import DeclaredLoop, declared_loop, replayed_command
from feeddrive.typing import BoolArray, FloatArray

MISSED = 0.25
"""Share of the torque's rms in a block that the declared controller may miss when it is fed the recorded motion."""

QUIET = 0.1
"""Share of the recording's rms torque below which a block's own rms says nothing."""

LEAST_SHARE = 0.2
"""Share of the samples that must be the declared controller's, for it to be taken for the recorded one."""

SIMULATED = ("motor_torque", "table_position")
"""Channels that are simulated, where they were recorded."""


@dataclass(frozen=True)
class LoopEvidence:
    """One recording under its declared controller.

    Attributes:
        evidence: which samples are fitted and which are judged.
        loop: the declared one.
        reference: what it is fed, shape (n ticks, references).
        commanded: samples in which the declared controller alone made the torque, shape (n,).
        position, velocity: of the table at the start, counted from the motor angle's zero [m, m/s].
    """

    evidence: AxisEvidence
    loop: DeclaredLoop
    reference: FloatArray
    commanded: BoolArray
    position: float
    velocity: float

    @property
    def recording(self) -> Recording:
        """What was recorded."""
        return self.evidence.recording

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that are simulated and were recorded."""
        return tuple(name for name in SIMULATED if name in self.recording)

    @property
    def fit_rows(self) -> BoolArray:
        """Samples on which values are fitted."""
        return self.evidence.fit_rows & self.commanded

    @property
    def judged_rows(self) -> BoolArray:
        """Samples that are judged."""
        return self.evidence.judged_rows & self.commanded

    def simulated(self, plant: Plant) -> dict[str, FloatArray]:
        """Channel to its simulated series, shape (n,), SI; NaN where the plant cannot be followed."""
        try:
            run = self.loop.simulated(plant, self.reference, self.position, self.velocity)
        except SimulationError:
            nothing = np.full(len(self.recording), np.nan)
            return dict.fromkeys(self.channels, nothing)
        every = slice(None, None, self.loop.ticks)
        found = {"motor_torque": self.loop.recorded_torque(run.command), "table_position": run.table_position[every]}
        step, late = self.recording.sample_time, {name: lateness(plant.effects, name) for name in SIMULATED}
        found["motor_torque"] = late_mean(found["motor_torque"], step, late["motor_torque"])
        found["table_position"] = lagging(found["table_position"], late["table_position"], step)
        return {name: found[name] for name in self.channels}

    def missed(self, series: dict[str, FloatArray], rows: BoolArray) -> dict[str, FloatArray]:
        """Channel to recorded less simulated at some samples, the zero of a linear scale taken out."""
        errors = {name: (self.recording[name] - series[name])[rows] for name in self.channels}
        return {name: e - e.mean() if name in self.evidence.floating else e for name, e in errors.items()}


def refuse_unfit_loop(plant: Plant, recordings: Sequence[Recording]) -> None:
    """Refuse a declared controller that does not fit a recording, before anything is computed.

    Raises:
        InputError: as `declared_loop`.
    """
    for recording in recordings:
        declared_loop(plant, recording.sample_time)


def loop_evidence(plant: Plant, evidence: Evidence) -> LoopEvidence:
    """The recording under the declared controller.

    Args:
        plant: as declared.
        evidence: of a recording of the axis.

    Raises:
        InputError: no controller, no set-point, or a controller that is not the recorded one; the text is a reason.
    """
    recording = evidence.recording
    loop = declared_loop(plant, recording.sample_time)
    if loop is None:
        raise InputError("the plant file declares no controller", plant.name, "add a [controller] table")
    for needed in ("setpoint", "motor_torque"):
        if needed not in recording:
            raise InputError(f"the recording has no {needed}", recording.name, "record it")
    assert isinstance(evidence, AxisEvidence)
    commanded = _commanded(plant, loop, evidence)
    if commanded.sum() < LEAST_SHARE * evidence.counted.sum():
        what = "the declared controller, fed with the recorded motion, does not command the recorded torque"
        mend = "check its gains, rates and feed-forward; record a test signal as injected_torque or injected_speed"
        raise InputError(what, recording.name, mend)
    r = plant.chain.motor_radius
    position, velocity = (r * float(series[0]) for series in (evidence.motion.angle, evidence.motion.speed))
    # a loop closed at the table has the scale's zero; everything here counts from the motor angle's
    scale = not loop.at_motor and "table_position" in recording
    offset = float(recording["table_position"][0]) - position if scale else 0.0
    reference = loop.reference(recording["setpoint"] - offset, recording.channels)
    return LoopEvidence(evidence, loop, reference, commanded, position, velocity)


def _commanded(plant: Plant, loop: DeclaredLoop, evidence: AxisEvidence) -> BoolArray:
    """Samples in blocks, and neighbours of blocks, whose torque the declared controller makes."""
    torque = evidence.recording["motor_torque"]
    missed = torque - replayed_command(plant, loop, evidence.recording)
    # of what is missed, as a test signal in the torque is no noise
    noise = white_noise(missed, 1 / evidence.recording.sample_time)
    block = (np.arange(len(torque)) * evidence.recording.sample_time / evidence.block).astype(int)
    count = np.bincount(block)
    # an integrator's unknown start leaves an offset, which says nothing
    mean = (np.bincount(block, weights=missed) / count)[block]
    spread = np.bincount(block, weights=(missed - mean) ** 2) / count - noise**2
    power = np.maximum(np.bincount(block, weights=torque**2) / count, QUIET**2 * np.mean(torque**2))
    other = ~(spread <= MISSED**2 * power)
    near = other.copy()
    near[1:] |= other[:-1]
    near[:-1] |= other[1:]
    commanded: BoolArray = ~near[block]
    return commanded
