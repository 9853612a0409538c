"""What changed between recordings: the records behind `changes`, `shared` and `per_recording` of `diagnosis.json`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Measure:
    """A number with its 95 % interval, SI."""

    value: float
    ci95: tuple[float, float]


@dataclass(frozen=True)
class ParameterChange:
    """One parameter that is other in one recording than in another.

    Attributes:
        effect: name of the effect, `friction_deviation` for a level of declared friction.
        parameter: its key.
        unit: SI unit.
        port: where it acts.
        recording: where it is other.
        here: value there.
        against: recording (or "the fitted recordings") that it is compared with.
        there: value in that one.
        difference: of the first from the second.
        statement: the same in words.
        reading: what such a change means on a machine.
        fitted: whether the recording was fitted; otherwise the change is stated, and no error was lowered by it.
    """

    effect: str
    parameter: str
    unit: str
    port: str
    recording: str
    here: Measure
    against: str
    there: Measure
    difference: Measure
    statement: str
    reading: str
    fitted: bool


@dataclass(frozen=True)
class PerRecording:
    """A parameter with a value of its own in every fitted recording: recording name to value."""

    effect: str
    parameter: str
    unit: str
    port: str
    values: dict[str, Measure]


@dataclass(frozen=True)
class CommonTrial:
    """A parameter that was tried with a value of its own in every recording, and what came of it.

    Attributes:
        effect: name.
        parameter: number of its coordinate in words.
        port: where it acts.
        gain: share of the squared error on blocks left out.
        standard_error: of the gain.
        taken: whether it differs.
        reason: why, or why not.
        judged: whether it was asked of a recording that was not fitted.
    """

    effect: str
    parameter: str
    port: str
    gain: float
    standard_error: float
    taken: bool
    reason: str
    judged: bool = False


@dataclass(frozen=True)
class RecordingChanges:
    """All that is known of differences between the recordings of one diagnosis."""

    changes: tuple[ParameterChange, ...] = ()
    per_recording: tuple[PerRecording, ...] = ()
    shared: tuple[str, ...] = ()
    trials: tuple[CommonTrial, ...] = ()
    explains: dict[str, float] | None = None
