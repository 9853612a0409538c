"""An effect that is small on its machine is reported where the error of a channel shows it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from feeddrive.diagnosis.finding.end_of_search import ended
from feeddrive.diagnosis.finding.materiality import LEAST_MASS_SHARE
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.chain.structural_mode import StructuralMode
from tests.recovery.drawn import drawn
from tests.recovery.planted import axis_plant, pair


@pytest.mark.parametrize(("share", "finer", "reported"), [(0.5, 1.0, False), (0.5, 1e3, True), (2.0, 1.0, True)])
def test_a_part_that_shakes_is_reported_where_it_matters_or_is_seen(share: float, finer: float, reported: bool) -> None:
    """At its resonance half of the least share of the table, below the noise of the bench, or twice that."""
    plant = axis_plant("bench")
    usual = prepare(pair("bench", "null")[0], plant, 1.0)
    fine = replace(usual, noise={name: noise / finer for name, noise in usual.noise.items()})
    damping = 0.012
    mass = share * LEAST_MASS_SHARE * plant.chain.values["table_mass"] * 2 * damping
    mode = StructuralMode.of(mass=mass, frequency=57.0, damping=damping)
    problem = Problem(plant, (drawn(plant, fine, [mode], 1),), AxisPredictor())
    _, _, found, small = ended(problem, fit(problem, [mode]))
    assert [one.name for one in found.effects] == [mode.name] * reported
    assert [one.name for one in small] == [mode.name] * (not reported)
