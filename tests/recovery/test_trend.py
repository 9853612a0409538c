"""Changes of a machine that is recorded day by day are found, named and dated; where nothing changes nothing is told.

The machine is that of `trend_machine`: closed form, sharing nothing with the package. Its sizes are those of a 5 kg
cm^2 drive with a 10 mm screw; day by day its drag scatters by 2 % and its lead by 1 µm/m, and strokes begin anywhere.
"""

from __future__ import annotations

import math
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.trend.checkpoint import USED, Checkpoint, Entry
from feeddrive.trend.new_files import Options
from feeddrive.trend.regressors import grid_for, linear_pass
from feeddrive.trend.watch import Trend, trend_of
from tests.recovery import trend_machine as machine
from tests.recovery.trend_files import write_recording


@pytest.fixture
def axis(tmp_path: Path) -> fd.Axis:
    path = tmp_path / "plant.toml"
    path.write_text(machine.PLANT, encoding="utf-8")
    return fd.load(path)


def in_memory(axis: fd.Axis, states: list[machine.State], seconds: float = 5.0, absolute: bool = False) -> Trend:
    """What recordings of these states, a day apart, say, without files."""
    entries, grid = {}, None
    for number, state in enumerate(states):
        recording = machine.recording(state, seconds=seconds)
        grid = grid or grid_for(axis.plant, recording)
        moment = (datetime(2026, 1, 1) + timedelta(days=number)).isoformat()
        passes = linear_pass(recording, axis.plant, grid)
        entries[str(number)] = Entry(f"{number:04d}", 1, 1.0, USED, "", moment, str(number), passes)
    return trend_of(axis.plant, axis.entries, Options(absolute=absolute), Checkpoint("", grid, entries), ())


def values(trend: Trend, name: str) -> np.ndarray:
    return next(one.values for one in trend.quantities if one.name == name)


def test_values_of_single_recordings(axis: fd.Axis) -> None:
    """Play, stiffness, friction, mass, slope and offset of a machine that is another one in every recording."""
    random = np.random.default_rng(4)
    states = [
        machine.State(
            preload=float(random.uniform(0.5, 1.0)), play=float(random.uniform(0, 8e-6)), slope=20e-6 * i,
            offset=float(random.uniform(-5e-6, 5e-6)), seed=40 + i, start=float(random.uniform(0, 3.7)),
        )
        for i in range(8)
    ]  # fmt: skip
    trend = in_memory(axis, states, seconds=8.0, absolute=True)
    play = np.array([one.play for one in states])
    # a flank turns over about 1 N in the machine, whose play is therefore 1 % smaller: within 0.06 µm of 8
    np.testing.assert_allclose(values(trend, "play"), play, atol=0.08e-6)
    stiffness = machine.STIFFNESS * np.array([one.preload for one in states]) ** (1 / 3)
    np.testing.assert_allclose(values(trend, "stiffness"), stiffness, rtol=0.03)
    elastic = 2 * trend.pooled["table_position"].slow_force / stiffness
    np.testing.assert_allclose(values(trend, "elastic_lost_motion"), elastic, rtol=0.03)
    np.testing.assert_allclose(values(trend, "lost_motion"), play + elastic, rtol=0.05, atol=0.1e-6)
    # what all have in common (the lead map) is nobody's: differences count
    slope, offset = values(trend, "slope"), values(trend, "offset")
    np.testing.assert_allclose(slope - slope[0], [one.slope for one in states], atol=0.1e-6)
    np.testing.assert_allclose(offset, [one.offset - states[0].offset for one in states], atol=0.1e-6)
    drag = machine.DRAG * np.array([one.preload for one in states]) * 2 * math.pi / machine.LEAD
    coulomb = values(trend, "coulomb")
    # the tight place scales with the drag and is partly in the level: 0.35 * 0.05 m * sqrt(pi) / 0.44 m = 7 %
    np.testing.assert_allclose(coulomb - coulomb[0], (drag - drag[0]) * 1.07, atol=4.0)


