"""Preload loss, stiffness along the stroke and a structural mode: found with their sizes, and not where they are not.

The fast tests look at one candidate: its start read off the residual, its fit, and that nothing is read off a null. The
slow ones are whole diagnoses at the sizes that are worth 10 % and 50 % of the error, on both axes.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.finding.scene import scene_of
from feeddrive.diagnosis.forms.simpler_law import as_payload
from feeddrive.diagnosis.forms.spring_law import odds_between
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.likelihood.standing import Standing
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.diagnosis.starts import mode, transmission_starts
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.effects.chain.stiffness_deviation import StiffnessDeviation
from feeddrive.effects.chain.structural_mode import StructuralMode
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording, read_recording
from tests.generator import effects as planted
from tests.generator import recording_pair, sized
from tests.generator.axis import AXES
from tests.generator.effects import Effect as Planted
from tests.generator.effects.relatives import Relative
from tests.recovery.drawn import drawn
from tests.recovery.fleet.case import case
from tests.recovery.planted import SIZE, Verdict, axis_plant, declared_errors

SECONDS = (7.0, 6.0)
STARTS = {
    "preload_loss": transmission_starts.preload_loss,
    "stiffness_vs_position": transmission_starts.stiffness_vs_position,
    "structural_mode": mode.structural_mode,
}
LOADS = {"bench": (16.0, 150.0), "light": (7.0, 90.0)}
"""Mass of a fixture [kg], and a preload that is lost [N]."""


def example(axis: str, name: str) -> Planted:
    """An effect of a size that a service engineer would meet."""
    mass, force = LOADS[axis]
    made: dict[str, Planted] = {
        "preload_loss": planted.PreloadLoss(ratio=0.35, force=force),
        "stiffness_vs_position": planted.StiffnessVsPosition(share_over_stroke=0.4),
        "structural_mode": planted.StructuralMode(mass=mass, frequency=70.0, damping=0.03),
    }
    return made[name]


def in_the_package(effect: Planted, axis: str) -> Effect:
    """The planted effect under the package's name and keys."""
    values = dataclasses.asdict(effect)
    if effect.name == "stiffness_vs_position":
        values |= dict(zip(("low", "high"), AXES[axis].travel, strict=True))
    return EFFECTS[effect.name].of(**values)


def recordings(axis: str, *effects: Planted, seeds: tuple[int, int] = (1, 2), noise: float = 1.0) -> list[Recording]:
    """The pair to fit and to judge."""
    made = []
    for channels in recording_pair(AXES[axis], effects, seeds, SECONDS, noise):
        rest = {name: series for name, series in channels.items() if name != "time"}
        made.append(Recording("planted", channels["time"], rest, float(np.mean(np.diff(channels["time"])))))
    return made


def problem_of(axis: str, *effects: Planted, **options: float) -> Problem:
    """The training recording, all of it fitted."""
    plant = axis_plant(axis)
    fitted, _ = recordings(axis, *effects, **options)  # type: ignore[arg-type]
    return Problem(plant, (prepare(fitted, plant, 1.0),), AxisPredictor())


def started(problem: Problem, name: str) -> list[Effect]:
    """All starts of a candidate on the declared plant."""
    return [start for form in STARTS[name](scene_of(problem, ())) for start in form]  # type: ignore[arg-type]


@pytest.mark.parametrize("axis", list(AXES))
@pytest.mark.parametrize("name", list(STARTS))
def test_start_leads_to_the_planted_values(axis: str, name: str) -> None:
    effect = example(axis, name)
    problem = problem_of(axis, effect)
    start, *_ = started(problem, name)
    found = fit(problem, (start,))
    for key, value in in_the_package(effect, axis).values.items():
        # the damper of a mode is a width of 2 Hz in a spectrum of some seconds
        assert found.effects[0].values[key] == pytest.approx(value, rel=0.1 if key == "damping" else 0.02, abs=1e-3)
    assert found.squared_error < 1.3 * len(found.residual)  # noise alone gives one, the quantised motor a tenth more


@pytest.mark.parametrize("axis", list(AXES))
@pytest.mark.parametrize("name", ["preload_loss", "structural_mode"])
def test_little_is_read_off_nulls(axis: str, name: str) -> None:
    """A start that noise alone makes costs a simulation: one null of four at most has one."""
    nulls = [problem_of(axis, seeds=(first, first + 1)) for first in (21, 23, 25, 27)]  # type: ignore[arg-type]
    assert sum(started(null, name) != [] for null in nulls) <= 1


