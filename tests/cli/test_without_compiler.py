"""Commands on a computer without a C compiler: the numbers are those of compiled runs, and all of them are there."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from feeddrive.cli.main import main
from feeddrive.compiler import find_compiler
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.effects.chain.payload import Payload
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.planted import pair
from tests.recovery.test_refinement import PLANTED, case, controlled_plant

SAME, SHARE = 1e-9, 1e-11
"""Difference of a number, relative and of numbers near 0. Compiled and interpreted runs are 8e-15 apart; what is told
of them is differences of positions, 1e4 times as small at most, and shares of a step of a thousandth of the position.

Where a sensor's resolution rounds what is read, as at a slow reversal, the last digit decides about a whole step of it:
such runs are alike to that step alone, and are not compared here."""

COMMANDS = {
    "run": ["run", "step_position", "--json"],
    "tune": ["tune", "bench_axis", "--scenario", "step_position", "--json"],
    "sweep": [
        "sweep", "step_position", "--set", "trajectory.duration=0.2 s", "--vary", "controller.position_gain=40,60 1/s",
        "--workers", "1", "--json",
    ],
}  # fmt: skip


def numbers(content: Any, at: str = "") -> Iterator[tuple[str, Any]]:
    """Every leaf of a JSON document with the way to it."""
    if isinstance(content, dict):
        for key, value in content.items():
            yield from numbers(value, f"{at}/{key}")
    elif isinstance(content, list):
        for i, value in enumerate(content):
            yield from numbers(value, f"{at}/{i}")
    else:
        yield at, content


def assert_alike(one: Any, other: Any) -> None:
    first, second = dict(numbers(one)), dict(numbers(other))
    assert first.keys() == second.keys()
    for at, value in first.items():
        if isinstance(value, float) and "seconds" not in at and "time_of" not in at:
            assert second[at] == pytest.approx(value, rel=SAME, abs=SHARE), at
        elif not isinstance(value, float):
            assert second[at] == value, at


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_tells_the_same_numbers(
    command: str, without_compiler: Callable[[], None], capsys: pytest.CaptureFixture[str]
) -> None:
    if find_compiler() is None:
        pytest.skip("no C compiler here")
    told = []
    for switch in (lambda: None, without_compiler):
        switch()
        assert main(COMMANDS[command]) == 0
        told.append(json.loads(capsys.readouterr().out))
    assert_alike(*told)


@pytest.mark.slow
def test_diagnose_finds_the_same(without_compiler: Callable[[], None]) -> None:
    """The whole search, two candidates at a time: what is found, refused and left, and every figure of it."""
    if find_compiler() is None:
        pytest.skip("no C compiler here")
    plant = read_plant(plants_folder() / "light_axis.toml")
    fitted, judged = (one.between(0.0, 6.0) for one in pair("light", "friction_deviation"))
    compiled, effects = diagnose(plant, [fitted], [judged])
    without_compiler()
    interpreted, others = diagnose(plant, [fitted], [judged])
    assert [effect.name for effect in effects] == [effect.name for effect in others] != []
    for effect, other in zip(effects, others, strict=True):
        for key, value in effect.values.items():
            # a fit ends where a step gains less than 1e-4 of the error; from the same start by the same steps
            assert np.asarray(other.values[key]) == pytest.approx(np.asarray(value), rel=1e-6)
    assert [one.name for one in compiled.refused] == [one.name for one in interpreted.refused]
    for channel, same in zip(compiled.channels, interpreted.channels, strict=True):
        assert same.after.rms == pytest.approx(channel.after.rms, rel=1e-6)
        assert same.before.rms == pytest.approx(channel.before.rms, rel=1e-9)


@pytest.mark.slow
def test_refinement_in_simulation_is_the_same(
    without_compiler: Callable[[], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`diagnose --simulate` once said of refinement without a compiler "not refined", as if that were a result."""
    if find_compiler() is None:
        pytest.skip("no C compiler here")
    short = tuple(one.between(0.0, 4.0) for one in pair("bench", "payload"))
    monkeypatch.setattr("tests.recovery.test_refinement.recordings", lambda: short)
    found = []
    for switch in (lambda: None, without_compiler):
        switch()
        found.append(case(controlled_plant(tmp_path, "bench"), Payload.of(mass=PLANTED + 0.6)).refined())
    compiled, interpreted = found
    assert compiled.simulation is not None and interpreted.simulation is not None
    assert compiled.simulation.statement == interpreted.simulation.statement
    assert "compiler" not in interpreted.simulation.statement
    masses = [one.found.fit.effects[0].values["mass"] for one in found]
    assert masses[1] == pytest.approx(masses[0], rel=1e-6) != PLANTED + 0.6