def test_jump_of_backlash_in_a_month(axis: fd.Axis, tmp_path: Path) -> None:
    """Twenty-four days through files, 3 µm more play from the sixteenth on; a second look reads nothing."""
    folder = tmp_path / "days"
    folder.mkdir()
    random = np.random.default_rng(12)
    for number in range(24):
        state = machine.State(
            play=1e-6 + 3e-6 * (number >= 15), drag=1 + 0.02 * random.standard_normal(),
            slope=1e-6 * random.standard_normal(), seed=100 + number, start=random.uniform(0, 3.7),
        )  # fmt: skip
        moment = datetime(2026, 3, 1) + timedelta(days=number)
        write_recording(folder / f"axis_{moment:%Y%m%d}.csv", machine.recording(state, seconds=4.0))
    found = fd.watch(folder, axis)
    (event,) = found.trend.events
    assert event.kind == "jump" and event.day == 15.0 and event.causes[0] == "backlash"
    assert event.changes[0].quantity.name == "play"
    assert event.changes[0].found.size == pytest.approx(3e-6, rel=0.03)
    assert "2026-03-16" in found.verdict and "backlash" in found.verdict
    place = found.save()
    page = (place / "trend.html").read_text(encoding="utf-8")
    assert "play jumps by +" in page and "data:image/png" in page and (place / "trend.json").is_file()
    assert fd.watch(folder, axis).trend.fresh == 0


def preload_and_jump(seed: int, begins: int, jumps: int, per_day: float) -> list[machine.State]:
    """Two hundred days: preload is lost from one day on, and play of 4 µm comes on another."""
    random = np.random.default_rng(seed)
    return [
        machine.State(
            preload=1 - per_day * max(0, day - begins), play=0.5e-6 + 4e-6 * (day >= jumps),
            drag=1 + 0.02 * random.standard_normal(), slope=1e-6 * random.standard_normal(), seed=1000 * seed + day,
            start=random.uniform(0, 3.7),
        )
        for day in range(200)
    ]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "begins", "jumps", "per_day"), [(1, 70, 133, 0.0025), (2, 110, 40, 0.003), (3, 30, 160, 0.002)]
)
def test_loss_of_preload_and_a_jump_of_backlash(
    axis: fd.Axis, seed: int, begins: int, jumps: int, per_day: float
) -> None:
    """Both found, dated within 5 days and 1 day, and nothing else."""
    trend = in_memory(axis, preload_and_jump(seed, begins, jumps, per_day))
    kinds = {event.kind: event for event in trend.events}
    assert len(trend.events) == 2 and set(kinds) == {"jump", "slope"}
    assert abs(kinds["jump"].day - jumps) <= 1 and kinds["jump"].causes[0] == "backlash"
    assert abs(kinds["slope"].day - begins) <= 5 and kinds["slope"].causes[0] == "preload_loss"


