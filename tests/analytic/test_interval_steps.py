"""The ends of an interval of a declared value are met in few steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.calibration import known as of_known
from feeddrive.diagnosis.calibration.known import NORMAL_95
from tests.analytic.test_known_values import known


def test_ends_of_an_interval_are_met_in_few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no other value comes to an end chi² is one parabola; its root is straight, and met by the first secant."""
    count, least = [], of_known._least
    told = replace(known(1.0), slopes=np.diag([40.0, 30.0]), right_side=np.array([8.0, -3.0]))
    monkeypatch.setattr(of_known, "_least", lambda *given: count.append(1) or least(*given))
    low, high = told.interval(0)
    assert [told.u(0, end) for end in (low, high)] == pytest.approx([0.2 - NORMAL_95 / 40, 0.2 + NORMAL_95 / 40])
    assert len(count) <= 10  # the least, none, and for either end: beyond it, and what a secant search ends with
