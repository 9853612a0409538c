"""Friction that would push the axis: found for every composition, told with its place, and refused on reading."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from feeddrive.diagnosis.judging.asked_of_fit import friction_that_pushes
from feeddrive.diagnosis.likelihood.fit import fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.motion.prediction import AxisPredictor
from feeddrive.effects.base import Effect, FrictionEffect, Motion, Port, Value, listed
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.errors import InputError
from feeddrive.files import plants_folder, shipped_plants
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.friction_law import friction_force, friction_level
from feeddrive.plant.passive_friction import is_passive, least_friction, refuse_active_friction
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import parameter_symbols, parameter_values
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.typing import FloatArray
from tests.analytic.test_energy import free_run, stored

BENCH_FILE = plants_folder() / "bench_axis.toml"
BENCH = read_plant(BENCH_FILE)
TOP_SPEED = 4.0


def _effect(name: str, place: str = "", **values: Value) -> Effect:
    return EFFECTS[name].of(None, place, **values)


def _file(folder: Path, *blocks: str) -> Path:
    path = folder / "machine.toml"
    path.write_text("\n".join([BENCH_FILE.read_text(encoding="utf-8"), *blocks]), encoding="utf-8")
    return path


def _block(name: str, **values: str) -> str:
    return "\n".join(["[[effect]]", f'name = "{name}"', *(f"{key} = {value}" for key, value in values.items())])


@pytest.mark.parametrize(
    ("blocks", "told"),
    [
        ([_block("coulomb_asymmetry", delta_force='"-200 N"')],
         ["table", "falls to -140 N", "coulomb_asymmetry", "delta_force between 0 and -60 N"]),
        ([_block("stribeck", delta_force='"-100 N"', velocity='"20 mm/s"')],
         ["falls to -40 N", "near rest", "delta_force between 0 and -60 N in stribeck"]),
        # 60 N + 300 N s/m 4 m/s: at the fastest a coefficient of 315 N s/m takes all of it
        ([_block("viscous_asymmetry", delta_viscous='"-900 N s/m"')],
         ["falls to -2340 N", "240 m/min", "delta_viscous between 0 and -31"]),
        ([_block("friction_vs_position", position='["0 mm", "100 mm", "200 mm"]',
                 delta_force='["0 N", "-80 N", "10 N"]')],
         ["falls to -20 N", "at 100 mm", "delta_force", "0.75"]),
        ([_block("friction_vs_position", peak='"-61 N"', centre='"1 mm"', half_width='"1 mm"')],
         ["falls to -1 N", "at 1 mm", "peak between 0 and -60 N"]),
        ([_block("ball_pass_ripple", amplitude='"2 N m"', order="3.1")],
         ["screw", "falls to -1.65 N m", "amplitude between 0 and 0.35 N m"]),
        # each alone is smaller than the level, both together are not
        ([_block("stribeck", delta_force='"-50 N"', velocity='"20 mm/s"'),
          _block("coulomb_asymmetry", delta_force='"-40 N"')],
         ["falls to -30 N", "in + direction", "near rest"]),
        ([_block("presliding", stiffness='"10 N/µm"'), _block("stribeck", delta_force='"-60 N"', velocity='"20 mm/s"')],
         ["falls to 0 N", "stribeck"]),
        ([_block("presliding", stiffness='"10 N/µm"'), _block("friction_deviation", coulomb_factor="0")],
         ["level of the table is 0 N", "presliding acts on it"]),
    ],
)  # fmt: skip
def test_refused_on_reading(blocks: list[str], told: list[str], tmp_path: Path) -> None:
    path = _file(tmp_path, *blocks)
    with pytest.raises(InputError) as refused:
        read_plant(path)
    line = str(refused.value)
    assert line.startswith(f"{path}: ")
    assert not [part for part in told if part not in line], line


@pytest.mark.parametrize(
    "effects",
    [
        [_effect("stribeck", delta_force=-59.0, velocity=0.02)],
        [_effect("stribeck", delta_force=-59.0, velocity=0.02), _effect("presliding", stiffness=1e7)],
        [_effect("coulomb_asymmetry", delta_force=-59.0)],
        [_effect("viscous_asymmetry", delta_viscous=-310.0)],  # 60 N stay at all speeds up to 4 m/s
        [_effect("torque_ripple", amplitude=20.0, order=3.0, phase=0.0)],
        [_effect("ball_pass_ripple", amplitude=0.34, order=3.1)],
        [_effect("constant_force", force=-500.0)],
        [_effect("viscous_warmup", share=1.0, time_constant=10.0)],
        # the bump fills the dip of the table
        [_effect("friction_vs_position", position=(0.0, 0.1, 0.2), delta_force=(0.0, -80.0, 10.0), peak=70.0,
                 centre=0.1, half_width=0.1)],
        [_effect("friction_vs_position", position=(0.0, 0.1, 0.2), delta_force=(0.0, -80.0, 10.0)),
         _effect("tabulated_friction", "position", position=(0.0, 0.1, 0.2), force=(0.0, 30.0, 0.0))],
    ],
)  # fmt: skip
def test_what_takes_power_is_allowed(effects: list[Effect]) -> None:
    refuse_active_friction(BENCH.with_effects(*effects), "machine.toml")


def test_ripple_and_its_harmonic_are_least_together() -> None:
    """A drag ripple of 0.24 N m with 0.14 N m of twice the order leaves some of 0.35 N m, or not, by their phases."""
    angle = np.linspace(0.0, 2 * np.pi, 10_001)
    for phase in (0.0, 0.5 * np.pi):
        least = 0.35 + float(np.min(0.24 * np.sin(angle) + 0.14 * np.sin(2 * angle + phase)))
        effects = [
            replace(_effect("ball_pass_ripple", amplitude=amplitude, order=order, phase=at), label=f"ripple_{order:g}")
            for amplitude, order, at in ((0.24, 3.1, 0.0), (0.14, 6.2, phase))
        ]
        plant = replace(BENCH, stroke=(0.0, 0.6)).with_effects(*effects)
        assert is_passive(plant) == (least > 0)
        screw = next(one for one in least_friction(plant) if one.port == "screw")
        assert least - 0.005 * 0.38 < screw.level <= least + 1e-9
        # without a stroke every phase may meet every other
        assert not is_passive(replace(plant, stroke=None))


def test_shipped_plants_and_their_stroke() -> None:
    for path in shipped_plants():
        if (plant := read_plant(path)).has_motion:
            assert is_passive(plant)
    # What lies outside the declared stroke is not reached.
    kimm = read_plant(plants_folder() / "kimm_testbed.toml")
    assert kimm.stroke is not None
    dip = _effect("friction_vs_position", peak=-70.0, centre=kimm.stroke[1] + 0.5, half_width=0.01)
    assert is_passive(kimm.with_effects(dip))
    assert not is_passive(BENCH.with_effects(dip))


def test_scenario_is_refused(tmp_path: Path) -> None:
    folder = plants_folder().parent / "scenarios"
    text = (folder / "slow_reversal.toml").read_text(encoding="utf-8")
    text = text.replace("controllers/", f"{folder.as_posix()}/controllers/")
    path = tmp_path / "scenario.toml"
    path.write_text(text + "\n" + _block("coulomb_asymmetry", delta_force='"-200 N"'), encoding="utf-8")
    with pytest.raises(InputError, match=r"scenario.toml: friction of the table would push"):
        read_scenario(path)


def _drawn(generator: np.random.Generator) -> Plant:
    """The bench axis with some friction effects of any size, signs included."""
    uniform = generator.uniform
    tables = tuple(np.sort(uniform(-0.4, 0.4, 5))), tuple(uniform(-60, 60, 5)), tuple(uniform(-300, 300, 5))
    possible = [
        _effect("coulomb_asymmetry", delta_force=uniform(-90, 90)),
        _effect("stribeck", delta_force=uniform(-90, 90), velocity=10 ** uniform(-4, -0.5)),
        _effect("viscous_asymmetry", delta_viscous=uniform(-500, 500)),
        _effect("friction_vs_position", peak=uniform(-90, 90), centre=uniform(-0.3, 0.3), half_width=uniform(0.01, 0.3),
                position=tables[0], delta_force=tables[1]),
        _effect("tabulated_friction", "position", position=tables[0], force=tables[1][::-1]),
        _effect("tabulated_friction", "position", position=tables[0], viscous=tables[2]),
        _effect("viscous_warmup", share=uniform(-1, 1), time_constant=5.0),
        _effect("friction_deviation", coulomb_factor=uniform(0.2, 1.5), viscous_factor=uniform(0.2, 1.5)),
    ]  # fmt: skip
    chosen = generator.permutation(len(possible))[: generator.integers(1, 4)]
    effects = [possible[i] for i in sorted(chosen)]
    tabulated = [effect for effect in effects if effect.name == "tabulated_friction"]
    return BENCH.with_effects(*(effect for effect in effects if effect not in tabulated[1:]))


def _sampled(plant: Plant, generator: np.random.Generator, direction: int) -> tuple[float, float]:
    """Least level in a direction, and least force along the motion in both, at many places of what they read."""
    symbols = parameter_symbols(plant)
    x, v, t = (ca.SX.sym(name) for name in ("x", "v", "t"))
    motion = Motion(x, v, t)
    laws = [friction_level(plant, symbols, Port.TABLE, motion), friction_force(plant, symbols, Port.TABLE, motion)]
    function = ca.Function("laws", [x, v, t, symbols.vector], laws)
    nodes = [node for effect in plant.effects for node in listed(effect.values.get("position", ()))]
    places = np.concatenate([generator.uniform(-0.4, 0.4, 300), np.array(nodes), [0.0]])
    speeds = np.concatenate([10 ** generator.uniform(-6, math.log10(TOP_SPEED), 100), [1e-9, TOP_SPEED]])
    grid = np.array(np.meshgrid(places, [*speeds, *-speeds], [0.0, 3.0, 1e3])).reshape(3, -1)
    level, force = (np.array(part)[0] for part in function(*(row[None, :] for row in grid), parameter_values(plant)))
    return float(level[np.sign(grid[1]) == direction].min()), float((force * np.sign(grid[1])).min())


@pytest.mark.parametrize("seed", range(60))
def test_verdict_is_that_of_the_composed_law(seed: int) -> None:
    generator = np.random.default_rng(seed)
    plant = _drawn(generator)
    table = next(least for least in least_friction(plant) if least.port == Port.TABLE)
    level, force = _sampled(plant, generator, table.direction)
    # A bound never lies above what is found; what is found at random places lies at most a little above the least.
    assert table.level <= level + 1e-9
    if is_passive(plant):
        assert level >= 0
        assert force >= -1e-9
    elif min(table.level, 0.0) < -3.0:  # 3 N: what the grid of random places may miss of a dip
        assert level < 0
    else:
        assert table.force < 0 or table.level < 0


def test_bound_is_no_more_careful_than_it_must_be() -> None:
    # One variable each: the least level is exact, to 1e-4 of the sizes.
    dip = _effect("friction_vs_position", peak=-40.0, centre=0.1, half_width=0.05, position=(0.0, 0.1, 0.3),
                  delta_force=(0.0, 20.0, -10.0))  # fmt: skip
    table = next(least for least in least_friction(BENCH.with_effects(dip)) if least.port == Port.TABLE)
    x = np.linspace(-0.3, 0.5, 2_000_001)
    level = 60 - 40 * np.exp(-(((x - 0.1) / 0.05) ** 2)) + np.interp(x, (0.0, 0.1, 0.3), (0.0, 20.0, -10.0))
    assert table.level == pytest.approx(level.min(), abs=1e-4 * 160)
    assert table.level <= level.min() + 1e-9


FRICTION = {name: effect for name, effect in EFFECTS.items() if issubclass(effect, FrictionEffect)}
VALUES: dict[str, dict[str, Value]] = {
    "guide_friction": {"coulomb": 60.0, "smoothing_velocity": 5e-4, "viscous": 300.0, "film_force": 40.0,
                       "velocity": (0.0, 0.1, 0.3), "force": (20.0, 0.0, 15.0)},
    "nut_drag": {"coulomb": 0.3, "smoothing_speed": 0.1, "viscous": 0.01},
    "bearing_drag": {"coulomb": 0.3, "smoothing_speed": 0.1, "viscous": 0.01},
    "nut_friction": {"friction_coefficient": 0.01, "pitch_diameter": 0.03, "preload": 2000.0, "smoothing_speed": 0.1},
    "load_dependent_friction": {"coefficient": 0.05},
    "coulomb_asymmetry": {"delta_force": -20.0},
    "viscous_asymmetry": {"delta_viscous": -20.0},
    "stribeck": {"delta_force": -20.0, "velocity": 0.02},
    "friction_vs_position": {"peak": -20.0, "centre": 0.05, "half_width": 0.03, "position": (0.0, 0.2),
                             "delta_force": (0.0, 9.0)},
    "friction_deviation": {"coulomb_factor": 0.7, "viscous_factor": 1.4},
    "viscous_warmup": {"share": 0.4, "time_constant": 20.0},
    "ball_pass_ripple": {"amplitude": 0.05, "order": 3.1, "phase": 0.4},
    "tabulated_friction": {"position": (0.0, 0.1, 0.2), "force": (1.0, -3.0, 2.0)},
    "presliding": {"stiffness": 1e7},
}  # fmt: skip


def test_every_friction_effect_is_among_these() -> None:
    assert set(VALUES) == set(FRICTION)


@pytest.mark.parametrize("name", [name for name in VALUES if name != "presliding"])
def test_turning_points_are_all_that_there_are(name: str) -> None:
    effect = FRICTION[name].of(place="position" if name == "tabulated_friction" else "", **VALUES[name])
    radius, turns, lowest = 0.003, effect.turning_points(), effect.least_level(0.003)
    x, v, t, f = (ca.SX.sym(key) for key in ("x", "v", "t", "f"))
    p = {key: ca.SX(ca.DM(list(listed(value)))) for key, value in effect.values.items()}
    motion = Motion(x, v, t, f, radius)
    slots = [*effect.level_terms(motion, p), effect.viscous(motion, p), effect.viscous_factor(motion, p)]
    function = ca.Function("slots", [x, v, t, f], [ca.vertcat(*(ca.SX(slot) for slot in slots))])
    ranges = {"position": (-0.5, 0.5), "speed": (1e-9, 4.0), "time": (0.0, 900.0), "force": (-9000.0, 9000.0)}
    for direction in (1, -1):
        for variable, (low, high) in ranges.items():
            grid = np.unique([low, high, *np.linspace(low, high, 4001), *(x for x in turns.get(variable, ())
                                                                          if low < x < high)])  # fmt: skip
            at = {"position": 0.03, "speed": 0.05, "time": 1.0, "force": 300.0, variable: grid}
            read = np.array(function(*(np.broadcast_to(value, (1, len(grid))) for value in (
                at["position"], np.asarray(at["speed"]) * direction, at["time"], at["force"]))))  # fmt: skip
            if lowest is not None:
                assert read[:-2].sum(axis=0).min() >= lowest - 1e-12
            rows = read if lowest is None else read[-2:]
            edges = np.searchsorted(grid, sorted({low, high, *(x for x in turns.get(variable, ()) if low < x < high)}))
            for start, end in pairwise(edges):
                steps = np.diff(rows[:, start : end + 1], axis=1)
                size = 1e-12 * (1 + np.abs(rows).max())  # rounding of the laws
                assert np.all((steps >= -size).all(axis=1) | (steps <= size).all(axis=1)), variable


def test_refused_friction_gives_energy_and_allowed_friction_takes_it() -> None:
    # Motor off, everything turning forward with the table: no stiffness is stretched, so all that changes is kinetic.
    state = np.array([0.0, 0.0, 0.0, *np.array([1 / BENCH.chain.radius, 1 / BENCH.chain.radius, 1.0]) * 0.02])
    for force, passive in ((-59.0, True), (-200.0, False)):
        plant = Plant("free", BENCH.chain, (BENCH.effects[0],)).with_effects(
            _effect("coulomb_asymmetry", delta_force=force)
        )
        energy = stored(plant, free_run(plant, state, 400))
        assert is_passive(plant) is passive
        if passive:
            assert np.diff(energy).max() <= 1e-9 * energy[0]  # the engine's own error, as in test_energy.py
        else:
            assert energy[-1] > 1.5 * energy[0]


class _Drop(Problem):
    """A recording that asks for a Stribeck drop of 80 N, more than the 60 N that there are."""

    def predicted(self, effects: Sequence[Effect]) -> FloatArray:
        return np.full(3, effects[0].values["delta_force"], dtype=float)

    @property
    def measured(self) -> FloatArray:  # type: ignore[override]
        return np.full(3, -80.0)


def test_fit_stays_where_friction_takes_power() -> None:
    problem = _Drop(BENCH, (), AxisPredictor())
    start = _effect("stribeck", delta_force=-30.0, velocity=0.02)
    found = fit(problem, [start]).effects
    assert problem.possible(found)
    assert -60.0 < found[0].values["delta_force"] < -45.0  # type: ignore[operator]
    # A start outside is no plant that a file may hold; the search gives it up (`attempt.started`).
    assert not problem.possible([start.with_values(delta_force=-70.0)])


def test_names_with_which_friction_would_push_are_told() -> None:
    problem = Problem(BENCH, (), AxisPredictor())
    deep, slight = _effect("stribeck", delta_force=-70.0, velocity=0.02), _effect("coulomb_asymmetry", delta_force=-5.0)
    ripple = _effect("torque_ripple", amplitude=1.0, order=3.0, phase=0.0)
    # without the deep drop friction resists, without the slight asymmetry it does not
    told = friction_that_pushes(problem, [slight, ripple, deep])
    assert told[:2] == ["", ""] and "push" in told[2]
    assert friction_that_pushes(problem, [slight, ripple]) == ["", ""]
    # two that push each by itself
    steep = _effect("coulomb_asymmetry", delta_force=-80.0)
    assert all(friction_that_pushes(problem, [steep, deep]))
