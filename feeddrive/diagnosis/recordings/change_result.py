"""What changed between recordings: the records behind the report, and their keys in `diagnosis.json`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Measure:
    """A number and the half width of its 95 % interval, SI."""

    value: float
    half: float

    @property
    def ci95(self) -> tuple[float, float]:
        """The interval."""
        return self.value - self.half, self.value + self.half

    def record(self, prefix: str = "") -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        return {f"{prefix}value": self.value, f"{prefix}ci95": list(self.ci95)}


@dataclass(frozen=True)
class ParameterChange:
    """One parameter that is other in one recording than in another.

    Attributes:
        effect: name of the effect, `friction_deviation` for a level of declared friction.
        parameter: its key.
        port: where it acts.
        recording: where it is other.
        unit: SI unit.
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
    port: str
    recording: str
    unit: str
    here: Measure
    against: str
    there: Measure
    difference: Measure
    statement: str
    reading: str
    fitted: bool

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        return {
            "effect": self.effect, "parameter": self.parameter, "port": self.port, "recording": self.recording,
            "unit": self.unit, **self.here.record(), "against": self.against, **self.there.record("against_"),
            "difference": self.difference.value, "difference_ci95": list(self.difference.ci95),
            "statement": self.statement, "reading": self.reading, "fitted": self.fitted,
        }  # fmt: skip


@dataclass(frozen=True)
class PerRecording:
    """A parameter with a value of its own in every fitted recording: recording name to value."""

    effect: str
    parameter: str
    port: str
    unit: str
    values: dict[str, Measure]

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        values = [{"recording": name, **value.record()} for name, value in self.values.items()]
        return {**vars(self), "values": values}


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

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`."""
        return {
            "effect": self.effect, "parameter": self.parameter, "port": self.port,
            "of": "judged recordings" if self.judged else "fitted recordings", "gain": self.gain,
            "standard_error": self.standard_error, "taken": self.taken, "reason": self.reason,
        }  # fmt: skip


@dataclass(frozen=True)
class RecordingChanges:
    """All that is known of differences between the recordings of one diagnosis."""

    changes: tuple[ParameterChange, ...] = ()
    per_recording: tuple[PerRecording, ...] = ()
    shared: tuple[str, ...] = ()
    trials: tuple[CommonTrial, ...] = ()
    explains: dict[str, float] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """Its keys in `diagnosis.json`; `changes` is empty where nothing differs, or where there is one recording."""
        return {
            "changes": [one.record() for one in self.changes],
            "per_recording": [one.record() for one in self.per_recording],
            "shared": list(self.shared),
            "changes_tried": [one.record() for one in self.trials],
            "changes_explain": self.explains,
        }
