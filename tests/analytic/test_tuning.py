"""Recommended gains: closed forms for a rigid axis, margins that hold by another computation, files that come back."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.effects.friction.presliding import Presliding
from feeddrive.errors import InputError
from feeddrive.files import find_plant
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.chain.chain import Rigid
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.servo.cascade import Cascade, Feedback
from feeddrive.servo.linear_loop import open_position_loop, open_velocity_loop, worst_eigenvalue
from feeddrive.servo.margins import margins
from feeddrive.servo.mechanics_response import Case, Friction
from feeddrive.simulate.scenario.scenario_controller import read_controller
from feeddrive.tuning.demand import Demand, cases_of, operating_points
from feeddrive.tuning.largest_gain import Limit, largest_gain
from feeddrive.tuning.reasons import controller_text, settings
from feeddrive.tuning.recommendation import Recommendation, reached_in, recommend

RADIUS = 0.020 / (2 * math.pi)
MASS = 100.0
RIGID = Plant("mass", Rigid({"lead": 0.020, "motor_inertia": 0.0, "screw_inertia": 0.0, "table_mass": MASS}), (
    GuideFriction.of(coulomb=1e-9, smoothing_velocity=1e-3, viscous=1e-9),))  # fmt: skip
DRIVE = Cascade(RADIUS, 125e-6, 4, 0.0, 0.0, math.inf, 1.0, current_lag=1 / (2 * math.pi * 1000), dead_time=125e-6,
                feedback=Feedback.TABLE, torque_limit=30.0)  # fmt: skip
BENCH_CASES = (Case(payload=0.0), Case(payload=50.0))


@pytest.fixture(scope="module")
def bench() -> Plant:
    return read_plant(find_plant("bench_axis"))


@pytest.fixture(scope="module")
def found(bench: Plant) -> Recommendation:
    return recommend(bench, DRIVE, BENCH_CASES, Demand())


def test_largest_gain_of_an_integrator_with_delay() -> None:
    """k e^(-s T) / s: the phase margin P is met at k T = 90 deg - P, the gain margin A at k T = 90 deg / A."""
    frequency, delay = np.geomspace(0.1, 2000.0, 20_000), 1e-3
    loop = (np.exp(-2j * math.pi * frequency * delay) / (2j * math.pi * frequency))[None, :]
    by_phase = largest_gain(frequency, loop, 0.0, Demand(phase=60.0, gain=3.0))
    assert by_phase.limit is Limit.PHASE
    assert by_phase.gain == pytest.approx(math.radians(30.0) / delay, rel=1e-3)  # one step of the grid
    by_gain = largest_gain(frequency, loop, 0.0, Demand(phase=20.0, gain=12.0))
    assert by_gain.limit is Limit.GAIN
    assert by_gain.gain == pytest.approx(0.5 * math.pi / delay / 10 ** (12 / 20), rel=1e-3)


def test_rigid_axis_meets_the_textbook() -> None:
    """Phase at the crossover w: 90 deg - w T_d - atan(1 / (w T_n)) = 45 deg; T_d is lag, dead time and one tick."""
    cascade = recommend(RIGID, DRIVE, [Case()], Demand()).cascade
    inertia = MASS * RADIUS**2
    crossover = cascade.velocity_gain / inertia
    delay = DRIVE.sample_time + DRIVE.dead_time + DRIVE.current_lag
    phase = 90 - math.degrees(crossover * delay + math.atan(1 / (crossover * cascade.reset_time)))
    # T_d takes atan(w T) of the lag for w T and the crossover for that of the gain alone: 2 deg
    assert phase == pytest.approx(45.0, abs=3.0)
    # with a = w T_n, K_p / T_n is J w^2 / a, and w T_d = 45 deg - atan(1 / a): largest at a = 3.57, and within 2 % of
    # that from 3.0 to 4.3, so that the discrete loop may choose anything there
    assert 3.0 < crossover * cascade.reset_time < 4.3
    ratios = np.linspace(1.5, 8.0, 2000)
    best = inertia * np.max((math.pi / 4 - np.arctan(1 / ratios)) ** 2 / ratios) / delay**2
    # the lag taken as a delay turns the phase by up to 2 deg of 32 more than the lag does: 12 % of w^2
    assert 0.97 * best < cascade.velocity_gain / cascade.reset_time < 1.15 * best
    assert not cascade.torque_filters


def test_every_case_keeps_the_margins(bench: Plant, found: Recommendation) -> None:
    """By the fine grid of `servo.margins`, and by eigenvalues, which know nothing of margins."""
    for case in BENCH_CASES:
        plant = case.on(bench)
        for make in (open_velocity_loop, open_position_loop):
            reached = margins(make(plant, found.cascade))
            # 4000 instead of 20000 points, and rounding to three digits that is checked on the coarser grid
            assert reached.phase > 45.0 - 0.1 and reached.gain > 8.0 - 0.02 and reached.stable
        assert worst_eigenvalue(plant, found.cascade)[1] < 0


def test_gains_are_the_largest(bench: Plant, found: Recommendation) -> None:
    """A tenth more of either gain breaks a margin in some case."""
    cascade = found.cascade
    faster = replace(cascade, velocity_gain=1.1 * cascade.velocity_gain)
    stiffer = replace(cascade, position_gain=1.1 * cascade.position_gain)
    for bolder, make in ((faster, open_velocity_loop), (stiffer, open_position_loop)):
        reached = [margins(make(case.on(bench), bolder), points=4000) for case in BENCH_CASES]
        assert min(one.phase for one in reached) < 45.0 or min(one.gain for one in reached) < 8.0


def test_notch_sits_on_the_torsional_mode_and_is_explained(bench: Plant, found: Recommendation) -> None:
    (choice,) = found.velocity.filters
    assert choice.kind == "notch" and choice.resonance is not None
    low, high = choice.resonance
    assert 0.9 * low < choice.frequency < 1.1 * high  # moved to where it brings most, not away from its mode
    rows = {one.symbol: one for one in settings(bench, found)}
    assert set(rows) == {"K_p", "T_n", "notch", "K_v", "k_s, k_a"}
    assert "(m/min)/mm = " in rows["K_v"].shown and rows["K_v"].shown.endswith("1/s")
    assert "held back by the" in rows["K_p"].why and "resonance at" in rows["notch"].why


def test_controller_file_reads_back_as_the_recommendation(bench: Plant, found: Recommendation, tmp_path: Path) -> None:
    path = tmp_path / "controller.toml"
    path.write_text(controller_text(found, "x"), encoding="utf-8")
    read = read_controller(path, bench)
    for name in ("position_gain", "velocity_gain", "reset_time", "sample_time", "current_lag", "dead_time"):
        assert getattr(read, name) == pytest.approx(getattr(found.cascade, name), rel=1e-9)
    assert read.torque_filters == found.cascade.torque_filters and read.feedback is found.cascade.feedback
    assert read.feed_forward == found.cascade.feed_forward


def test_more_margin_and_more_delay_cost_gain() -> None:
    gains = [recommend(RIGID, replace(DRIVE, dead_time=dead), [Case()], Demand(phase=phase)).cascade.velocity_gain
             for phase, dead in ((45.0, 125e-6), (60.0, 125e-6), (60.0, 1e-3))]  # fmt: skip
    assert gains[0] > gains[1] > gains[2]


def test_what_cannot_be_kept_is_refused(bench: Plant) -> None:
    for phase, message in ((89.0, "which is of no use; ask for less"), (89.5, "no position gain keeps 89.5° and 8 dB")):
        with pytest.raises(InputError, match=message):
            recommend(bench, DRIVE, [Case()], Demand(phase=phase))
    for wrong in ({"phase": 0.0}, {"phase": 90.0}, {"gain": -1.0}):
        with pytest.raises(InputError, match="margin of"):
            Demand(**wrong)
    kimm = read_plant(find_plant("kimm_testbed"))
    assert [case.position for case in cases_of(kimm)] == [0.0, 0.5, 1.0]
    with pytest.raises(InputError, match="outside the stroke of KIMM testbed; choose from 0 mm to 1000 mm"):
        cases_of(kimm, [1.2])


def _gain_margin_by_sampling(plant: Plant, cascade: Cascade, case: Case) -> float:
    """Gain margin of the velocity loop [dB], from its ingredients: exponentials of matrices, no code of the loops.

    Mechanics linear about the case, current lag before them, held over a tick; a tick of dead time; the speed as a
    difference of angles; notches and PI as difference equations.
    """
    a, b, c, _ = linear_matrices(case.on(plant), case.velocity, case.position)
    n, tick = len(a), cascade.sample_time
    whole = np.zeros((n + 2, n + 2))  # states, torque, command
    whole[:n, :n], whole[:n, n] = a, b[:, 0]
    whole[n, n], whole[n, n + 1] = -1 / cascade.current_lag, 1 / cascade.current_lag
    over = expm(whole * tick)
    step, push = over[: n + 1, : n + 1], over[: n + 1, n + 1]
    assert cascade.dead_time == tick  # a whole tick: one power of z
    frequency = np.geomspace(20.0, 0.4999 / tick, 40_000)
    z = np.exp(2j * math.pi * frequency * tick)
    values, vectors = np.linalg.eig(step)
    seen, fed = np.append(c[0], 0.0) @ vectors, np.linalg.solve(vectors, push)
    angle = ((seen * fed) / (z[:, None] - values)).sum(axis=1)
    loop = cascade.velocity_gain * (1 + tick / cascade.reset_time / (z - 1)) * angle * (1 - 1 / z) / tick / z
    for one in cascade.torque_filters:
        k = one.discrete(tick)
        loop = loop * (k[0] + k[1] / z + k[2] / z**2) / (1 + k[3] / z + k[4] / z**2)
    crossing = np.flatnonzero((np.diff(np.signbit(loop.imag))) & (loop.real[1:] < 0))
    return float(-20 * np.log10(np.abs(loop[crossing]).max()))


def test_margins_hold_at_rest_too() -> None:
    """In motion, and in both limits of what friction without presliding can be at rest: free, and the table held."""
    plant = read_plant(find_plant("vertical_axis"))
    drive = replace(DRIVE, radius=plant.chain.motor_radius, torque_limit=plant.torque_limit, feedback=Feedback.MOTOR)
    points = operating_points(plant)
    assert [point.velocity for point in points] == [points[0].velocity] * 3 + [0.0] * 6
    assert points[0].velocity > 0
    assert [point.friction for point in points[3:]] == [Friction.FREE] * 3 + [Friction.HELD] * 3
    found = recommend(plant, drive, points, Demand())
    reached = {one.case: one for one in found.reached}
    assert set(reached) == set(points)
    for point in points:
        by_sampling = _gain_margin_by_sampling(plant, found.cascade, point)
        # Both grids are 2e-4 apart in frequency, near a resonance a few hundredths of a decibel.
        assert reached[point].velocity.gain == pytest.approx(by_sampling, abs=0.1)
        assert by_sampling > 8.0 - 0.1
        assert min(reached[point].velocity.phase, reached[point].position.phase) >= 45.0
        assert min(reached[point].velocity.gain, reached[point].position.gain) >= 8.0
    told = controller_text(found, "x")
    assert "at rest without friction and at rest with the table held" in told


def _light(width: float = 1.0) -> Plant:
    """The light axis, the sign change of its friction so many times as wide as declared."""
    plant = read_plant(find_plant("light_axis"))
    narrow = {"smoothing_velocity", "smoothing_speed"}
    return replace(plant, effects=tuple(
        one.with_values(**{key: width * float(one.values[key]) for key in narrow & set(one.values)})
        for one in plant.effects
    ))  # fmt: skip


@pytest.fixture(scope="module")
def light() -> tuple[Cascade, Recommendation]:
    plant = _light()
    drive = replace(DRIVE, radius=plant.chain.motor_radius, torque_limit=plant.torque_limit, feedback=Feedback.MOTOR)
    return drive, recommend(plant, drive, operating_points(plant), Demand())


@pytest.mark.parametrize("width", [0.3, 20.0])
def test_gains_do_not_depend_on_a_width_that_is_no_physics(width: float, light: tuple[Cascade, Recommendation]) -> None:
    """K_v of an axis went from 6 to 162 1/s with a width of tanh from 0.15 to 3 rad/s, when its slope was the rest."""
    drive, found = light
    other = _light(width)
    cascade = recommend(other, drive, operating_points(other), Demand()).cascade
    for name in ("velocity_gain", "reset_time", "position_gain"):
        # in motion the slope of tanh at 50 mm/s is what is left of it: 1e-8 of the level at the widest
        assert getattr(cascade, name) == pytest.approx(getattr(found.cascade, name), rel=1e-6), name


@pytest.mark.parametrize("way", [100e-6, 10e-6, 1e-6])
def test_a_bristle_lies_between_the_limits(way: float, light: tuple[Cascade, Recommendation]) -> None:
    """The table on an undamped bristle that breaks away over some micrometres, as guides do."""
    _, found = light
    plant = _light()
    level = float(next(one.values["coulomb"] for one in plant.effects if one.name == "guide_friction"))
    bristle = plant.with_effects(Presliding.of(stiffness=level / way, damping=0.0, break_away=0.5))
    assert [case.friction for case in operating_points(bristle)] == [Friction.DECLARED, Friction.FREE]
    reached = reached_in(bristle, found.cascade, Case(plant.middle, 0.0, 0.0, Friction.FREE))
    assert min(reached.velocity.phase, reached.position.phase) >= 45.0
    assert min(reached.velocity.gain, reached.position.gain) >= 8.0
    assert reached.velocity.stable and reached.position.stable


def test_tuning_in_motion_alone_misses_at_rest() -> None:
    plant = read_plant(find_plant("kimm_testbed"))
    drive = replace(DRIVE, radius=plant.chain.motor_radius, torque_limit=plant.torque_limit, feedback=Feedback.MOTOR)
    moving = recommend(plant, drive, cases_of(plant), Demand())
    points = [case for case in operating_points(plant) if case.friction is not Friction.DECLARED]
    reached = [reached_in(plant, moving.cascade, case) for case in points]
    assert min(min(one.velocity.phase, one.position.phase) for one in reached) < 44.0
