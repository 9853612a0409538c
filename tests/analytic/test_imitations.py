"""Free play and the lost preload that it could be: one lag once the force has passed, by the spring law itself."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.certainty.imitations import imitations_of
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.plant.plant import Plant
from tests.analytic.test_transmission_spring import law
from tests.convergence.test_simulate import BENCH

PLAY = Backlash.of(width=4e-6)


def test_lost_preload_lags_as_free_play_does_beyond_its_force() -> None:
    plant = Plant("spring", BENCH)
    (soft,) = imitations_of(PLAY, plant)
    loose, softened = law(plant.with_effects(PLAY)), law(plant.with_effects(soft))
    for stretch in (-2e-5, -5e-6, 4e-6, 1e-5):  # the softened one has passed its force at 2.2 um
        # both are rounded where the slope changes, by a few per cent of a micrometre
        assert softened(stretch, 0.1)[0] == pytest.approx(loose(stretch, 0.1)[0], rel=0.02)
    assert abs(softened(1e-6, 0.1)[0]) > abs(loose(1e-6, 0.1)[0])  # inside the play only one of them pulls


def test_other_effects_imitate_nothing() -> None:
    plant = Plant("spring", BENCH)
    assert imitations_of(ConstantForce.of(force=3.0), plant) == ()
    assert imitations_of(Backlash.of(width=0.0), plant) == ()
