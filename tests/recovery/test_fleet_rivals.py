"""Rivals of the fleet: one case that all of them meet, what counts as named, and the table."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from tests.recovery.fleet.case import Case, case
from tests.recovery.fleet_rivals.run import RESULTS, at_the_motor, named_by_regression, of_case, rivals_done, run_rivals
from tests.recovery.fleet_rivals.table import earlier, section
from tests.recovery.page import with_section
from tests.recovery.suite.rivals import installed

NULL = 10
"""Seed of a quick case with nothing planted."""


@pytest.fixture(scope="module")
def null() -> Case:
    return case(NULL)


def record(kind: str = "single", planted: tuple[dict[str, object], ...] = ()) -> dict[str, object]:
    truth = {"kind": kind, "planted": list(planted), "may": [], "spoiling": "", "rows": [2000, 1000], "rate_hz": 100.0}
    found = [{"name": "payload", "place": "", "asserted": True, "parameters": {}}] if planted else []
    return {
        "seed": NULL, "state": "abc", "outcome": "done", "truth": truth, "found": found, "ambiguous": [], "cpu": 2.0,
        "floor": {"motor_torque": 0.1, "table_position": 1e-8}, "band": {"motor_torque": 50.0, "table_position": 50.0},
        "before": {"motor_torque": 0.4, "table_position": 1e-8}, "after": {"motor_torque": 0.1, "table_position": 1e-8},
    }  # fmt: skip


PAYLOAD = {"name": "payload", "place": "", "relative": False, "values": {"mass": 9.0}}


def rivals(terms: list[str]) -> dict[str, object]:
    after = {"motor_torque": 0.3, "table_position": 1e-8}
    kept = {"motor_torque": len(terms), "table_position": 0}
    return {"sparse": {"after": after, "terms": {"motor_torque": terms}, "kept": kept}, "black box": {"after": after}}


@pytest.mark.skipif(not installed(), reason="PySINDy and scikit-learn are in the recovery extra")
def test_a_case_is_met_by_regression_and_black_box(null: Case) -> None:
    """Both have an error of the judged recording for each of its channels."""
    found = of_case(null, None, 10.0)
    channels = {"motor_torque"} | ({"table_position"} if null.declared.scale else set())
    assert set(found["sparse"]["after"]) == set(found["black box"]["after"]) == channels
    assert all(error > 0 for key in ("sparse", "black box") for error in found[key]["after"].values())


def test_the_terms_are_of_the_motors_angle(null: Case) -> None:
    """A belt makes the table move less for a radian of the motor than for one of the screw."""
    geared = dataclasses.replace(null, declared=dataclasses.replace(null.declared, axis=dataclasses.replace(
        null.declared.axis, ratio=2.5)))  # fmt: skip
    assert at_the_motor(geared).transmission == pytest.approx(geared.declared.radius, rel=1e-12)


@pytest.mark.parametrize(("terms", "named"), [(["a", "x"], {"payload"}), (["x", "v"], set())])
def test_a_regression_names_what_one_of_its_terms_is(terms: list[str], named: set[str]) -> None:
    assert named_by_regression(record(planted=(PAYLOAD,)), rivals(terms)["sparse"]) == named  # type: ignore[arg-type]


def test_what_the_earlier_method_said_is_asked_the_same() -> None:
    """Its names and its errors beside the truth and the floor of the case."""
    said = {
        "outcome": "done",
        "cpu": 9.0,
        "found": [],
        "ambiguous": [],
        "after": {"motor_torque": 0.4, "table_position": 1e-8},
    }
    verdict = earlier(record(planted=(PAYLOAD,)), {"previous": said | {"before": {}, "band": {}}})
    assert not verdict.right and verdict.over_floor == pytest.approx(4.0) and verdict.record["cpu"] == 9.0
    refused = earlier(record(planted=(PAYLOAD,)), {"previous": {"outcome": "refused", "cpu": 1.0}})
    assert not refused.done and not refused.asserted


def test_the_table_sets_all_of_them_side_by_side() -> None:
    one = record(planted=(PAYLOAD,))
    text = section([one], {NULL: rivals(["a"]) | {"previous": {"outcome": "time limit", "cpu": 99.0}}}, "commit")
    assert "| planted, 1 cases: error after over the floor, median | 1.00 | 3.00 | 3.00 |" in text
    assert "| planted effects that are named | 1/1 | 1/1 | none |" in text
    assert "| one effect, the catalogue's law: exactly right | 1/1 (21 to 100 %) | 0/1 (0 to 79 %) |" in text
    page = with_section("# Recovery\n", text)
    assert with_section(page, text) == page  # its marks are found again


def test_a_case_that_is_there_is_not_run_again(tmp_path: Path) -> None:
    (tmp_path / RESULTS).write_text('{"seed": 10, "state": "abc"}\n{"seed": 11, "sta', encoding="utf-8")
    said: list[str] = []
    run_rivals([record()], tmp_path, None, 10.0, 0.0, said.append)
    assert said == [] and set(rivals_done(tmp_path)) == {10}
