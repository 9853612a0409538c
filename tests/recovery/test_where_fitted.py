"""A law is asked for on data not fitted where its variable is as it was fitted: beyond, its form is a guess."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.diagnosis.certainty.uncertainty import certainty, certainty_along
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.asked_of_fit import sizes_around_none
from feeddrive.diagnosis.judging.judge import Judged, prepared_for_judging
from feeddrive.diagnosis.judging.where_fitted import share_where_fitted, where_fitted
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect
from feeddrive.effects.friction.friction_vs_position import FrictionVsPosition
from feeddrive.effects.friction.viscous_asymmetry import ViscousAsymmetry
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.source.position_spring import PositionSpring
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from tests.recovery.rigid_runs import COULOMB, LEAD, PLANT, Truth, rigid_run

R = LEAD / (2 * math.pi)
STIFFNESS, REACH = 80.0, 0.1
"""A spring that saturates: the strokes that are fitted end at 0.092 m, before it does."""


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The declared rigid axis."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    return read_plant(path)


def sprung(name: str, offset: float = 0.0, seed: int = 1) -> Recording:
    """A recording of strokes about an offset [m], with the spring."""
    run = rigid_run(name, Truth(seed=seed))
    position = R * run["motor_angle"] + offset
    force = STIFFNESS * np.clip(position, -REACH, REACH)
    return run.with_channels({"motor_torque": run["motor_torque"] + R * force, "motor_angle": position / R})


def judged_with(
    plant: Plant, law: Effect, recordings: list[Recording], fitted_run: Recording
) -> tuple[Problem, Fit, list[Judged]]:
    """The problem with a law fitted to one run, and others judged."""
    problem, kept, _ = prepared(plant, [fitted_run], recordings, 1.0)
    found = fit(problem, [law])
    after = plant.with_effects(*found.effects)
    return problem, found, [prepared_for_judging(problem, one, plant, after) for one in kept]


def test_strokes_elsewhere_say_nothing_of_a_spring(rigid: Plant) -> None:
    far = sprung("far", 0.5, 2)
    problem, found, judged = judged_with(rigid, PositionSpring.of(stiffness=50.0, zero=0.0), [far], sprung("near"))
    assert where_fitted(problem, found.effects, judged, found.effects[0]) == []
    share = share_where_fitted(problem, found, judged, 0)
    # what it does to the error is told, and no one says that it fails
    assert share.explains["motor_torque"] < -1.0
    assert not share.carries and not share.shows and share.size == 0.0


@pytest.mark.parametrize("offset", [0.5, 0.15])
def test_a_table_takes_no_place_for_what_it_goes_on_as(offset: float, rigid: Plant) -> None:
    """Beyond the strokes that are fitted the table of the force stays level, as this spring does there.

    The other strokes are apart from them, or overlap.
    """
    found, _ = diagnose(rigid, [sprung("near")], [sprung("far", offset, 2)])
    assert [effect.name for effect in found.effects] == ["position_spring"]


def test_where_strokes_overlap_the_law_is_asked_there(rigid: Plant) -> None:
    beside = sprung("beside", 0.08, 2)
    problem, found, judged = judged_with(rigid, PositionSpring.of(stiffness=50.0, zero=0.0), [beside], sprung("near"))
    (there,) = where_fitted(problem, found.effects, judged, found.effects[0])
    every, inside = judged[0].evidence.judged_rows, there.evidence.judged_rows
    position = R * beside["motor_angle"]
    known = R * problem.evidence[0].recording["motor_angle"][problem.evidence[0].fit_rows]
    # the simulated position and the recorded one are a step apart at most: two rows wherever a stroke passes the end
    wanted = every & (position >= known.min()) & (position <= known.max())
    passes = np.count_nonzero(np.diff(wanted.astype(int)))
    assert np.count_nonzero(inside != wanted) <= 2 * passes < 0.1 * np.count_nonzero(wanted)
    assert not inside[position > known.max() + 1e-3].any()
    assert share_where_fitted(problem, found, judged, 0).carries


def test_a_law_of_speed_is_asked_up_to_the_speeds_that_were_fitted(rigid: Plant) -> None:
    slow, fast = rigid_run("slow", Truth(), slow=2.0), rigid_run("fast", Truth(seed=2))
    problem, found, judged = judged_with(rigid, ViscousAsymmetry.of(delta_viscous=20.0), [fast], slow)
    (there,) = where_fitted(problem, found.effects, judged, found.effects[0])
    speed = np.abs(np.gradient(R * fast["motor_angle"], fast.sample_time))
    known = np.abs(np.gradient(R * slow["motor_angle"], slow.sample_time))[problem.evidence[0].fit_rows]
    assert there.evidence.judged_rows.any()
    assert speed[there.evidence.judged_rows].max() < 1.001 * known.max()
    assert speed[judged[0].evidence.judged_rows].max() > 1.9 * known.max()


def test_a_law_without_a_variable_is_asked_everywhere(rigid: Plant) -> None:
    far = sprung("far", 0.5, 2)
    problem, found, judged = judged_with(rigid, ConstantForce.of(force=5.0), [far], sprung("near"))
    assert where_fitted(problem, found.effects, judged, found.effects[0]) == judged


NODES = tuple(np.linspace(-0.09, 0.09, 13))


@pytest.mark.parametrize(("peak", "is_there"), [(3.0, True), (0.0, False)])
def test_nodes_are_told_by_their_differences(peak: float, is_there: bool, rigid: Plant) -> None:
    """The level of a curve that counts about its mean is in no row, but for the rounding of its slopes."""
    bump = peak, 0.02, 0.04
    level = np.mean(peak * np.exp(-(((np.array(NODES) - bump[1]) / bump[2]) ** 2)))
    truth = Truth(bump=bump, coulomb=1 - float(level) / COULOMB)
    problem, _, _ = prepared(rigid, [rigid_run("bump", truth)], [], 1.0)
    found = fit(problem, [FrictionVsPosition.of(position=NODES, delta_force=(0.1,) * len(NODES))])
    rounding = np.random.default_rng(2).standard_normal(len(found.residual))
    rounding *= 4e-6 * np.linalg.norm(found.jacobian) / np.linalg.norm(rounding)
    rounded = replace(found, jacobian=found.jacobian + rounding[:, None])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("feeddrive.diagnosis.certainty.uncertainty.slopes", lambda problem, fitted: fitted.jacobian)
        half = certainty(problem, rounded).half_covariance
        assert np.sqrt(np.diag(half)).min() > 10 * np.abs(found.coordinates).max()  # each alone says nothing
        directions, known = certainty_along(problem, rounded, np.arange(len(NODES)))
        assert (np.diag(known.half_covariance) > 0).all()
        assert np.abs(directions.T @ directions - np.eye(len(NODES))).max() < 1e-12
        assert (sizes_around_none(problem, rounded) == [""]) is is_there
