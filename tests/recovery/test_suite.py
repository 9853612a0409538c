"""The recovery suite itself: what it holds, how it judges, that it goes on where it was stopped, and its bound."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

from tests import state
from tests.generator.effects import EFFECT_CLASSES
from tests.recovery.suite import store
from tests.recovery.suite.bound import fisher
from tests.recovery.suite.cases import OFF_LEAST, OFF_MOST, Case, Kind, all_cases, smoke_cases
from tests.recovery.suite.figures import figures
from tests.recovery.suite.planting import MACHINES, variants
from tests.recovery.suite.table import document
from tests.recovery.suite.verdict import Verdict

MOTION_EFFECTS = {kind.name for kind in EFFECT_CLASSES}


def record(**changes: Any) -> dict[str, Any]:
    """A case in which what was planted was found."""
    made: dict[str, Any] = {
        "label": "backlash 10% bench noise x1", "kind": "single", "machine": "bench", "noise": 1.0, "size": "10%",
        "off": {}, "planted": {"backlash": {"width": 2e-6}}, "ambiguous": [],
        "found": [found("backlash", "transmission", width={"value": 2.1e-6, "ci95": [1.9e-6, 2.3e-6]})],
        "before": {"motor_torque": 0.02}, "after": {"motor_torque": 0.011}, "floor": {"motor_torque": 0.01},
        "floor of": "true plant", "bounds": {"backlash": {"width": 1e-7}}, "cpu": {"diagnosis": 5.0}, "code": "x",
    }  # fmt: skip
    return made | changes


def found(name: str, place: str = "table", **parameters: Any) -> dict[str, Any]:
    """An effect as a record has it."""
    return {"name": name, "place": place, "parameters": parameters}


def test_every_effect_is_planted_at_three_sizes_on_two_machines_with_two_noises() -> None:
    singles = [case for case in all_cases() if case.kind is Kind.SINGLE]
    names = {next(iter(case.planted)) for case in singles}
    assert names >= MOTION_EFFECTS
    for machine in MACHINES:
        for name in variants(machine):
            mine = [case for case in singles if name in case.planted and case.machine == machine]
            # Some effects cannot be made large enough against three times the noise; two sizes are left of those.
            assert len({case.size for case in mine}) >= 2, (machine, name)
            assert {case.noise for case in mine} == {1.0, 3.0}


def test_numbers_of_the_other_cases() -> None:
    cases = all_cases()
    kinds = [case.kind for case in cases]
    assert kinds.count(Kind.NULL) == 40
    assert kinds.count(Kind.OFF) == 20
    assert len({frozenset(case.planted) for case in cases if case.kind is Kind.PAIR}) >= 12
    assert len({case.digest for case in cases}) == len({case.label for case in cases}) == len(cases)
    for case in cases:
        assert all(OFF_LEAST <= abs(factor - 1) <= OFF_MOST for factor in case.off.values())


def test_half_is_balanced() -> None:
    """Of every effect and size one case on each machine of its kind, and one with each noise."""
    half = [case for case in all_cases() if case.kind is Kind.SINGLE and case.in_half]
    for case in half:
        alike = [other for other in half if (*other.planted, other.size) == (*case.planted, case.size)]
        if len(alike) == 2:  # the largest size does not exist everywhere
            assert alike[0].machine != alike[1].machine
            assert {other.noise for other in alike} == {1.0, 3.0}
    assert len(half) == pytest.approx(0.5 * sum(case.kind is Kind.SINGLE for case in all_cases()), abs=1)


def test_smoke_holds_every_effect_once() -> None:
    names = [next(iter(case.planted)) for case in smoke_cases()]
    assert len(names) == len(set(names))
    assert set(names) == {name for machine in MACHINES for name in variants(machine)}


def test_right_needs_the_name_and_the_place() -> None:
    planted = {"friction_deviation": {"port": "screw", "coulomb_factor": 1.2}}
    assert Verdict(record()).right
    assert Verdict(record(planted=planted, found=[found("friction_deviation", "screw")])).right
    assert not Verdict(record(planted=planted, found=[found("friction_deviation", "table")])).right
    assert not Verdict(record(found=[found("backlash"), found("stribeck")])).right
    assert not Verdict(record(found=[])).right


def test_a_set_counts_only_if_it_is_small_and_led_by_what_was_found() -> None:
    instead = [found("preload_loss")]
    small, large = ["preload_loss", "backlash"], ["preload_loss", "a", "b", "backlash"]
    assert Verdict(record(found=instead, ambiguous=[small])).right_in_sets
    assert not Verdict(record(found=instead, ambiguous=[large])).right_in_sets
    assert not Verdict(record(found=instead)).right_in_sets
    assert not Verdict(record(found=[found("stribeck")], ambiguous=[small])).right_in_sets
    assert Verdict(record(found=instead, ambiguous=[small])).set_size == 2


def test_interval_and_its_width_over_the_bound() -> None:
    (interval,) = Verdict(record()).intervals
    assert interval.inside
    assert interval.width == pytest.approx(2.0)
    (outside,) = Verdict(record(planted={"backlash": {"width": 2.4e-6}})).intervals
    assert not outside.inside


def test_phase_is_compared_around_the_circle() -> None:
    span = {"value": 3.1, "ci95": [3.0, 3.2]}
    ripple = found("torque_ripple", "motor", phase=span)
    verdict = Verdict(record(planted={"torque_ripple": {"phase": -3.15}}, found=[ripple], bounds={}))
    assert [interval.inside for interval in verdict.intervals] == [True]


def test_names_that_say_what_is_off_are_not_false() -> None:
    off = {"table_mass": 1.1, "torsional_stiffness": 0.9}
    verdict = Verdict(record(kind="off", planted={}, off=off, found=[found("payload"), found("stribeck")]))
    assert verdict.false_names == ["stribeck"]
    led = Verdict(record(kind="off", planted={}, off=off, found=[found("x")], ambiguous=[["x", "payload"]]))
    assert led.false_names == []


def test_figures_say_short_where_they_are() -> None:
    held = {figure.what: figure.met for figure in figures([Verdict(record())])}
    assert held["one effect, the two larger sizes: named right"]
    missed = {figure.what: figure.met for figure in figures([Verdict(record(found=[]))])}
    assert missed["one effect, the two larger sizes: named right"] is False
    alarm = Verdict(record(kind="null", planted={}, size=""))
    alarms = {figure.what: figure.met for figure in figures([alarm, alarm])}
    assert alarms["nothing planted: false alarms"] is False


def test_table_names_the_part_that_was_run() -> None:
    cases = all_cases()
    text = document(cases, [Verdict(record()), Verdict(record(found=[], label="missed one"))])
    assert f"**2 of {len(cases)} cases**" in text
    assert "| missed one | nothing |" in text
    assert "are of this part only" in text


def test_a_run_goes_on_where_it_was_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cases, done, said = all_cases()[:3], [], []

    def run(case: Case) -> dict[str, Any]:
        if len(done) == 2:
            raise KeyboardInterrupt
        done.append(case.label)
        return record(label=case.label)

    monkeypatch.setattr(store, "run", run)
    with pytest.raises(KeyboardInterrupt):
        store.run_missing(cases, tmp_path, 1, said.append)
    assert len(list(tmp_path.iterdir())) == 2  # whole files of what was done, nothing of the third
    done.clear()
    assert store.run_missing(cases, tmp_path, 1, said.append) == 1
    assert store.run_missing(cases, tmp_path, 1, said.append) == 0
    path = store.file_of(tmp_path, cases[0])
    path.write_text(json.dumps(json.loads(path.read_text()) | {"code": "another"}))
    assert store.kept(tmp_path, cases[0], store.code_state()) is None


def test_state_changes_with_all_that_can_change_a_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = {path.relative_to(store.ROOT).as_posix() for path in store.state_files()}
    folders = (*(f"feeddrive/{part}" for part in ("diagnosis/", "servo/", "simulate/", "unit")), "tests/generator/",
               "tests/recovery/suite/", "plants/")  # fmt: skip
    for folder in folders:
        assert any(name.startswith(folder) for name in names), folder
    (driver, *_) = sorted(name for name in names if name.endswith(".c"))
    assert not any(name.split("/")[1] in store.NOT_USED for name in names if name.startswith("feeddrive/"))
    kept = tmp_path / "tree"
    for name in names:
        (kept / name).parent.mkdir(parents=True, exist_ok=True)
        (kept / name).write_bytes((store.ROOT / name).read_bytes())
    monkeypatch.setattr(store, "ROOT", kept)
    before = store.code_state()
    for name in (driver, "plants/bench_axis.toml", "tests/generator/motion.py"):
        text = (kept / name).read_bytes()
        (kept / name).write_bytes(text + b"\n")
        assert store.code_state() != before, name
        (kept / name).write_bytes(text)
    assert store.code_state() == before
    monkeypatch.setattr(state, "version", lambda library: "0")
    assert store.code_state() != before


def test_what_the_state_leaves_out_is_not_imported() -> None:
    code = "import sys, tests.recovery.suite.one; print(*sorted(sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], cwd=store.ROOT, capture_output=True, text=True, check=True)
    assert [name for name in run.stdout.split() if name.split(".")[:1] == ["feeddrive"] and len(name.split(".")) > 1
            and name.split(".")[1] in store.NOT_USED] == []  # fmt: skip


def test_records_of_two_states_make_no_table() -> None:
    with pytest.raises(ValueError, match="2 states"):
        document(all_cases(), [Verdict(record()), Verdict(record(code="another"))])


def test_bound_is_that_of_least_squares_in_white_noise_of_the_band(generator: np.random.Generator) -> None:
    count, rate = 40000, 500.0
    noise = 0.3 * generator.standard_normal(count)
    time = np.arange(count) / rate
    slopes = np.column_stack([np.sin(2 * np.pi * 20 * time), np.cos(2 * np.pi * 60 * time)])
    information = fisher(slopes, noise, rate, 100.0)
    # A sine of size 1 in white noise: n / (2 sigma^2). 0.1: a density of 80 segments scatters by 11 % a line.
    assert np.diag(information) == pytest.approx(count / 2 / 0.09, rel=0.1)
    assert abs(information[0, 1]) < 0.01 * information[0, 0]


def test_bound_counts_the_colour(generator: np.random.Generator) -> None:
    count, rate = 40000, 500.0
    coloured = lfilter([1.0], [1.0, -0.9], generator.standard_normal(count))
    time = np.arange(count) / rate
    for frequency in (5.0, 50.0, 150.0):
        slope = np.sin(2 * np.pi * frequency * time)[:, None]
        gain = 1 / abs(1 - 0.9 * np.exp(-2j * np.pi * frequency / rate))
        # The density of the filter at the sine, again to the scatter of its estimate.
        assert fisher(slope, coloured, rate, 200.0)[0, 0] == pytest.approx(count / 2 / gain**2, rel=0.15)


def test_bound_leaves_out_what_is_beyond_the_band(generator: np.random.Generator) -> None:
    time = np.arange(5000) / 500.0
    slope = np.sin(2 * np.pi * 200 * time)[:, None]
    assert fisher(slope, generator.standard_normal(5000), 500.0, 100.0)[0, 0] < 1.0  # of 2500 inside
