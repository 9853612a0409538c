"""A recording of motion and torque made ready for comparison: its channels in the band, their noise, what counts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence, from_zero, placed
from feeddrive.diagnosis.motion.band import END_CUT, Band, comparison_band, held, sensor_noise
from feeddrive.diagnosis.motion.encoder_error import MATERIAL, encoder_error
from feeddrive.diagnosis.motion.flank_rests import flank_rests
from feeddrive.diagnosis.motion.folded import folded_rows, folded_sentence
from feeddrive.diagnosis.motion.lead_map import lead_map
from feeddrive.diagnosis.motion.slow_rows import (
    is_slow,
    known_motion,
    missed_between_rows,
    refuse_unknown_motion,
    sentence,
    sentence_of_cycles,
)
from feeddrive.diagnosis.suspicion.channel_timing import lagging
from feeddrive.diagnosis.suspicion.flawed_rows import refuse_little_left, sound_rows, without_copied_position
from feeddrive.diagnosis.suspicion.torque_channel import with_torque
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.long.joined import clock, recorded
from feeddrive.simulate.driven import motor_motion
from feeddrive.typing import BoolArray, FloatArray

PREDICTED = ("motor_torque", "table_position")
"""Channels that are predicted from the measured motor motion."""

NO_SENSOR = 2.0**-32
"""Noise over the range of a channel below which no sensor made it: the finest encoders count 2^32 steps. A simulation
without noise is compared as far as its rows tell the motion between them."""

SHORTEST = 3.0
"""Shortest recording [s] that leaves something between the cut ends."""

LEAST_ZERO = 1e-4
"""Difference [m] of the zeros of table and motor that moves the nut: 0.1 mm of screw give way 0.5 nm per kilonewton."""

BLOCK = 0.5
"""Length of a block of cross-validation [s]: many correlation times of the band, and short against a stroke."""


def prepare(recording: Recording, plant: Plant, share: float, hold: float | None = None) -> AxisEvidence:
    """Evidence of a recording, its first `share` fitted and the rest judged, or what was kept apart of it for that.

    Args:
        recording: with a torque, a current or the table position beside the motor angle.
        plant: whose lead and band apply.
        share: 1 to fit on all of it, 0 to judge on all of it.
        hold: how long the drive holds a torque [s]; None for a whole row, and for no time where rows are slow.

    Raises:
        InputError: too short, or channels that are needed are missing.
    """
    recording = without_copied_position(_with_motor_angle(recording, plant), plant)
    recording, scaled_from = with_torque(recording, plant)
    names = _compared(recording)
    band = comparison_band(plant, 1 / recording.sample_time)
    acting = {name: _as_acting(name, recording, hold) for name in names}
    counted, recording = _counted(recording, plant, band, hold)
    noise = _noise(names, recording, plant, band, counted, bool(scaled_from))
    zero = _zero_of_angle(recording, plant)
    measured = {name: band.filter(series) for name, series in acting.items()}
    # what is judged is not to lend its torque to the motion that it is judged by
    telling = measured.get("motor_torque") if share > 0 else None
    encoder = encoder_error(placed(plant, zero), recording, band, noise, bool(scaled_from), telling)
    motion = encoder.motion if encoder is not None else motor_motion(from_zero(recording), recording["motor_angle"])
    has_scale = "table_position" in names
    rests, bouncing = flank_rests(recording, plant, band) or (None, None)
    return AxisEvidence(
        recording,
        measured,
        noise,
        counted,
        _fitted(recording, share),
        band.edge,
        BLOCK,
        band.thinning,
        ("table_position",) if has_scale else (),
        {s.channel: s.model_error for s in plant.sensors if s.model_error > 0 and s.channel in names},
        motion.timed(clock(recording)),
        band,
        scaled_from,
        zero,
        acting=acting.get("motor_torque") if not scaled_from else None,
        lead_map=band.filter(lead_map(recording["table_position"], plant.chain.radius)) if has_scale else None,
        rests=rests,
        bouncing=bouncing,
    ).with_encoder(encoder)


def _compared(recording: Recording) -> list[str]:
    """Channels of a recording that are predicted."""
    names = [name for name in PREDICTED if name in recording]
    if not names:
        mend = "record the motor torque or current, or the table position beside the motor angle"
        raise InputError("nothing that the motor's motion predicts", recording.name, mend)
    if recording.duration < SHORTEST:
        mend = f"record at least {SHORTEST:g} s"
        raise InputError(f"the recording lasts {recording.duration:.3g} s, too short to compare", recording.name, mend)
    return names


def _as_acting(name: str, recording: Recording, hold: float | None) -> FloatArray:
    """A channel, (n,), the motor torque as the drive holds it."""
    series = recording[name]
    if name != "motor_torque" or (hold is None and is_slow(recording)):
        return series
    return held(series) if hold is None else lagging(series, hold / 2, recording.sample_time)


def _counted(
    recording: Recording, plant: Plant, band: Band, hold: float | None
) -> tuple[BoolArray, Recording]:  # fmt: skip
    """Samples that count, (n,): sound, not at the ends, of known motion; and the recording with a note on that."""
    time = from_zero(recording)
    counted: BoolArray = (time >= END_CUT) & (time <= time[-1] - END_CUT)
    if is_slow(recording):
        known = known_motion(recording, plant, band)
        refuse_unknown_motion(known, counted, recording)
        recording = replace(recording, notes=(*recording.notes, sentence(known, recording)))
        counted &= known
    elif hold is not None:  # the loop is faster than the rows: what it does between them is not known either
        known = known_motion(recording, plant, band)
        refuse_unknown_motion(known, counted, recording)
        if not known.all():
            recording = replace(recording, notes=(*recording.notes, sentence_of_cycles(known, recording)))
        counted &= known
    else:
        folded = folded_rows(recording, plant, band)
        if folded.any():
            recording = replace(recording, notes=(*recording.notes, folded_sentence(folded, recording)))
        counted &= ~folded
    counted &= sound_rows(recording, plant.torque_limit, band)
    refuse_little_left(counted, recording)
    return counted, recording


def _noise(
    names: Sequence[str], recording: Recording, plant: Plant, band: Band, counted: BoolArray, is_scaled: bool
) -> dict[str, float]:
    """Channel to the rms of its sensor noise in the band."""
    own, noise = recorded(recording), {}
    for name in names:
        series = recording[name]
        if name == "motor_torque" and "injected_torque" in recording and not is_scaled:
            # the jumps of an injected binary sequence are no noise of the torque's sensor
            series = series - recording["injected_torque"]
        noise[name] = sensor_noise(series[own], band)
        if noise[name] < NO_SENSOR * float(np.ptp(series)):
            noise[name] = math.hypot(noise[name], missed_between_rows(recording, plant, counted).get(name, 0.0))
    return noise


def weighed_by(evidence: Evidence, plant: Plant, quieter: bool = False, plays: bool = False) -> Evidence:
    """The evidence with the encoder's error as a plant shows it: at its resonances, not at those of the declared one.

    Args:
        evidence: prepared for the declared plant.
        plant: nearer to the machine.
        quieter: whether the noise is less than that beside which it was asked before; where the error did not matter
            then it is asked again.
        plays: whether the load has a free play beside the springs of the plant (`encoder_error`).
    """
    if not isinstance(evidence, AxisEvidence) or evidence.scaled_from or not (evidence.gains or quieter):
        return evidence
    telling = evidence.measured.get("motor_torque") if evidence.fitted.any() else None
    there = evidence.placed(plant)
    return evidence.with_encoder(
        encoder_error(there, evidence.recording, evidence.band, evidence.noise, acting=telling, plays=plays)
    )


def beside_machine(evidence: Evidence, plant: Plant, plays: bool = False) -> Evidence:
    """The evidence with the encoder's error as a machine that effects have changed shows it; itself where it is alike.

    A mass and a spring that are other move a resonance, and a fine encoder that shows nothing at the declared one shows
    at the machine's: the damping is then drawn up by what its steps do there, and mass and stiffness with it.

    Args:
        evidence: weighed beside another machine.
        plant: the machine.
        plays: whether its load has a free play beside its springs.
    """
    there = weighed_by(evidence, plant, quieter=True, plays=plays)
    if not isinstance(there, AxisEvidence) or not isinstance(evidence, AxisEvidence) or not evidence.gains:
        return there
    moved = [np.max(np.abs(gain - evidence.gains[name])) for name, gain in there.gains.items()]
    return there if max(moved) > 0.5 * MATERIAL else evidence  # of a power the gain is the root


def _fitted(recording: Recording, share: float) -> BoolArray:
    """Samples that are fitted, (n,)."""
    if share >= 1 or share <= 0:
        return np.full(len(recording), share >= 1)
    if recording.kept_apart is not None:
        return ~recording.kept_apart
    time = np.arange(len(recording)) * recording.sample_time
    found: BoolArray = time < share * time[-1]
    return found


def _zero_of_angle(recording: Recording, plant: Plant) -> float:
    """Table position where the motor angle is zero [m], for a chain that depends on where the table stands.

    Raises:
        InputError: the nut would not be on the screw.
    """
    if not plant.chain.varies:
        return 0.0
    turned = plant.chain.motor_radius * recording["motor_angle"]
    measured = "table_position" in recording
    zero = float(np.median(recording["table_position"] - turned)) if measured else 0.0
    for position in (float(np.min(turned)) + zero, float(np.max(turned)) + zero):
        try:
            plant.chain.refuse_off_screw(position, recording.name)
        except InputError as error:
            mend = "record table_position, or shift motor_angle so that it is zero where the table is at 0"
            if measured:
                mend = "check zero and unit of table_position, and first_nut_position of the plant"
            raise InputError(error.what, recording.name, mend) from None
    return zero if abs(zero) > LEAST_ZERO else 0.0


def _with_motor_angle(recording: Recording, plant: Plant) -> Recording:
    """The recording with a motor angle: where there is no motor encoder, the table stands in for it."""
    if "motor_angle" in recording:
        return recording
    if "table_position" not in recording:
        raise InputError("neither motor_angle nor table_position", recording.name, "record one of them")
    if plant.chain.elastic:
        mend = 'record the motor angle, or declare the plant with structure = "rigid"'
        raise InputError("no channel motor_angle, and the plant is elastic", recording.name, mend)
    channels = dict(recording.channels)
    channels["motor_angle"] = channels.pop("table_position") / plant.chain.motor_radius
    note = "no motor encoder: the motor angle is taken from the table position"
    return replace(recording, channels=channels, notes=(*recording.notes, note))
