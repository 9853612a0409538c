"""What a diagnosis found: the plain records behind `diagnosis.json`, `prediction.csv` and the report."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.certainty.certainty_result import Ambiguity, Correlation, NextExperiment
from feeddrive.diagnosis.ledger.ledger_result import Kept
from feeddrive.diagnosis.numbers.number_rows import NumberResult
from feeddrive.diagnosis.recordings.change_result import RecordingChanges
from feeddrive.diagnosis.simulated.simulation_result import SimulationResult as SimulationResult
from feeddrive.diagnosis.suspicion.quality import Quality
from feeddrive.diagnosis.unexplained.unexplained_result import Dependence as Dependence
from feeddrive.diagnosis.unexplained.unexplained_result import Unexplained as Unexplained
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class ErrorFigures:
    """Error of one channel over the judged samples: rms and max in the channel's SI unit, relative without unit."""

    rms: float
    max: float
    relative: float


@dataclass(frozen=True)
class ChannelResult:
    """One predicted channel, judged on data that were not fitted.

    Attributes:
        name: canonical channel name.
        unit: SI unit of the channel.
        band_hz: pass band of the zero-phase filter, lower and upper edge [Hz].
        noise_rms: estimated sensor noise inside the band [unit].
        before: error of the declared plant.
        after: error with the found effects.
    """

    name: str
    unit: str
    band_hz: tuple[float, float]
    noise_rms: float
    before: ErrorFigures
    after: ErrorFigures


@dataclass(frozen=True)
class ParameterResult:
    """A fitted parameter: SI value (a number, or a list for a tabulated curve), unit and 95 % interval."""

    value: float | list[float] | str
    unit: str
    ci95: tuple[float, float] | list[tuple[float, float]] | None = None


@dataclass(frozen=True)
class EffectResult:
    """One effect that was found.

    Attributes:
        name: effect name of the catalogue.
        parameters: parameter key to value.
        explains: channel name to 1 - (rms with / rms without)^2 on the judged data, the other effects refitted.
        carries: whether it also lowers the error on the judged data.
        evidence: one or two sentences for a person: where it shows, how strongly.
        reading: the physical reading of its sign and size.
        odds: for it, against the sets of effects without it; None where they were not asked.
    """

    name: str
    parameters: dict[str, ParameterResult]
    explains: dict[str, float]
    carries: bool
    evidence: str
    reading: str = ""
    odds: float | None = None


def error_without(explains: float) -> float:
    """How many times larger the rms error is without an effect, from what it explains, 1 - (rms with / rms without)^2.

    Shares of effects that overlap do not add up, and 99.6 % and 99.96 % look alike; this factor tells them apart.

    Returns:
        sqrt(1 / (1 - explains)) [1]; infinite where nothing is left with the effect, NaN where no share is known.
    """
    if math.isnan(explains):
        return math.nan
    return math.inf if explains >= 1.0 else 1.0 / math.sqrt(1.0 - explains)


@dataclass(frozen=True)
class PossibleEffect:
    """A name that is not asserted, and not excluded either.

    Attributes:
        name: of the effect.
        odds: for it, 1 where nothing is known.
        instead_of: name of the effect taken whose place it would take; empty where it would come beside all.
        settles: what would settle it, for a person.
    """

    name: str
    odds: float
    instead_of: str
    settles: str


@dataclass(frozen=True)
class RefusedEffect:
    """A candidate that was not taken, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class ChannelSeries:
    """Band-limited series of one channel over one judged recording; left-out samples are NaN. Arrays: shape (n,)."""

    name: str
    unit: str
    measured: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True)
class JudgedRecording:
    """The series that the figures and `prediction.csv` come from.

    Attributes:
        name: file name of the recording.
        time: sample times [s], shape (n,).
        channels: one series per predicted channel.
        variables: signals a residual is plotted against, SI: `table_velocity`, `table_position`, `motor_angle`.
    """

    name: str
    time: FloatArray
    channels: tuple[ChannelSeries, ...]
    variables: dict[str, FloatArray] = field(default_factory=dict)


@dataclass(frozen=True)
class FileStamp:
    """A file that took part, with its SHA-256, so that the result can be reproduced."""

    file: str
    sha256: str


@dataclass(frozen=True)
class Trial:
    """One candidate in one round of the search, for the table of what was tried.

    Attributes:
        round: 1 for the first effect searched.
        name: effect name.
        gain: share by which it lowers the cross-validated, noise-weighted squared error.
        standard_error: of the gain, from the blocks.
        taken: whether it was the one taken in this round.
    """

    round: int
    name: str
    gain: float
    standard_error: float
    taken: bool


_ROOM = 0.02
"""m: a shorter stroke was no stroke but a test about a point."""


@dataclass(frozen=True)
class Diagnosis:
    """Everything `feeddrive diagnose` has to say."""

    plant: str
    fit: tuple[FileStamp, ...]
    validate: tuple[FileStamp, ...]
    channels: tuple[ChannelResult, ...]
    effects: tuple[EffectResult, ...]
    refused: tuple[RefusedEffect, ...]
    ambiguous: tuple[tuple[str, ...], ...]
    rehomed: tuple[str, ...]
    unexplained: dict[str, Unexplained]
    trials: tuple[Trial, ...]
    recordings: tuple[JudgedRecording, ...]
    simulation: SimulationResult | None = None
    notes: tuple[str, ...] = ()
    correlation: Correlation | None = None
    alike: tuple[Ambiguity, ...] = ()
    next_experiments: tuple[NextExperiment, ...] = ()
    changes: RecordingChanges = field(default_factory=RecordingChanges)
    kept: Kept = field(default_factory=Kept)
    calibrated: tuple[CalibratedResult, ...] = ()
    possible: tuple[PossibleEffect, ...] = ()
    measured: tuple[NumberResult, ...] = ()
    quality: tuple[Quality, ...] = ()
    untried: str = ""
    fitted_stroke: tuple[float, float] | None = None

    @property
    def nothing_missing(self) -> bool:
        """True when the declared plant is enough as it is, or all that is known of it."""
        differs = any(change.fitted for change in self.changes.changes)
        tables = any(left.carried for left in self.unexplained.values())
        return not (self.effects or differs or tables or self.calibrated)

    @property
    def recorded_stroke(self) -> tuple[float, float] | None:
        """The range of the table position in the fitted and the judged recordings [m]; None where that is no stroke."""
        found = [one.variables["table_position"] for one in self.recordings if "table_position" in one.variables]
        found += [np.array(self.fitted_stroke)] if self.fitted_stroke is not None else []
        known = np.concatenate([one[np.isfinite(one)] for one in found]) if found else np.empty(0)
        if not known.size or np.ptp(known) <= _ROOM:
            return None
        return float(known.min()), float(known.max())


def error_figures(error: FloatArray, reference_rms: float) -> ErrorFigures:
    """Rms, maximum and relative size of an error series; NaN samples are left out.

    Args:
        error: shape (n,), SI unit of the channel.
        reference_rms: rms that the relative error refers to, same unit.

    Returns:
        The three figures.
    """
    kept = error[np.isfinite(error)]
    rms = float(np.sqrt(np.mean(kept**2)))
    return ErrorFigures(rms=rms, max=float(np.max(np.abs(kept))), relative=rms / reference_rms)
