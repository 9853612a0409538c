"""Paper 002 (explicit finite-difference thermal analysis): its printed numbers, and what was recomputed from them.

Min, Park, Chung, "Thermal Analysis of Ballscrew Systems by Explicit Finite Difference Method". Printed numbers carry
their table; recomputed ones come from an independent run of the paper's explicit scheme that shares no code with the
package.
"""

from __future__ import annotations

import time

import numpy as np
import pytest

from feeddrive.reproduce.paper_002 import rows
from feeddrive.reproduce.paper_002_sets import PRELOADS, SPEEDS, Assumptions, plant, warm_up
from feeddrive.reproduce.row import Row, Status
from feeddrive.thermal.explicit import run_explicitly
from feeddrive.thermal.full_model import discretise
from feeddrive.thermal.grid import Cells

RPM = 0.10471975511965977
CONTRADICTED = {
    "T_bs at 670 N, 250 rev/min, literally",
    "T_bs at 1300 N, 250 rev/min, literally",
    "T_b(750) - T_b(250) with f0 of an oil bath",
    "heat put in over friction power ωT",
    "heat that node n = 2 loses and its neighbour does not get, over the exchange",
    "T_v in N m",
    "time constant at 1300 N, 250 rev/min",
    "volume of a bearing's cell, at its outer surface",
    "condition of class 8, a cell of the nut, holds C_bsg",
    "number of nuts in (22) from (18) to (20)",
    "unit of a friction torque",
    "viscosities of 32 and 170",
}


@pytest.fixture(scope="module")
def found() -> tuple[Row, ...]:
    """The comparison; 2 s alone on one core, 10 s are asked for."""
    began = time.perf_counter()
    compared = rows()
    assert time.perf_counter() - began < 10.0
    return compared


def test_comparison_is_complete(found: tuple[Row, ...]) -> None:
    places = " ".join(row.place for row in found)
    for place in ("table 3", "table 4", "table 5", "fig. 5", "fig. 6", "fig. 7", "concl. (4)", "eq. (30)", "eq. (22)"):
        assert place in places


def test_only_what_is_wrong_in_the_paper_is_contradicted(found: tuple[Row, ...]) -> None:
    assert {row.quantity for row in found if row.status is Status.CONTRADICTED} == CONTRADICTED


def test_what_is_missing_is_named(found: tuple[Row, ...]) -> None:
    missing = [row.quantity for row in found if row.status is Status.NOT_POSSIBLE]
    for word in ("conductivity", "length of the nut", "ends", "time step", "area A", "static rating"):
        assert any(word in quantity for quantity in missing), word


RECOMPUTED = {
    # The paper's explicit scheme, nut moving; last digit as recomputed.
    (Assumptions.PRINTED, 670): (3.10, 5.19, 7.03),
    (Assumptions.PRINTED, 1300): (6.73, 10.83, 14.22),
    (Assumptions.FITTED, 670): (3.16, 5.18, 6.93),
    (Assumptions.FITTED, 1300): (7.00, 11.02, 14.29),
}


@pytest.mark.parametrize("kind", list(Assumptions))
@pytest.mark.parametrize("preload", PRELOADS)
def test_rises_are_those_of_an_independent_run(kind: Assumptions, preload: int) -> None:
    rises = [warm_up(kind, preload, speed).rise for speed in SPEEDS]
    # A unit of the last digit: the other run has another grid and steps.
    assert rises == pytest.approx(RECOMPUTED[kind, preload], abs=0.011)


def test_time_constants_are_those_of_an_independent_run() -> None:
    printed = [warm_up(Assumptions.PRINTED, 670, speed).time_constant for speed in SPEEDS]
    fitted = [warm_up(Assumptions.FITTED, 670, speed).time_constant for speed in SPEEDS]
    assert printed == pytest.approx([43.2, 33.0, 28.0], abs=0.1)
    assert fitted == pytest.approx([44.8, 33.1, 27.3], abs=0.1)


@pytest.mark.parametrize(
    ("quantity", "status", "text"),
    [
        ("k1 to k6 take from a cell what they give to its neighbour", Status.REPRODUCED, "of an exchange"),
        ("volume of a bearing's cell, at its outer surface", Status.CONTRADICTED, "3.2%"),
        ("settling time at 500 rev/min, three time constants", Status.REPRODUCED, "99"),
        ("feed at 750 rev/min, lead 5 mm", Status.REPRODUCED, "3.75"),
        ("number of nuts in (22) from (18) to (20)", Status.CONTRADICTED, "4 in place of 2"),
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
    parts = discretise(machine.rig, Cells.of_paper(machine.rig))
    heat = float(machine.heats(np.array([speed]))["nut"][0])
    run = run_explicitly(parts, machine.at_speed(speed), {"nut": heat}, machine.feed(speed), 180 * 60.0)
    assert run.imbalance < 1e-8
    # Averages over a period of 4.8 s; the reduced model on the default grid differs by 2 mK.
    assert run.outputs[-1, 0] == pytest.approx(warm_up(Assumptions.FITTED, 670, 500).rise, abs=0.005)
