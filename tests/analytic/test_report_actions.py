"""The part of the report that says what to do: its order, its figures, and what it does with strange names."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape

import numpy as np

import feeddrive as fd
from feeddrive.bench_page.page import bench_of_diagnosis
from feeddrive.compensation.actions import Actions, actions, values_to_set
from feeddrive.compensation.compensate import Prediction, Wishes, plant_table
from feeddrive.compensation.cures import CURES, ORDER, cure, in_order
from feeddrive.compensation.predicted_accuracy import Figures
from feeddrive.diagnosis.judging.result import Diagnosis, EffectResult, ParameterResult
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.metrology.circular import circular
from feeddrive.metrology.positioning import positioning
from feeddrive.report.pages.html import report_page
from feeddrive.report.pages.section_actions import actions_section
from tests.analytic.report_examples import recording


def _effect(name: str, key: str, value: float, unit: str, carries: bool = True) -> EffectResult:
    return EffectResult(name, {key: ParameterResult(value, unit)}, {}, carries, "evidence")


EFFECTS_FOUND = (
    _effect("lead_error_cumulative", "slope", 20e-6, "m/m"),
    _effect("payload", "mass", 20.0, "kg"),
    _effect("backlash", "width", 7.5e-6, "m"),
)


def _diagnosis(*effects: EffectResult) -> Diagnosis:
    return Diagnosis("bench axis", (), (), (), effects, (), (), (), {}, (), (recording(4000, 1, "a"),))


def _figures(size: float) -> Figures:
    target = np.linspace(0.0, 0.4, 5)
    up, down = (np.column_stack([way * size * np.ones(5)] * 2) for way in (-0.5, 0.5))
    angle = np.linspace(0, 2 * np.pi * 1.001, 4000)
    position = 0.05 * np.sin(angle) + size * np.sign(angle - 3)
    return Figures(positioning(target, up, down), circular(angle, position, 0.05))


def _predicted() -> Actions:
    worn = fd.load("bench_axis").with_effects(fd.effect("backlash", width="7.5 um")).plant
    made = plant_table(worn, Wishes("csv", stroke=(0.0, 0.4)))
    both = Prediction(_figures(7.5e-6), _figures(1e-9), _figures(0.4e-6))
    return Actions(tuple(in_order([one.name for one in EFFECTS_FOUND])), replace(made, prediction=both))


def test_worn_parts_come_first_then_settings_then_tables() -> None:
    assert in_order([one.name for one in EFFECTS_FOUND]) == ["backlash", "payload", "lead_error_cumulative"]
    page = actions_section(_diagnosis(*EFFECTS_FOUND), _predicted())
    places = [page.index(words) for words in ("1. Look at", "2. Set", "3. Compensate", "Predicted")]
    assert places == sorted(places)
    assert "feeddrive compensate FOLDER (of this report) --form linuxcnc" in page


def test_figures_stand_before_after_repair_and_after_compensation() -> None:
    page = actions_section(_diagnosis(*EFFECTS_FOUND), _predicted())
    row = page[page.index("reversal value B") :].split("</tr>")[0]
    shown = [re.sub("<[^>]*>", "", cell) for cell in row.split("</td>")[1:4]]
    assert [text.replace("\N{NO-BREAK SPACE}", " ") for text in shown] == ["7.50 µm", "0.00100 µm", "0.400 µm"]
    assert "wind-up" in page


def test_values_to_set_are_those_of_the_machine() -> None:
    """By hand: a lead of 20 mm longer by 40 um/m, 100 kg of table with 20 kg on it, 200 N through 20 mm / 2 pi."""
    machine = fd.load("bench_axis")
    mass = machine.plant.chain_values()["table_mass"]
    found = values_to_set(machine.with_effects(
        fd.effect("lead_error_cumulative", slope="40 um/m"), fd.effect("payload", mass="20 kg"),
        fd.effect("constant_force", force="200 N"), fd.effect("backlash", width="7.5 um"),
    ).plant)  # fmt: skip
    assert found["lead_error_cumulative"] == "20.0008 mm per revolution, not 20 mm"
    assert found["payload"] == f"moving mass {mass + 20:.4g} kg"
    assert found["constant_force"].startswith("torque offset 0.636")
    assert "backlash" not in found  # 200 N are more than the friction: they hold the table on one flank
    free = values_to_set(machine.with_effects(fd.effect("backlash", width="7.5 um")).plant)
    assert free["backlash"].endswith("7.5 \N{MICRO SIGN}m")
    page = actions_section(_diagnosis(*EFFECTS_FOUND), replace(_predicted(), set_to=found))
    assert "20.0008 mm per revolution" in page and "Next experiment" in page


def test_bench_is_a_tab_that_is_there_only_where_there_is_one() -> None:
    found = _diagnosis(*EFFECTS_FOUND)
    alone = report_page(found, ())
    assert "<iframe" not in alone and 'id="tab-bench"' not in alone
    axis = fd.load("bench_axis").with_effects(fd.effect("backlash", width="7.5 um"))
    bench = bench_of_diagnosis(axis.plant, found)
    both = report_page(found, (), bench=bench)
    assert both.count("<iframe") == 1 and "<script" not in both  # scripts stand in the frame alone, escaped
    inside = unescape(both[both.index("srcdoc=") + 8 : both.index('"></iframe>')])
    assert inside == bench and "default-src 'none'" in inside
    # nothing found, a rigid machine, heat alone: no bench
    assert bench_of_diagnosis(axis.plant, _diagnosis()) == ""
    assert bench_of_diagnosis(fd.load("emps").plant, found) == ""
    assert bench_of_diagnosis(fd.load("thermal_bench").plant, found) == ""


def test_nothing_found_is_nothing_to_do() -> None:
    assert actions_section(_diagnosis(), None) == ""
    assert actions_section(_diagnosis(), actions(_diagnosis(), fd.load("bench_axis").plant)) == ""


def test_what_is_not_confirmed_and_not_predicted_is_said() -> None:
    found = _diagnosis(_effect("backlash", "width", 7.5e-6, "m", carries=False))
    page = actions_section(found, Actions(("backlash",), None, "a reason <b>"))
    assert "not confirmed" in page
    assert "Not predicted: a reason &lt;b&gt;." in page


def test_a_plant_that_cannot_be_predicted_says_why() -> None:
    """The wind-up alone, called backlash by mistake: the report says what the command says."""
    found = actions(_diagnosis(_effect("backlash", "width", 7.5e-6, "m")), fd.load("bench_axis").plant)
    assert found.predicted is None
    assert "wind-up, not play" in found.why_not


def test_stroke_is_that_of_the_recording_where_none_is_declared() -> None:
    found = _diagnosis().recorded_stroke
    assert found is not None
    position = recording(4000, 1, "a").variables["table_position"]
    assert found == (np.nanmin(position), np.nanmax(position))
    low, high = found
    wider = replace(_diagnosis(), fitted_stroke=(low - 0.1, high - 0.01)).recorded_stroke
    assert wider == (low - 0.1, high)  # what was fitted was recorded too


def test_every_effect_has_a_cure_or_is_left_to_the_plant_file() -> None:
    known = {*EFFECTS, *THERMAL_EFFECTS}
    assert set(CURES) <= known
    assert all(cure(name).kind in ORDER for name in known)
    assert {cure(name).form for name in known} <= {"", "table", "heat", "friction", "cogging"}
