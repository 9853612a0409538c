"""An effect that is small on its machine is reported where the error of a channel shows it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from feeddrive.diagnosis.finding import refitting
from feeddrive.diagnosis.finding.attempt import Attempt
from feeddrive.diagnosis.finding.end_of_search import ended
from feeddrive.diagnosis.finding.materiality import LEAST_MASS_SHARE
from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.finding.too_small import with_what_matters
from feeddrive.diagnosis.friction_at_port import declared_level
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.likelihood.cross_validation import Comparison
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.effects.base import Port, number
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.torque_ripple import TorqueRipple
from tests.recovery.drawn import drawn
from tests.recovery.planted import axis_plant, pair


@pytest.mark.parametrize(("share", "finer", "reported"), [(0.5, 1.0, False), (0.5, 1e3, True), (2.0, 1.0, True)])
def test_a_part_that_shakes_is_reported_where_it_matters_or_is_seen(
    share: float, finer: float, reported: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At its resonance half of the least share of the table, below the noise of the bench, or twice that.

    The recordings are drawn from the motion itself: no encoder's error is in them, which would hide a thousandth.
    """
    monkeypatch.setattr(refitting, "beside_machine", lambda evidence, plant, plays: evidence)
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


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_a_ripple_too_small_to_matter_is_not_searched_on_with(share: float) -> None:
    """Half of the least share of the friction, or twice it, on a torque so quiet that either has its evidence."""
    plant = axis_plant("bench")
    usual = prepare(pair("bench", "null")[0], plant, 1.0)
    level = declared_level(plant, Port.SCREW) + plant.chain.radius * declared_level(plant, Port.TABLE)
    ripple = TorqueRipple.of(amplitude=share * LEAST_MASS_SHARE * level, order=8.0, phase=0.3)
    quiet = replace(usual, noise={**usual.noise, "motor_torque": 4.0 * number(ripple.values["amplitude"])})
    problem = Problem(plant, (drawn(plant, quiet, [ripple], 1),), AxisPredictor())
    found = search(problem)
    assert [effect.name for effect in found.fit.effects] == ["torque_ripple"] * (share > 1)
    tried = [one for one in found.rounds[0] if one.name == "torque_ripple"]
    assert [one.matters for one in tried] == [share > 1]
    assert max(one.comparison.gain for one in tried) > 0  # the recording shows both
    assert len(found.rounds) == (2 if share > 1 else 1)


def test_everything_that_was_tried_matters_where_much_is_left() -> None:
    plant = axis_plant("bench")
    usual = prepare(pair("bench", "null")[0], plant, 1.0)
    small = TorqueRipple.of(amplitude=1e-6, order=8.0, phase=0.3)
    for planted, matters in (([], False), ([ConstantForce.of(force=100.0)], True)):
        problem = Problem(plant, (drawn(plant, usual, planted, 1),), AxisPredictor())
        fitted = fit(problem, [small], iterations=0)
        attempt = Attempt(small.name, fitted, Comparison(0.0, 0.0, 0.0), problem, Comparison(0.0, 0.0, 0.0))
        kept = replace(attempt, fit=replace(fitted, coordinates=read_coordinates([small], plant)))
        (one,) = with_what_matters(problem, fit(problem, ()), [kept])
        assert one.matters == matters