@pytest.mark.parametrize("axis", list(AXES))
def test_payload_is_no_mode_in_the_band(axis: str) -> None:
    assert started(problem_of(axis, planted.Payload(mass=5.0)), "structural_mode") == []


@pytest.mark.parametrize("mass", [8.0, 25.0])
def test_mode_that_says_no_more_than_a_payload_becomes_it(mass: float) -> None:
    problem = problem_of("bench", planted.Payload(mass=mass))
    for frequency, damping in ((1000.0, 0.1), (400.0, 2.0)):  # beyond the band, and of strong damping
        found = fit(problem, (StructuralMode.of(mass=mass, frequency=frequency, damping=damping),))
        _, instead = as_payload(problem, found, 50)
        assert [effect.name for effect in instead.effects] == ["payload"]
        assert instead.effects[0].values["mass"] == pytest.approx(mass, rel=0.01)


def test_mode_in_the_band_does_not_become_a_payload() -> None:
    problem = problem_of("bench", example("bench", "structural_mode"))
    found = fit(problem, (in_the_package(example("bench", "structural_mode"), "bench"),))
    assert as_payload(problem, found, 50)[1] is found


def test_softer_spring_everywhere_does_not_fall_along_the_stroke() -> None:
    problem = problem_of("bench", planted.StiffnessDeviation(factor=0.8))
    start, *_ = started(problem, "stiffness_vs_position")
    softer, falling = fit(problem, (StiffnessDeviation.of(factor=0.9), start)).effects
    assert softer.values["factor"] == pytest.approx(0.8, rel=0.01)
    assert falling.values["share_over_stroke"] == pytest.approx(0.0, abs=0.01)  # of 0.2 that it is softer


def test_a_scale_that_shows_no_lag_hides_no_start() -> None:
    """Behind steps of 50 µm nothing of the lag is seen."""
    plant = axis_plant("bench")
    fitted, _ = recordings("bench", example("bench", "stiffness_vs_position"))
    coarse = {name: fitted[name] for name in fitted.channels}
    coarse["table_position"] = 5e-5 * np.round(coarse["table_position"] / 5e-5)
    behind_steps = Recording("coarse", fitted.time, coarse, fitted.sample_time)
    problem = Problem(plant, (prepare(behind_steps, plant, 1.0),), AxisPredictor())
    assert len(started(problem, "stiffness_vs_position")) == 2


@pytest.mark.slow
def test_a_resonance_that_moves_along_the_stroke_shows_in_the_torque(tmp_path: Path) -> None:
    """A machine drawn at random: a scale of 1 µm, 8 kHz, compliance that grows by a fifth over the stroke."""
    plant, fitted, judged = case(703668).write(tmp_path)
    result, _ = diagnose(read_plant(plant), [read_recording(fitted)], validation=[read_recording(judged)])
    (found,) = result.effects
    assert found.name == "stiffness_vs_position"
    low, high = found.parameters["share_over_stroke"].ci95
    assert low < 0.1937 < high


@pytest.mark.parametrize("axis", list(AXES))
def test_compliance_over_the_square_of_the_place_is_a_parabola_of_ours(axis: str) -> None:
    """1 + b u^2 = 1 + b u - b u (1 - u), so that m is -b / 4."""
    planted_law = Relative(planted.StiffnessVsPosition(share_over_stroke=0.4), "square", {"stroke_power": 2.0})
    problem = problem_of(axis, planted_law)
    _, start = started(problem, "stiffness_vs_position")
    found = fit(problem, (start,))
    assert found.effects[0].values["share_over_stroke"] == pytest.approx(0.4, rel=0.02)
    assert found.effects[0].values["middle_compliance"] == pytest.approx(-0.25 * 0.4 / 0.6, rel=0.05)


@pytest.mark.parametrize("axis", list(AXES))
def test_screw_held_at_both_ends_gives_way_most_halfway(axis: str) -> None:
    """As stiff at both ends, and by 0.3 more compliant between them: no straight line along the stroke tells it."""
    problem = problem_of(axis)
    low, high = AXES[axis].travel
    law = EFFECTS["stiffness_vs_position"].of(share_over_stroke=0.0, middle_compliance=0.3, low=low, high=high)
    problem = dataclasses.replace(problem, evidence=(drawn(problem.plant, problem.evidence[0], (law,), 5),))
    _, start = started(problem, "stiffness_vs_position")
    found = fit(problem, (start,))
    assert found.effects[0].values["middle_compliance"] == pytest.approx(0.3, rel=0.03)
    assert found.effects[0].values["share_over_stroke"] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(("wrong", "true"), [("backlash", "preload_loss"), ("preload_loss", "backlash")])
