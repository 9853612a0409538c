"""The generator's conservative effects keep the energy, alone and together."""

from __future__ import annotations

import numpy as np
import pytest

from tests.analytic.frictionless import FRICTIONLESS, energy, moving, run
from tests.generator.effects import (
    Backlash,
    Effect,
    LeadErrorCumulative,
    LeadErrorPeriodic,
    PlantedEffects,
    PositionSpring,
    PreloadLoss,
    StiffnessDeviation,
    StiffnessVsPosition,
    StructuralMode,
)

SPRING = PositionSpring(stiffness=2e5, zero=0.13)
LEADS = (LeadErrorPeriodic(20e-6, 3.0, 0.4), LeadErrorCumulative(2e-3))
ALONG = StiffnessVsPosition(share_over_stroke=0.7)
PRELOAD = PreloadLoss(ratio=0.3, force=1500.0)
MODE = StructuralMode(mass=30.0, frequency=90.0, damping=0.0)

CASES: dict[str, tuple[Effect, ...]] = {
    "nothing": (),
    "spring": (SPRING,),
    "leads": LEADS,
    "along": (ALONG,),
    "preload": (PRELOAD,),
    "preload and along": (PRELOAD, ALONG),
    "mode": (MODE,),
    "gap": (Backlash(width=30e-6),),
    "together": (SPRING, *LEADS, ALONG, PRELOAD, MODE, StiffnessDeviation(0.6), Backlash(width=30e-6)),
}


@pytest.mark.parametrize("case", CASES)
def test_energy_is_kept(case: str) -> None:
    """Over 0.2 s, in which table and motor swing against each other by some 100 µm while they travel 20 mm."""
    constants = PlantedEffects(CASES[case]).planted(FRICTIONLESS)
    start = moving(0.1, constants)._replace(velocity=0.2)
    states = run(constants, start, 0.0, 0.2)
    total = energy(states, constants)
    assert np.ptp(states[:, 4]) > 5e-3, "the table must travel"
    # Below 2e-7 but where the preload's kink lies inside a step: some hundred passages cost 1.7e-6.
    assert np.max(np.abs(total / total[0] - 1.0)) < 5e-6


def test_a_missing_force_on_the_table_would_show() -> None:
    """The force -k'(x) e^2 / 2 of a stiffness along the stroke is worth far more than what the test above allows."""
    constants = PlantedEffects((ALONG,)).planted(FRICTIONLESS)
    states = run(constants, moving(0.1, constants)._replace(velocity=0.2), 0.0, 0.2)
    e = constants.transmission * states[:, 2] - states[:, 4]
    length = constants.stroke_high - constants.stroke_low
    softer = ALONG.share_over_stroke / (1.0 - ALONG.share_over_stroke)
    along = (states[:, 4] - constants.stroke_low) / length
    slope = softer * constants.axial_stiffness / length / (1.0 + softer * along) ** 2
    work = np.trapezoid(0.5 * slope * e**2, states[:, 4])
    assert work / energy(states, constants)[0] > 1e-4
