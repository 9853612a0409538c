"""Effects found earlier are asked again on the samples that they are fitted to with all recordings."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from feeddrive.diagnosis.recordings import recordings_search
from feeddrive.diagnosis.recordings.changes import Changes


class AskedError(Exception):
    """The question that the test is about was put."""


def test_effects_are_asked_on_the_samples_that_what_differs_left_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """A free play that is another in one recording predicts other samples of it: residuals differ in length."""
    before: Any = SimpleNamespace(evidence=(1, 2))
    after: Any = SimpleNamespace(evidence=(1, 2))
    found: Any = SimpleNamespace(effects=())
    asked: list[Any] = []

    def put(problem: Any, fit: Any) -> None:
        asked.append(problem)
        raise AskedError

    monkeypatch.setattr(recordings_search, "with_predictable", lambda problem, effects: problem)
    monkeypatch.setattr(recordings_search, "fit", lambda problem, effects: found)
    monkeypatch.setattr(recordings_search, "find_changes", lambda *_: Changes(after, found, (), ()))
    monkeypatch.setattr(recordings_search, "_still_needed", put)
    with pytest.raises(AskedError):
        recordings_search._continued(before, (), lambda _: None)
    assert asked[0] is after