def test_play_and_lost_preload_are_apart_by_orders_once_simulated(wrong: str, true: str) -> None:
    """Of like lag: 4 um of play, and 60 N in which the spring gives way by 2 um more either way."""
    both: dict[str, Planted] = {
        "backlash": planted.Backlash(width=4e-6),
        "preload_loss": planted.PreloadLoss(ratio=0.2, force=60.0),
    }
    plant = axis_plant("light")
    channels, _ = recording_pair(
        dataclasses.replace(AXES["light"], chirp_amplitude=0.0), (both[true],), (1, 2), SECONDS
    )
    rest = {key: series for key, series in channels.items() if key != "time"}
    recording = Recording("planted", channels["time"], rest, float(np.mean(np.diff(channels["time"]))))
    problem = Problem(plant, (prepare(recording, plant, 1.0),), AxisPredictor())
    errors = {name: fit(problem, (in_the_package(both[name], "light"),), iterations=6) for name in (wrong, true)}
    assert errors[true].squared_error < 2 * len(errors[true].residual)
    assert errors[wrong].squared_error > 100 * errors[true].squared_error


def test_laws_that_predict_other_samples_are_compared_on_those_of_both() -> None:
    """Neither loses samples of both to what the other cannot predict, and the odds against are those for the other."""
    declared = problem_of("bench", planted.Backlash(width=4e-6))
    (evidence,) = declared.evidence
    phase = np.linspace(0.0, 20.0, len(evidence.counted))
    standings = []
    for name, size, predictable in (
        ("preload_loss", {"ratio": 0.3, "force": 60.0}, np.sin(phase) > -0.9),
        ("backlash", {"width": 4e-6}, np.where(np.cos(phase) > -0.5, 0.8, 0.0)),  # weighed less where it magnifies
    ):
        problem = dataclasses.replace(declared, evidence=(evidence.where_predictable(predictable),))
        standings.append(Standing(problem, fit(problem, (EFFECTS[name].of(**size),), iterations=4)))
    for_play, against = odds_between(*standings, 40), odds_between(*standings[::-1], 40)
    assert for_play == pytest.approx(-against, rel=1e-6)
    assert for_play > 100


def of_size(axis: str, name: str, share: float) -> Planted:
    """The effect so large that leaving it out costs this share of the error."""

    def error_ratio(effect: Planted) -> float:
        plant = axis_plant(axis)
        _, judged = recordings(axis, effect)
        declared, right = (
            declared_errors(p, judged) for p in (plant, plant.with_effects(in_the_package(effect, axis)))
        )
        return min(right[channel].after.rms / declared[channel].after.rms for channel in declared)

    return sized(example(axis, name), share, error_ratio)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.1, 0.5, None])
@pytest.mark.parametrize("name", list(STARTS))
@pytest.mark.parametrize("axis", list(AXES))
def test_found_at_its_size(axis: str, name: str, share: float | None) -> None:
    """Named, or in an ambiguous set: a preload lost up to a newton cannot be told from a play of 20 nm."""
    effect = example(axis, name) if share is None else of_size(axis, name, share)
    fitted, judged = recordings(axis, effect)
    result, _ = diagnose(axis_plant(axis), [fitted], [judged])
    _, quiet = recordings(axis)
    truth = {name: dataclasses.asdict(effect)}
    verdict = Verdict(result, truth, declared_errors(axis_plant(axis), quiet))
    print(f"\n{verdict.line(f'{axis}/{name}/{share}')}")
    misses = [*verdict._name_misses(), *verdict._error_misses()]
    if share is None:  # small ones are known as well as the noise lets them be
        misses += verdict._parameter_misses()
    assert misses == [], SIZE


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.3, 3.0])
@pytest.mark.parametrize("axis", list(AXES))
def test_nothing_is_found_on_a_null(axis: str, noise: float) -> None:
    fitted, judged = recordings(axis, seeds=(31, 32), noise=noise)
    result, effects = diagnose(axis_plant(axis), [fitted], [judged])
    assert effects == () and result.effects == ()