@pytest.mark.slow
def test_no_false_change_in_twenty_steady_years(axis: fd.Axis) -> None:
    """Twenty times 250 recordings; in half of them the drag wanders over weeks, in half its scatter has heavy tails."""
    false: list[tuple[int, object]] = []
    for year in range(20):
        random, wander, states = np.random.default_rng(50_000 + year), 0.0, []
        for day in range(250):
            wander = 0.9 * wander + (0.0087 * random.standard_normal() if year % 2 else 0.0)
            scatter = random.standard_normal() if year % 4 < 2 else random.standard_t(5)
            states.append(
                machine.State(
                    play=abs(1e-6 + 0.03e-6 * random.standard_normal()), drag=1 + wander + 0.02 * scatter,
                    slope=1e-6 * random.standard_normal(), seed=1000 * year + day, start=random.uniform(0, 3.7),
                )
            )  # fmt: skip
        trend = in_memory(axis, states)
        false += [(year, event) for event in trend.events]
        false += [(year, name) for name, limit in trend.limits.items() if limit.left is not None]
    assert false == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_warm_up_seen_by_a_scale_of_a_micrometre(axis: fd.Axis, tmp_path: Path, seed: int) -> None:
    """Twelve hours, 250 recordings: time constants within 5 %, growths within 3 %, and where the fixed point lies."""
    random = np.random.default_rng(seed)
    offset, slope = random.uniform(5e-6, 25e-6), random.uniform(15e-6, 60e-6)
    of_offset, of_slope = random.uniform(0.8, 3.5), random.uniform(0.8, 3.5)
    folder = tmp_path / "warm"
    folder.mkdir()

    def grown(hours: float) -> tuple[float, float]:
        return -offset * math.expm1(-hours / of_offset), -slope * math.expm1(-hours / of_slope)

    for number in range(250):
        hours = 12 * number / 250
        o, s = grown(hours)
        state = machine.State(
            offset=o, slope=s, scale_step=1e-6, seed=1000 * seed + number, start=random.uniform(0, 3.7)
        )
        moment = datetime(2026, 3, 1, 6) + timedelta(hours=hours)
        recording = machine.recording(state, seconds=5.0, channels=("motor_angle", "table_position"))
        write_recording(folder / f"w_{moment:%Y%m%d_%H%M%S}.csv", recording)
    growth = fd.watch(folder, axis, absolute="table_position").trend.growth
    assert growth is not None and growth.offset is not None and growth.slope is not None
    assert 24 * growth.offset.time_constant == pytest.approx(of_offset, rel=0.05)
    assert 24 * growth.slope.time_constant == pytest.approx(of_slope, rel=0.05)
    assert growth.offset.growth == pytest.approx(offset, rel=0.03)
    assert growth.slope.growth == pytest.approx(slope, rel=0.03)
    o, s = grown(12 * 249 / 250)
    assert growth.fixed_point is not None
    assert growth.fixed_point[0] == pytest.approx(-o / s, rel=0.03)


def with_a_gap(days: list[int], states: list[machine.State], axis: fd.Axis) -> Trend:
    """What recordings of these states say that were made on these days."""
    entries, grid = {}, None
    for number, (day, state) in enumerate(zip(days, states, strict=True)):
        recording = machine.recording(state, seconds=5.0)
        grid = grid or grid_for(axis.plant, recording)
        moment = (datetime(2026, 1, 1) + timedelta(days=day)).isoformat()
        passes = linear_pass(recording, axis.plant, grid)
        entries[str(number)] = Entry(f"{number:04d}", 1, 1.0, USED, "", moment, str(number), passes)
    return trend_of(axis.plant, axis.entries, Options(), Checkpoint("", grid, entries), ())


@pytest.mark.parametrize("wears", [True, False])
def test_change_within_weeks_without_recordings(axis: fd.Axis, wears: bool) -> None:
    """A jump is told with both ends of the gap; the dates of wear that began in it hold its day."""
    random = np.random.default_rng(61)
    days = [*range(0, 30, 2), *range(60, 96, 2)]
    lost = [0.006 * max(0, day - 45) if wears else 0.0 for day in days]
    states = [
        machine.State(
            preload=1 - share, play=1e-6 + (0.0 if wears else 3e-6 * (day >= 45)),
            drag=1 + 0.02 * random.standard_normal(),
            slope=1e-6 * random.standard_normal(), seed=6100 + day, start=random.uniform(0, 3.7),
        )
        for day, share in zip(days, lost, strict=True)
    ]  # fmt: skip
    (event,) = with_a_gap(days, states, axis).events
    if wears:
        assert event.kind == "slope" and event.causes[0] == "preload_loss"
        assert event.dates[0] <= 45 <= event.dates[1]
    else:
        assert event.kind == "jump" and event.dates == (28.0, 60.0)
