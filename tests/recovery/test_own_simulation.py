"""A recording that feeddrive has simulated itself, without noise, is explained by what was put into it, and no more.

The drive of the simulation changes its torque four times a row and its position loop once, which a recording does not
tell; no noise hides it. Moves and sizes are drawn at random. Simulation and diagnosis share the plant's equations, so
that only what the recorder makes of them is asked here.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.judging.result import Diagnosis
from feeddrive.diagnosis.motion.axis_evidence import AxisEvidence
from feeddrive.diagnosis.preparation import prepared
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording
from feeddrive.simulate.scenario.scenario_file import read_scenario
from feeddrive.simulate.scenario.scenario_run import run_scenario

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "plants" / "bench_axis.toml"

SCENARIO = """format = "feeddrive-scenario/1"
name = "moves"
plant = "bench_axis"
controller = "{controller}"
travel = ["0 mm", "500 mm"]
{effect}
[trajectory]
kind = "moves"
start = "100 mm"
targets = [{targets}]
velocity = "20 m/min"
acceleration = "3 m/s^2"
jerk = "100 m/s^3"
dwell = "0.2 s"

[record]
rate = "{rate}"
"""

EFFECTS = {
    "torque_ripple": 'amplitude = "{size} N m"\norder = 6\nphase = "0.3 rad"',
    "stribeck": 'delta_force = "{size} N"\nvelocity = "5 mm/s"',
    "lead_error_periodic": 'amplitude = "{size} um"\norder = 1\nphase = "0.3 rad"',
    "payload": 'mass = "{size} kg"',
    "friction_vs_position": 'peak = "{size} N"\ncentre = "200 mm"\nhalf_width = "20 mm"',
}
LEADING = {
    "torque_ripple": ("amplitude", 0.1, 1.0),
    "stribeck": ("delta_force", 60.0, 1.0),
    "lead_error_periodic": ("amplitude", 2.0, 1e-6),
    "payload": ("mass", 25.0, 1.0),
    "friction_vs_position": ("peak", 80.0, 1.0),
}
"""Name to its leading value: key, size about which it is drawn, and the unit of that [SI]."""


def simulated(folder: Path, seed: int, rate: str, effect: str = "", moves: int = 25) -> Recording:
    """A recording of the bench axis under its cascade, moved to places drawn at random."""
    random = np.random.default_rng(seed)
    targets = ", ".join(f'"{place:.1f} mm"' for place in random.uniform(20, 480, moves))
    path = folder / f"moves_{seed}.toml"
    controller = (ROOT / "scenarios" / "controllers" / "bench_axis.toml").as_posix()
    path.write_text(SCENARIO.format(controller=controller, effect=effect, targets=targets, rate=rate), encoding="utf-8")
    return run_scenario(read_scenario(path)).recording


def diagnosed(folder: Path, seed: int, rate: str, effect: str = "") -> Diagnosis:
    recordings = [simulated(folder, seed + i, rate, effect) for i in (0, 1)]
    return diagnose(read_plant(BENCH), recordings[:1], recordings[1:])[0]


@pytest.mark.parametrize(
    ("seed", "rate"), [(11, "2 kHz"), pytest.param(21, "8 kHz", marks=pytest.mark.slow), (31, "1 kHz"), (41, "500 Hz")]
)
def test_nothing_is_named_where_nothing_was_put_in(tmp_path: Path, seed: int, rate: str) -> None:
    result = diagnosed(tmp_path, seed, rate)
    assert (result.effects, result.quality) == ((), ())


@pytest.mark.parametrize(
    ("name", "seed"),
    [("torque_ripple", 51)]
    + [pytest.param(name, 51 + 10 * i, marks=pytest.mark.slow) for i, name in enumerate(EFFECTS) if i > 0],
)
def test_what_was_put_in_is_named_alone(tmp_path: Path, name: str, seed: int) -> None:
    key, about, unit = LEADING[name]
    size = float(f"{about * np.random.default_rng(seed).uniform(0.7, 1.4):.4g}")
    effect = f'\n[[effect]]\nname = "{name}"\n{EFFECTS[name].format(size=size)}\n'
    result = diagnosed(tmp_path, seed, "2 kHz", effect)
    assert [one.name for one in result.effects] == [name]
    # no noise: what the rows do not tell is some thousandths of what accelerates
    assert result.effects[0].parameters[key].value == pytest.approx(size * unit, rel=0.01)


def test_what_rows_do_not_tell_is_taken_out_of_a_comparison(tmp_path: Path) -> None:
    """A torque that is the mean over its row, and an angle that moves at the rate of the rows."""
    problem, _, _ = prepared(read_plant(BENCH), [simulated(tmp_path, 91, "2 kHz")], [], 1.0)
    (evidence,) = problem.evidence
    assert isinstance(evidence, AxisEvidence)
    rows = evidence.thinned(evidence.fit_rows)
    closed = replace(evidence, between_rows=())
    for part in evidence.between_rows:
        left, whole = (np.linalg.norm(one.weighted(part, rows)) for one in (evidence, closed))
        # a deviation of one along a column of length w takes all of it but 1 / sqrt(1 + w²); the other column some more
        assert left < 1.01 * whole / np.sqrt(1 + whole**2)
