"""Recordings made ready for the plant that they are of: motion and torque, or temperatures and growth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum

import numpy as np

from feeddrive.diagnosis.heat.heat_evidence import left_out_channels, prepare_heat, within_range
from feeddrive.diagnosis.heat.heat_prediction import heat_predictor
from feeddrive.diagnosis.heat.warm import is_warm_log, prepare_warm, warm_predictor
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.motion.between_rows import with_open_rows
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.motion.row_steps import in_longest_steps
from feeddrive.diagnosis.motion.slow_rows import is_slow
from feeddrive.diagnosis.motion.torque_steps import with_open_steps
from feeddrive.diagnosis.suspicion.motor_jumps import refuse_motor_jumps
from feeddrive.diagnosis.suspicion.torque_channel import refuse_what_is_no_torque
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording, check_against_lead, check_against_stroke, without_unfollowed_setpoint
from feeddrive.recording.checks.copies import refuse_copied_setpoint
from feeddrive.recording.long.joined import shortened


class Shown(Enum):
    """What recordings show of a machine."""

    MOTION = "motion and torque, sample by sample"
    HEAT = "temperatures and growth"
    BOTH = "motion, torque and temperatures over hours"


def shown(plant: Plant, recordings: Sequence[Recording]) -> Shown:
    """What recordings show of a plant: its motion, its heat, or both where a log of hours holds both."""
    if not plant.has_motion:
        return Shown.HEAT
    if not plant.has_heat:
        return Shown.MOTION
    if all("screw_speed" in one and "motor_torque" not in one for one in recordings):
        return Shown.HEAT
    logs = plant.joint is not None and all(is_slow(one) and is_warm_log(one, plant.heat) for one in recordings)
    return Shown.BOTH if logs else Shown.MOTION


Prepared = tuple[Problem, list[Evidence], tuple[str, ...]]
"""The problem, what is judged, and remarks."""


def informative(plant: Plant, recordings: Sequence[Recording], split: float = 1.0) -> tuple[Recording, ...]:
    """The recordings; of long ones of motion what is informative, with what they say as a whole as notes.

    Args:
        plant: as declared.
        recordings: as read, or as this function gave them.
        split: share of what is kept of a long one that is fitted.
    """
    if shown(plant, recordings) is not Shown.MOTION:
        return tuple(recordings)
    return tuple(shortened(one, plant.chain.motor_radius, split) for one in recordings)


def prepared(
    plant: Plant,
    recordings: Sequence[Recording],
    validation: Sequence[Recording],
    split: float,
    hold: float | None = None,
) -> Prepared:
    """The problem, and what it is judged on.

    Args:
        plant: as declared.
        recordings: fitted; without `validation` their last part is judged.
        validation: judged only.
        split: share that is fitted where there is no `validation`.
        hold: how long the drive holds a torque [s]; None for a whole row.

    Raises:
        InputError: recordings that cannot be used with this plant.
    """
    what = shown(plant, recordings)
    if what is Shown.HEAT:
        return _prepared_heat(plant, recordings, validation, split)
    if what is Shown.BOTH:
        warm = tuple(prepare_warm(recording, plant, 1.0 if validation else split) for recording in recordings)
        return (
            Problem(plant, warm, warm_predictor(plant)),
            [*(prepare_warm(recording, plant, 0.0) for recording in validation)] or [*warm],
            (),
        )
    lead = 2 * np.pi * plant.chain.motor_radius
    for recording in (*recordings, *validation):
        _refuse_heat(recording)
        refuse_copied_setpoint(recording)
        check_against_lead(recording, lead, recording.name)
        check_against_stroke(recording, lead, plant.stroke, recording.name)
        refuse_motor_jumps(recording, plant)
    recordings, validation = (
        [without_unfollowed_setpoint(one, lead) for one in ones] for ones in (recordings, validation)
    )
    fitted = tuple(prepare(recording, plant, 1.0 if validation else split, hold) for recording in recordings)
    judged: list[Evidence] = [prepare(recording, plant, 0.0, hold) for recording in validation] or list(fitted)
    return _scaled(plant, fitted, judged)


def _scaled(plant: Plant, fitted: tuple[AxisEvidence, ...], judged: list[Evidence]) -> Prepared:
    """The recordings with a torque of unknown scale brought to that of the declared plant."""
    unknown = tuple(evidence for evidence in fitted if evidence.scaled_from)
    if not unknown:
        for evidence in judged:
            if isinstance(evidence, AxisEvidence) and evidence.scaled_from and any(map(_has_torque, fitted)):
                what = f"only {evidence.scaled_from}, and what is fitted has a torque"
                raise InputError(what, evidence.recording.name, "declare torque_constant in [motor] of the plant")
        predictor = AxisPredictor()
        fitted, judged = _in_steps(plant, predictor, fitted, judged)
        return Problem(plant, fitted, predictor), judged, ()
    predictor = AxisPredictor(unknown)
    scale = 1 / predictor.scale(plant)
    for one in unknown:
        predicted = predictor.predict(plant, replace(one, scaled_from=""))["motor_torque"]
        refuse_what_is_no_torque(one.scaled_from, one.measured["motor_torque"], predicted, one.recording.name)
    known = {one: one.with_scale(scale) if one.scaled_from else one for one in fitted}
    others = [_known(one, known, scale) for one in judged]
    inside = tuple(known[one] for one in fitted)
    predictor = AxisPredictor(tuple(one for one in inside if one.scaled_from), scale)
    inside, others = _in_steps(plant, predictor, inside, others)
    return Problem(plant, inside, predictor), others, ()


def _in_steps(
    plant: Plant, predictor: AxisPredictor, fitted: Sequence[AxisEvidence], judged: Sequence[Evidence]
) -> tuple[tuple[AxisEvidence, ...], list[Evidence]]:
    """Recordings in the longest steps of the driven simulation; one that is fitted and judged stays one."""
    asked = dict.fromkeys([*fitted, *(one for one in judged if isinstance(one, AxisEvidence))])
    ready = {}
    for one in asked:
        stepped = with_open_rows(in_longest_steps(one, plant, predictor), plant, predictor)
        ready[one] = with_open_steps(stepped, plant, predictor)
    others = [ready[one] if isinstance(one, AxisEvidence) else one for one in judged]
    return tuple(ready[one] for one in fitted), others


def _has_torque(evidence: AxisEvidence) -> bool:
    return "motor_torque" in evidence.channels and not evidence.scaled_from


def _known(evidence: Evidence, known: Mapping[AxisEvidence, AxisEvidence], scale: float) -> Evidence:
    if not isinstance(evidence, AxisEvidence):
        return evidence
    if evidence in known:
        return known[evidence]
    return evidence.with_scale(scale) if evidence.scaled_from else evidence


def _prepared_heat(
    plant: Plant, recordings: Sequence[Recording], validation: Sequence[Recording], split: float
) -> Prepared:
    fitted = tuple(prepare_heat(recording, plant.heat, 1.0 if validation else split) for recording in recordings)
    others = [prepare_heat(recording, plant.heat, 0.0) for recording in validation]
    wide, raised = within_range(plant, (*fitted, *others))
    lost = [
        f"{r.name}: {c} is not predicted" for r in (*recordings, *validation) for c in left_out_channels(r, plant.heat)
    ]
    judged: list[Evidence] = [*others] or [*fitted]
    return Problem(wide, fitted, heat_predictor(wide)), judged, (*raised, *lost)


def _refuse_heat(recording: Recording) -> None:
    moving = any(name in recording for name in ("motor_torque", "motor_current", "motor_angle", "table_position"))
    if not moving and "screw_speed" in recording:
        mend = "name a plant that declares heat alone, such as thermal_bench"
        raise InputError("a recording of temperatures, and the plant declares motion", recording.name, mend)
