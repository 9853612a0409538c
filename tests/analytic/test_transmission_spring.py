"""The one spring law of the transmission: energy, closed forms of its slots, plant files."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from feeddrive.effects.base import Effect
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.effects.transmission.stiffness_vs_position import LEAST_FACTOR, StiffnessVsPosition
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.plant.analysis.linear import linear_matrices
from feeddrive.plant.analysis.steady import steady_motion
from feeddrive.plant.chain.chain import Rigid, ThreeInertias
from feeddrive.plant.file.lumped_text import plant_text_with_effects
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import chain_symbols, parameter_symbols, parameter_values
from feeddrive.plant.transmission_law import spring_law
from feeddrive.simulate.driven import motor_motion, simulate_driven
from tests.analytic.test_energy import free_run
from tests.convergence.test_simulate import BENCH

K = BENCH.values["axial_stiffness"]
SOFT = PreloadLoss.of(ratio=0.3, force=200.0)
ALONG = StiffnessVsPosition.of(share_over_stroke=0.4, low=0.0, high=0.4)
HELD_TWICE = StiffnessVsPosition.of(share_over_stroke=-0.1, middle_compliance=0.3, low=0.2, high=0.0)
PLAY = Backlash.of(width=4e-6)
SETS: dict[str, tuple[Effect, ...]] = {
    "soft": (SOFT,), "along": (ALONG,), "held twice": (HELD_TWICE,),
    "soft along": (SOFT, ALONG), "play soft along": (PLAY, SOFT, ALONG)
}  # fmt: skip


def law(plant: Plant) -> ca.Function:
    """(stretch, position) -> force, pull, energy, and the slopes of the energy with its sign as forces have it."""
    symbols = parameter_symbols(plant)
    e, x = ca.SX.sym("e"), ca.SX.sym("x")
    found = spring_law(plant, symbols, plant.chain.nut(chain_symbols(plant, symbols)), e, x)
    slopes = ca.jacobian(found.energy, e), -ca.jacobian(found.energy, x)
    function = ca.Function("law", [e, x, symbols.vector], [found.force, found.pull, found.energy, *slopes])
    return lambda stretch, position: [float(v) for v in function(stretch, position, parameter_values(plant))]


@pytest.mark.parametrize("case", SETS)
def test_forces_are_slopes_of_the_energy(case: str) -> None:
    at = law(Plant("spring", BENCH, SETS[case]))
    for stretch in (-6e-5, -3e-6, -5e-7, 1e-7, 2.5e-6, 4e-6, 9e-6, 2e-4):
        for position in (-0.1, 0.05, 0.38):
            force, pull, energy, by_stretch, by_position = at(stretch, position)
            # the same numbers by two ways of writing, relative to the stiffest spring's
            assert force == pytest.approx(by_stretch, rel=1e-9, abs=1e-9 * K * abs(stretch))
            assert pull == pytest.approx(by_position, rel=1e-9, abs=1e-9 * K * stretch**2)
            assert energy >= 0.0 and force * stretch >= 0.0


@pytest.mark.parametrize("case", SETS)
def test_energy_is_kept_without_friction(case: str) -> None:
    """Motor, screw and table swing against each other by some micrometres; nothing dissipates."""
    bare = ThreeInertias({**BENCH.values, "torsional_damping": 0.0, "axial_damping": 0.0})
    plant = Plant("free", bare, SETS[case])
    run = free_run(plant, np.array([0.0, 0.0, 0.0, 31.0, 31.0, 0.092]), 200)
    at, v, r = law(plant), bare.values, bare.radius
    theta, phi, x, dtheta, dphi, dx = run.states.T[:6]
    stored = np.array([at(r * p - t, t)[2] for p, t in zip(phi, x, strict=True)])
    stored += 0.5 * v["torsional_stiffness"] * (theta - phi) ** 2
    moving = 0.5 * (v["motor_inertia"] * dtheta**2 + v["screw_inertia"] * dphi**2 + v["table_mass"] * dx**2)
    total = stored + moving
    swinging = np.ptp(stored)
    assert np.ptp(r * phi - x) > 4e-6 and swinging > 1e-5
    # a step may miss 0.01 nm under forces of 500 N, two hundred samples of some steps each
    assert np.ptp(total) < 3e-3 * swinging


def test_soft_up_to_the_force_and_stiff_beyond() -> None:
    at = law(Plant("spring", BENCH, (SOFT,)))
    edge = 200.0 / (0.3 * K)
    assert at(edge, 0.0)[0] == pytest.approx(200.0, rel=1e-12)
    assert at(0.5 * edge, 0.0)[0] == pytest.approx(100.0, rel=1e-12)
    assert at(edge + 1e-6, 0.0)[0] == pytest.approx(200.0 + K * 1e-6, rel=1e-12)
    assert at(-edge - 1e-6, 0.0)[0] == pytest.approx(-200.0 - K * 1e-6, rel=1e-12)


def test_beyond_its_force_lost_preload_is_a_free_play() -> None:
    """What the soft part gives way in all, (1/a - 1) F1/k either way, is the play that a force beyond F1 sees."""
    play = Backlash.of(width=2 * (1 / 0.3 - 1) * 200.0 / K)
    soft, gap = (law(Plant("spring", BENCH, (effect,))) for effect in (SOFT, play))
    for stretch in (6e-6, -1e-5, 5e-5):
        assert soft(stretch, 0.0)[0] == pytest.approx(gap(stretch, 0.0)[0], rel=1e-12)
    assert soft(1e-6, 0.0)[0] > 50.0 and gap(1e-6, 0.0)[0] == 0.0


def test_stiffness_falls_by_the_share_over_the_stroke() -> None:
    at = law(Plant("spring", BENCH, (ALONG,)))
    forces = [at(1e-6, x)[0] / (K * 1e-6) for x in (0.0, 0.2, 0.4, 0.6, 15.0, -3.0)]
    # the compliance is a straight line: 1 at the low end, 1 / 0.6 at the high one, 20 where it ends, 1 / 20 before it
    assert forces == pytest.approx([1.0, 0.75, 0.6, 0.5, LEAST_FACTOR, 1 / LEAST_FACTOR], rel=1e-12)


def test_a_screw_held_at_both_ends_is_a_parabola_of_the_compliance() -> None:
    """Two lengths in parallel, a nut in series: exact at every place, whichever end is counted from."""
    near, far, rod, length, nut = 1 / 900e6, 1 / 700e6, 1 / 2.3e8, 0.9, 1 / K

    def compliance(x: float) -> float:
        return nut + 1 / (1 / (near + rod * x) + 1 / (far + rod * (length - x)))

    for low, high in ((0.1, 0.6), (0.5, 0.0)):
        first, last = compliance(low), compliance(high)
        middle = compliance(0.5 * (low + high)) - 0.5 * (first + last)
        effect = StiffnessVsPosition.of(
            share_over_stroke=1 - first / last, middle_compliance=middle / first, low=low, high=high
        )
        at = law(Plant("spring", ThreeInertias({**BENCH.values, "axial_stiffness": 1 / first}), (effect,)))
        for x in (0.0, 0.2, 0.37, 0.8):
            assert at(1e-6, x)[0] == pytest.approx(1e-6 / compliance(x), rel=1e-9)


def test_two_of_them_multiply() -> None:
    at = law(Plant("spring", BENCH, (ALONG, ALONG)))
    assert at(1e-6, 0.4)[0] == pytest.approx(0.36 * K * 1e-6, rel=1e-12)


def test_steady_lag_and_linearised_slope() -> None:
    """Pushed by 90 N the table lags by F/(a k), pushed by 1000 N by F/k + (1/a - 1) F1/k; and swings on k there."""
    for force, lag in ((90.0, 90.0 / (0.3 * K)), (1000.0, 1000.0 / K + (1 / 0.3 - 1) * 200.0 / K)):
        plant = Plant("pushed", BENCH, (SOFT, ConstantForce.of(force=force)))
        state = steady_motion(plant, 0.05, 0.1).state
        assert BENCH.radius * state[1] - state[2] == pytest.approx(lag, rel=1e-6)  # positions of 0.1 m lose six digits
        slope = -linear_matrices(plant, 0.05, 0.1)[0][5, 2] * BENCH.values["table_mass"]
        assert slope == pytest.approx(K if force > 200.0 else 0.3 * K, rel=1e-9)


def test_stroke_of_the_plant_is_taken_where_the_effect_gives_none(tmp_path: Path) -> None:
    text = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")
    effect = '\n[[effect]]\nname = "stiffness_vs_position"\nshare_over_stroke = 0.4\n'
    path = tmp_path / "axis.toml"
    path.write_text(text.replace("[table]", '[table]\nstroke = ["40 mm", "360 mm"]') + effect, encoding="utf-8")
    (found,) = (e for e in read_plant(path).effects if e.name == "stiffness_vs_position")
    assert (found.values["low"], found.values["high"]) == (0.04, 0.36)
    path.write_text(text + effect, encoding="utf-8")
    with pytest.raises(InputError, match="acts along the stroke, which is not declared"):
        read_plant(path)


@pytest.mark.parametrize("case", ["soft", "along"])
def test_written_to_a_plant_file_it_predicts_the_same(case: str, tmp_path: Path) -> None:
    source = plants_folder() / "bench_axis.toml"
    path = tmp_path / "after.toml"
    path.write_text(plant_text_with_effects(source.read_text(encoding="utf-8"), SETS[case]), encoding="utf-8")
    again, direct = read_plant(path), read_plant(source).with_effects(*SETS[case])
    time = np.arange(400) * 5e-4
    motion = motor_motion(time, 20.0 * np.sin(2 * np.pi * 4 * time))
    one, other = simulate_driven(again, motion), simulate_driven(direct, motion)
    assert np.array_equal(one.torque, other.torque) and np.array_equal(one.table_position, other.table_position)
    assert np.abs(one.force).max() > 1000.0


def test_refusals() -> None:
    with pytest.raises(InputError, match="a stroke from 400 mm to 400 mm"):
        StiffnessVsPosition.of(share_over_stroke=0.1, low=0.4, high=0.4)
    rigid = Rigid({"lead": 0.02, "motor_inertia": 1e-3, "screw_inertia": 1e-3, "table_mass": 100.0})
    for effect in (SOFT, ALONG):
        with pytest.raises(InputError, match="needs an elastic transmission"):
            Plant("rigid", rigid, (effect,))
    with pytest.raises(InputError, match="preload_loss acts twice"):
        Plant("twice", BENCH, (SOFT, SOFT))
