"""A search goes on from a winner that was fitted while the others stayed, as from one fitted together with them."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.finding import round as rounds
from feeddrive.diagnosis.finding.search import search
from feeddrive.diagnosis.likelihood.coordinates import read_coordinates
from feeddrive.diagnosis.preparation import prepared
from feeddrive.plant.file.files import read_plant
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run


def test_no_winner_is_fitted_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rounds, "FINALISTS", 0)  # so that every winner was fitted alone
    (tmp_path / "rigid.toml").write_text(PLANT, encoding="utf-8")
    plant = read_plant(tmp_path / "rigid.toml")
    problem, _, _ = prepared(plant, [rigid_run("a", Truth(ripple=0.01, mass=20.0, force=15.0), 8.0)], [], 0.75)
    found = search(problem)
    assert {"torque_ripple", "payload"} < {effect.name for effect in found.fit.effects}
    for _, before in found.before:
        assert before.held == 0
        assert before.jacobian.shape[1] == len(read_coordinates(before.effects, plant))
