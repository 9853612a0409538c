"""Free play and the lost preload that it could be: one lag once the force has passed, by the spring law itself."""

from __future__ import annotations

import math

import numpy as np
import pytest

from feeddrive.diagnosis.certainty.imitations import imitations_of, lost_motion
from feeddrive.diagnosis.likelihood.coordinates import LEAST, at_its_limit, read_coordinates
from feeddrive.diagnosis.likelihood.set_evidence import log_volume
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.plant import Plant
from tests.analytic.test_transmission_spring import law
from tests.convergence.test_simulate import BENCH

PLAY = Backlash.of(width=4e-6)


def test_lost_preload_lags_as_free_play_does_beyond_its_force() -> None:
    plant = Plant("spring", BENCH)
    (soft,) = imitations_of(PLAY, plant)
    loose, softened = law(plant.with_effects(PLAY)), law(plant.with_effects(soft))
    for stretch in (-2e-5, -5e-6, 4e-6, 1e-5):  # the softened one has passed its force at 2.9 um
        # both are rounded where the slope changes, by a few per cent of a micrometre
        assert softened(stretch, 0.1)[0] == pytest.approx(loose(stretch, 0.1)[0], rel=0.02)
    assert abs(softened(1e-6, 0.1)[0]) > abs(loose(1e-6, 0.1)[0])  # inside the play only one of them pulls


def test_each_law_is_the_others_imitation() -> None:
    plant = Plant("spring", BENCH)
    (soft,) = imitations_of(PLAY, plant)
    (back,) = imitations_of(soft, plant)
    assert back.values["width"] == pytest.approx(PLAY.values["width"])


def test_other_effects_imitate_nothing() -> None:
    plant = Plant("spring", BENCH)
    assert imitations_of(ConstantForce.of(force=3.0), plant) == ()
    assert imitations_of(Backlash.of(width=0.0), plant) == ()
    assert imitations_of(PreloadLoss.of(ratio=1.0, force=5.0), plant) == ()


def test_spring_that_hardly_carries_around_no_force_is_a_free_play() -> None:
    least = LEAST["preload_loss", "ratio"]
    assert at_its_limit(PreloadLoss.of(ratio=least, force=5.0))
    assert not at_its_limit(PreloadLoss.of(ratio=2 * least, force=5.0))


@pytest.mark.parametrize("width", [5e-8, 5e-7, 5e-6, 5e-5])
def test_small_width_is_as_likely_in_one_law_as_in_the_other(width: float) -> None:
    """Data that tell the width to a hundredth and nothing of the ratio: only the prior of the ratio is between them."""
    plant, ratio = Plant("spring", BENCH), 0.3
    play = Backlash.of(width=width)
    (soft,) = imitations_of(play, plant)
    assert lost_motion(ratio, float(soft.values["force"]), plant) == pytest.approx(width)  # type: ignore[arg-type]
    size = Backlash.parameter("width").size
    known = (100 / width) ** 2  # information on the width, 1/m^2
    of_play = log_volume([play], plant, read_coordinates([play], plant), np.array([[known * size**2]]), 1.0)
    # the width goes with the force, one to one in logarithms; the ratio moves nothing here
    normal = np.array([[0.0, 0.0], [0.0, known * width**2]])
    of_soft = log_volume([soft], plant, read_coordinates([soft], plant), normal, 1.0)
    of_ratio = 0.5 * math.log(2 / math.pi) - math.log1p(math.log(ratio) ** 2)
    # a normal prior stands beside the data in the volume: half a ten-thousandth of the information
    assert of_soft - of_play == pytest.approx(of_ratio, abs=0.02)
