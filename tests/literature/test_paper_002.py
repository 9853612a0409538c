"""Paper 002 (explicit finite-difference thermal analysis): its printed numbers, and its scheme beside the reduction.

Min, Park, Chung, "Thermal Analysis of Ballscrew Systems by Explicit Finite Difference Method". Printed numbers carry
their table. What figure 7 is compared with is a reduced model that averages the moving nut; the paper's explicit scheme
(`thermal/explicit.py`) moves the nut cell by cell and shares with it the cells and their conductances alone.
"""

from __future__ import annotations

import numpy as np
import pytest

from feeddrive.reproduce.paper_002 import rows
from feeddrive.reproduce.paper_002_sets import GRID, PRELOADS, SPEEDS, Assumptions, plant, warm_up
from feeddrive.reproduce.row import Row, Status
from feeddrive.thermal.full.full_model import discretise
from tests.heat_oracle.explicit import paper_cells, run_explicitly

RPM = 0.10471975511965977
WRONG_BY_A_LAW = {
    "T_bs at 670 N, 250 rev/min, literally",
    "T_bs at 1300 N, 250 rev/min, literally",
    "T_b(750) - T_b(250) with f0 of an oil bath",
    "time constant at 1300 N, 250 rev/min",
}
WRONG_IN_ITSELF = {
    "heat put in over friction power ωT",
    "heat that node n = 2 loses and its neighbour does not get, over the exchange",
    "T_v in N m",
    "volume of a bearing's cell, at its outer surface",
    "contact in the condition of class 8, a cell of the nut",
    "number of nuts in (22) from (18) to (20)",
    "unit of a friction torque",
    "viscosities of 32 and 170",
}


@pytest.fixture(scope="module")
def found() -> tuple[Row, ...]:
    """The comparison."""
    return rows()


def test_comparison_is_complete(found: tuple[Row, ...]) -> None:
    places = " ".join(row.place for row in found)
    for place in ("table 3", "table 4", "table 5", "fig. 5", "fig. 6", "fig. 7", "concl. (4)", "eq. (30)", "eq. (22)"):
        assert place in places


def test_only_what_is_wrong_in_the_paper_is_contradicted(found: tuple[Row, ...]) -> None:
    assert {row.quantity for row in found if row.status is Status.CONTRADICTED} == WRONG_BY_A_LAW
    on_paper = [row for row in found if row.status is Status.PAPER_ONLY]
    assert {row.quantity for row in on_paper if not row.agrees} == WRONG_IN_ITSELF


def test_what_is_missing_is_named(found: tuple[Row, ...]) -> None:
    missing = [row.quantity for row in found if row.status is Status.NOT_POSSIBLE]
    for word in ("conductivity", "length of the nut", "ends", "time step", "area A", "static rating"):
        assert any(word in quantity for quantity in missing), word


def test_what_was_fitted_is_not_called_reproduced(found: tuple[Row, ...]) -> None:
    for row in found:
        if row.place in ("table 3", "table 4", "fig. 7") and row.law and row.agrees:
            assert row.status is Status.FITTED, row.quantity
    # Nothing of this paper follows from its printed numbers alone: it gives neither steel nor nut.
    assert not [row.quantity for row in found if row.status is Status.REPRODUCED]


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("preload", PRELOADS)
@pytest.mark.parametrize("kind", list(Assumptions))
def test_warm_ups_are_those_of_the_explicit_scheme(kind: Assumptions, preload: int, speed: int) -> None:
    machine, turning = plant(kind, preload), speed * RPM
    parts = discretise(machine.rig, GRID)
    heats = {name: float(heat[0]) for name, heat in machine.heats(np.array([turning])).items()}
    run = run_explicitly(parts, machine.at_speed(turning), heats, machine.feed(turning), 180 * 60.0)
    reduced = warm_up(kind, preload, speed)
    there = np.interp(run.times, 60.0 * reduced.minutes, reduced.nut)
    # Half a unit of the last digit that figure 7 prints, so that the reduction does not decide what a row says.
    assert np.abs(there - run.outputs[:, 0]).max() < 0.005


@pytest.mark.parametrize(
    ("quantity", "status", "text"),
    [
        ("k1 to k6 take from a cell what they give to its neighbour", Status.PAPER_ONLY, "of an exchange"),
        ("volume of a bearing's cell, at its outer surface", Status.PAPER_ONLY, "3.2%"),
        ("settling time at 500 rev/min, three time constants", Status.PAPER_ONLY, "99"),
        ("feed at 750 rev/min, lead 5 mm", Status.PAPER_ONLY, "3.75"),
        ("number of nuts in (22) from (18) to (20)", Status.PAPER_ONLY, "4 in place of 2"),
        ("friction torque grows with preload and speed", Status.ASSUMPTION, "0.0457"),
    ],
)
def test_scheme_and_arithmetic(found: tuple[Row, ...], quantity: str, status: Status, text: str) -> None:
    (row,) = [row for row in found if row.quantity == quantity]
    assert row.status is status
    assert text in row.computed


def test_time_constants_are_compared_at_both_preloads(found: tuple[Row, ...]) -> None:
    constants = [row for row in found if row.quantity.startswith("time constant at")]
    assert len(constants) == 12  # two sets, two preloads, three speeds


@pytest.mark.slow
def test_explicit_scheme_on_the_papers_grid_gives_the_same_rise() -> None:
    machine = plant(Assumptions.FITTED, 670)
    speed = 500 * RPM
    parts = discretise(machine.rig, paper_cells(machine.rig))
    heat = float(machine.heats(np.array([speed]))["nut"][0])
    run = run_explicitly(parts, machine.at_speed(speed), {"nut": heat}, machine.feed(speed), 180 * 60.0)
    assert run.imbalance < 1e-8
    # Averages over a period of 4.8 s; the reduced model on the default grid differs by 2 mK.
    assert run.outputs[-1, 0] == pytest.approx(warm_up(Assumptions.FITTED, 670, 500).rise, abs=0.005)
