"""Long recordings: run in stretches to the same bits, in room that does not grow with more than what is kept."""

from __future__ import annotations

import tracemalloc
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.base import Effect
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.simulate import driven
from feeddrive.simulate.driven import MotorMotion, motor_motion, simulate_driven
from tests.convergence.test_simulate import SAMPLE, bench
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run


def motion(count: int, substeps: int = 1) -> MotorMotion:
    time = 7.0 + np.arange(count) * SAMPLE
    return motor_motion(time, 0.3 * np.sin(2 * np.pi * 9 * time) + 0.2 * time, substeps)


@pytest.mark.parametrize("substeps", [1, 3])
@pytest.mark.parametrize("effects", [(), (Backlash.of(width=7.5e-6),)])
def test_stretches_are_one_run(effects: tuple[Effect, ...], substeps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Free play multiplies every difference: the runs must be the same to the last bit, and so must their reports."""
    plant, moved = bench(*effects), motion(1000, substeps)
    whole = simulate_driven(plant, moved)
    for length in (100, 301, 999):
        monkeypatch.setattr(driven, "STRETCH", length)
        parts = simulate_driven(plant, moved)
        for one in fields(whole):
            assert np.array_equal(getattr(whole, one.name), getattr(parts, one.name)) or one.name == "report"
        assert parts.report == whole.report and whole.report.refused > 0


def test_a_run_takes_little_more_room_than_what_is_kept_of_it() -> None:
    plant, moved = bench(), motion(400_000)
    simulate_driven(plant, motion(1000))
    tracemalloc.start()
    try:
        run = simulate_driven(plant, moved)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # what a stretch is fed, its copy for the engine, what it shows: 19 columns of 2^16 doubles at most
    assert most < run.size + 19 * 8 * driven.STRETCH + 2e6


def test_a_search_keeps_no_series_of_the_candidates_that_it_has_tried(tmp_path: Path) -> None:
    file = tmp_path / "rigid.toml"
    file.write_text(PLANT, encoding="utf-8")
    problem, _, _ = prepared(read_plant(file), [rigid_run("pushed", Truth(force=9.0), 6.0)], [], 0.75)
    found = search(problem)
    tried = [attempt for attempts in found.rounds for attempt in attempts]
    assert len(tried) > 10 and found.fit.residual.size > 0
    assert not any(one.fit.residual.size + one.fit.jacobian.size for one in tried)
