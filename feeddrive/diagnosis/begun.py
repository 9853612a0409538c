"""Recordings as they are before anything is searched in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.finding.search import Search
from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.suspicion.quality import Quality
from feeddrive.recording import Recording

Files = tuple[Sequence[Recording], Sequence[Recording]]
"""Recordings to fit and to judge on."""


@dataclass(frozen=True)
class Begun:
    """Recordings before anything was searched.

    Attributes:
        files: the recordings.
        problem: of those that are fitted.
        judged: what is judged on.
        notes: remarks about them.
        quality: what was mended of them.
        calibrated: the problem with its declared values fitted beside no effect, where that was asked for.
        searched: a search of that, where one was already made to its end.
    """

    files: Files
    problem: Problem
    judged: list[Evidence]
    notes: tuple[str, ...]
    quality: tuple[Quality, ...]
    calibrated: Problem | None = None
    searched: Search | None = None

    def ready(self) -> Begun:
        """The recordings with the declared values calibrated; as they are where what differs in several goes first."""
        return self if len(self.problem.evidence) > 1 else replace(self, calibrated=calibrated(self.problem))
