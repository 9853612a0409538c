"""A diagnosis that may take no longer than a given time ends with what it has, and says what it left out."""

from __future__ import annotations

import pytest

from feeddrive.diagnosis.budget import Budget
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.errors import InputError
from feeddrive.interface.measured.diagnosed import budget_of
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.plant.plant import Plant
from feeddrive.report.words.verdict import verdict_sentences
from tests.recovery.rigid_runs import PLANT, Truth, rigid_run


class Ticking:
    """A clock that goes on by a second whenever it is read: what is left out does not depend on the computer."""

    def __init__(self) -> None:
        self.read = 0.0

    def __call__(self) -> float:
        self.read += 1.0
        return self.read


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Plant:
    """The rigid axis."""
    path = tmp_path_factory.mktemp("plant") / "rigid.toml"
    path.write_text(PLANT, encoding="utf-8")
    return read_plant(path)


def test_share_of_the_time_by_stage() -> None:
    times = iter([0.0, 49.0, 51.0, 74.0, 76.0])
    budget = Budget(100.0, lambda: next(times))
    assert [budget.is_spent, budget.is_spent] == [False, True]
    budget.end_of_search()
    assert [budget.is_spent, budget.is_spent] == [False, True]


def test_what_is_left_out_is_said() -> None:
    budget = Budget(1.0, Ticking())
    assert budget.skips("in round 1 of the search", "stribeck")
    assert budget.skips("in round 1 of the search", "backlash")
    assert budget.skips("whether it is the recorder")
    left_out = "in round 1 of the search: backlash, stribeck; whether it is the recorder"
    assert budget.sentence == f"Not all was tried within 1 s. Left out: {left_out}."
    assert not Budget().skips("anything") and Budget().sentence == ""


def test_nothing_tried_is_not_nothing_missing(rigid: Plant) -> None:
    one, other = (rigid_run("run", Truth(seed=seed)) for seed in (3, 4))
    result, effects = diagnose(rigid, [one], [other], budget=Budget(1.0, Ticking()))
    assert (result.effects, result.trials, effects) == ((), (), ())
    assert "torque_ripple" in result.untried and result.untried in result.notes
    first, second, *_ = verdict_sentences(result)
    assert "as far as was tried" in first and second == result.untried


def test_best_set_so_far_is_reported(rigid: Plant) -> None:
    """Time for the first round alone finds one of the two effects, and no round is asked after it.

    A payload of 30 % is beyond what table mass and torque constant may make together, each within its 5 %.
    """
    one, other = (rigid_run("run", Truth(seed=seed, mass=18.0, ripple=0.01)) for seed in (3, 4))
    clock = Ticking()
    whole, _ = diagnose(rigid, [one], [other], budget=Budget(1e9, clock))
    assert whole.untried == "" and {e.name for e in whole.effects} == {"payload", "torque_ripple"}
    result, _ = diagnose(rigid, [one], [other], budget=Budget(0.6 * clock.read, Ticking()))
    assert "further rounds of the search" in result.untried
    assert [e.name for e in result.effects] == [one.name for one in result.trials if one.taken and one.round == 1]
    assert len(result.effects) == 1


@pytest.mark.parametrize("text", ["0 s", "-3 s", "60", "soon", "60 mm"])
def test_no_time(text: str) -> None:
    with pytest.raises(InputError, match="--budget"):
        budget_of(text, "--budget")
    assert budget_of("2 min", "--budget").seconds == 120.0
    assert budget_of(None, "--budget").sentence == ""
