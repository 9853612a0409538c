"""Declared values and effects at rest: where they began does not matter, and no step leads on."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.calibrate import calibrated
from feeddrive.diagnosis.finding.refitting import at_rest, cost, stepped_together
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.effects.source.torque_ripple import TorqueRipple
from tests.recovery.rigid_runs import Truth
from tests.recovery.test_value_asked_once import begun


@pytest.mark.parametrize("away", [-3.0, 3.0])
def test_values_that_begin_elsewhere_come_to_the_same_rest(tmp_path: Path, away: float) -> None:
    near = calibrated(begun(tmp_path, Truth(coulomb=1.2)))
    ripple = TorqueRipple.of(amplitude=1e-5, order=3.7, phase=0.4)
    assert near.calibration is not None
    variance = near.calibration.variance
    far = near.at_values(near.calibration.coordinates + away)
    begin, rest = [at_rest(one, fit(one, (ripple,))) for one in (near, far)]
    unmoved = cost(far, fit(far, (ripple,)), variance)
    # each ends where a step takes less than half a nat: a variance of the doubled cost
    assert abs(cost(*rest, variance) - cost(*begin, variance)) < 2 * variance
    assert unmoved > cost(*rest, variance) + 100 * variance
    again = stepped_together(*rest)
    assert cost(*rest, variance) - cost(*again, variance) < variance
