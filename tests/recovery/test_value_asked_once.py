"""A declared value that is beyond its tolerance by the recordings alone, and not worth a name, is asked once."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.finding import search as of_search
from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.source.torque_ripple import TorqueRipple
from feeddrive.plant.file.plant_file import read_plant
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run


def test_a_value_that_goes_again_is_not_asked_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    problem, _, _ = prepared(read_plant(path), [rigid_run("a", Truth())], [rigid_run("b", Truth())], 0.75)
    asked: list[tuple[str, ...]] = []

    def beyond(there: Problem, found: Fit) -> tuple[Problem, Fit]:
        # stands for a deviation: nothing is there, so that the next round drops it
        asked.append(tuple(effect.name for effect in found.effects))
        return there, fit(there, (*found.effects, TorqueRipple.of(amplitude=1e-5, order=3.7, phase=0.4)))

    monkeypatch.setattr(of_search, "with_value_beyond", beyond)
    found = search(problem)
    assert asked == [()]
    assert found.fit.effects == ()
