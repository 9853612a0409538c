"""The table of machines of parts: what counts as right, and where it stands on its page."""

from __future__ import annotations

from typing import Any

import pytest

from tests.recovery.page import with_section, with_sections_of
from tests.recovery.parts.__main__ import KINDS, asked, main
from tests.recovery.parts.cases import MACHINES, NULLS, WHAT, Case
from tests.recovery.parts.responses import ResponseCase, ResponseRow
from tests.recovery.parts.run import Row
from tests.recovery.parts.table import section


def record(what: str, found: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    """A record of a case of the first machine, with noise of one left in each channel."""
    case = Case(MACHINES[0], what, 0)
    _, name, values = case.planted
    kept = {"key": case.key, "state": "abc", "machine": case.machine, "what": what, "draw": 0, "name": name}
    channels = {"motor_torque": 1.0, "table_position": 1.0}
    told = {"found": found, "ambiguous": [], "notes": [], "calibrated": {}, "tables": 0, "cpu": 1.0, "outcome": "done"}
    return kept | told | {"values": values, "after": channels, "floor": channels} | more


def effect(name: str, place: str = "", **values: float) -> dict[str, Any]:
    told = {key: {"value": value, "ci95": [0.99 * value, 1.01 * value]} for key, value in values.items()}
    return {"name": name, "place": place, "parameters": told}


def test_every_case_is_drawn_and_named() -> None:
    for machine in MACHINES:
        for what in WHAT:
            changes, name, values = Case(machine, what, 3).planted
            assert bool(changes) == bool(name) == bool(values) == (what != "nothing")
            assert Case(machine, what, 3).planted == (changes, name, values)


def test_what_is_right() -> None:
    width = Case(MACHINES[0], "backlash", 0).planted[2]["width"]
    assert Row(record("nothing", [])).right and not Row(record("nothing", [effect("backlash", width=1e-6)])).right
    assert not Row(record("backlash", [])).right
    good = Row(record("backlash", [effect("backlash", width=1.02 * width)]))
    assert good.right and [ok for *_, ok in good.values()] == [True]
    assert [ok for *_, ok in Row(record("backlash", [effect("backlash", width=1.1 * width)])).values()] == [False]
    assert not Row(record("backlash", [effect("backlash", width=width), effect("payload", mass=1.0)])).right
    other = [effect("preload_loss", force=1.0)]
    assert not Row(record("backlash", other)).right
    assert Row(record("backlash", other, ambiguous=[["preload_loss", "backlash"]])).right
    assert Row(record("nothing", [], after={"motor_torque": 1.3, "table_position": 1.0})).at_floor is False


@pytest.mark.parametrize(("low", "high", "right"), [(0.7, 0.9, True), (0.85, 1.1, False)])
def test_a_part_within_its_tolerance_is_held_by_the_interval(low: float, high: float, right: bool) -> None:
    one = record("nut", [], calibrated={"nut_stiffness": {"value": 0.8, "ci95": [low, high]}})
    assert Row(one).right is right
    assert Row(record("nut", [effect("stiffness_deviation", "nut", factor=0.8)])).right
    assert not Row(record("nut", [effect("stiffness_deviation", "drive", factor=0.8)])).right


def response(what: str, **more: Any) -> dict[str, Any]:
    """A record of a frequency response in which everything is right."""
    case = ResponseCase(MACHINES[1], what, 0)
    told = {"planted": [], "found": [], "values": [], "frequency_off": [0.001, -0.002], "stiffness_off": 0.01}
    kept = {"key": case.key, "kind": case.kind, "state": "abc", "machine": case.machine, "what": what, "draw": 0}
    return kept | told | {"error": 0.02, "scatter": 0.02, "outcome": "done", "cpu": 30.0} | more


def test_what_is_right_of_a_response() -> None:
    assert ResponseRow(response("nothing")).right
    assert not ResponseRow(response("nothing", found=[{"name": "table.mass"}])).right
    assert not ResponseRow(response("nothing", frequency_off=[0.001, -0.006])).right
    assert not ResponseRow(response("nothing", stiffness_off=0.04)).right
    assert not ResponseRow(response("nothing", error=0.03)).right
    assert not ResponseRow(response("mode")).right
    mode = response("mode", found=[{"name": "structural_mode"}], values=[["frequency", 80.0, 79.0, 81.0]])
    assert ResponseRow(mode).right and "frequency 80 [79, 81]" in ResponseRow(mode).line


def test_the_whole_table_has_every_kind_and_begins_with_the_cheap() -> None:
    whole = asked(200)
    assert len({case.key for case in whole}) == len(whole)
    kinds = [case.kind for case in whole if case.what == "nothing"]
    assert [kinds.count(kind) for kind in KINDS] == [NULLS, NULLS, len(MACHINES)]
    planted = {(case.kind, case.what) for case in whole if case.what != "nothing"}
    assert planted == {("recording", what) for what in WHAT[1:]} | {("response", "mode")}
    assert max(case.cost for case in whole if case.what == "nothing") < min(
        case.cost for case in whole if case.what == "backlash"
    )
    assert {case.what for case in asked(3, 1, ["payload"])} == {"payload"}
    part = section([record("nothing", []), record("nothing", [], kind="lumped"), response("mode")])
    assert f"3 of {len(whole)} cases" in part and part.count("\n| --- |") == 4
    with pytest.raises(SystemExit):
        main(["--out", "nowhere", "--what", "backslash"])


def test_sections_stand_beside_each_other() -> None:
    part = section([record("nothing", []), record("backlash", [])])
    page = with_section("# Recovery\n\n<!-- fleet -->\nother\n<!-- end of fleet -->\n", part)
    assert page.count("<!-- parts -->") == 1 and "other" in page
    assert with_section(page, part) == page
    again = with_sections_of("# Recovery\n\nanew\n", page)
    assert "anew" in again and "other" in again and "## Machines described by their parts" in again
