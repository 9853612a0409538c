"""Drive parameters: what is written is read back as the same loop, and its numbers mean what the makers say."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.errors import InputError
from feeddrive.interface.servo import Servo
from feeddrive.servo.linear_loop import open_position_loop, open_velocity_loop, worst_eigenvalue
from feeddrive.servo.margins import margins
from feeddrive.tuning.demand import operating_points
from feeddrive.tuning.drive_forms import heidenhain, linuxcnc, sinamics
from feeddrive.tuning.drive_forms.drive_file import WRITERS, read_drive_file
from feeddrive.tuning.drive_forms.parameter import Facts, LoopSettings
from feeddrive.tuning.drive_settings import DriveSettings, drive_settings, facts_of
from feeddrive.tuning.filter_choice import FilterChoice

SHIPPED = ("bench_axis", "light_axis", "hsr_axis", "kimm_testbed", "vertical_axis")
RULE = {"bench_axis": 770.3, "light_axis": 234.9, "hsr_axis": 2023.0, "kimm_testbed": 2784.0, "vertical_axis": 1274.0}
"""K_p/T_n [N m/rad] at the same margins and cases, of the largest that also keeps T_n >= 4 J/K_p: the rule in use
before, with a notch of fixed widths at the resonance that limits."""
FACTS = Facts(0.02 / (2 * math.pi), 1.5, 8000.0, 2000.0)
LOOP = LoopSettings(2.345678, 0.00345678, 87.654, (FilterChoice("notch", 512.0, 0.125, 12.0),))


@pytest.fixture(scope="module")
def servo() -> Servo:
    tuned: Servo = fd.tune(fd.load("bench_axis"))
    return replace(tuned, plant=replace(tuned.plant, torque_constant=1.5))


def _read_back(servo: Servo, typed: DriveSettings, path: Path) -> None:
    path.write_text(typed.text, encoding="utf-8")
    read = read_drive_file(path, typed.form, facts_of(servo.plant, servo.cascade)).on(servo.cascade)
    assert read == typed.cascade  # every digit: both come from the numbers as typed
    for one in typed.reached:
        plant = one.case.on(servo.plant)
        for make in (open_velocity_loop, open_position_loop):
            there = margins(make(plant, read, one.case.velocity, one.case.position))
            # 20000 points where the search has 4000: near a resonance a few hundredths
            assert there.stable and there.phase > 45 - 0.1 and there.gain > 8 - 0.05
        assert worst_eigenvalue(plant, read, one.case.velocity, one.case.position)[1] < 0.1


@pytest.mark.parametrize("form", sorted(WRITERS))
def test_what_is_written_reads_back_as_the_loop(form: str, servo: Servo, tmp_path: Path) -> None:
    typed = servo.to_drive(form)
    _read_back(servo, typed, tmp_path / "drive.txt")
    for line in typed.lines:
        steps = line.typed / line.parameter.resolution
        assert steps == pytest.approx(round(steps), abs=1e-6) and line.parameter.source
        assert f"{line.parameter.name} " in typed.text and line.text in typed.text
    assert "they hold at: table at 0 mm, at 3 m/min, at rest without friction and at rest with" in typed.text


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_every_form_on_every_shipped_axis(name: str, tmp_path: Path) -> None:
    tuned = fd.tune(fd.load(name), payload=["0 kg", "50 kg"])
    whole = replace(tuned, plant=replace(tuned.plant, torque_constant=1.5))
    for form in WRITERS:
        _read_back(whole, whole.to_drive(form), tmp_path / f"{form}.txt")


@pytest.mark.parametrize("name", ["bench_axis", *(pytest.param(one, marks=pytest.mark.slow) for one in SHIPPED[1:])])
def test_more_integral_gain_at_the_same_margins(name: str) -> None:
    tuned = fd.tune(fd.load(name))
    assert {one.case for one in tuned.recommendation.reached} == set(operating_points(tuned.plant))
    for one in tuned.recommendation.reached:
        assert min(one.velocity.phase, one.position.phase) >= 45 and min(one.velocity.gain, one.position.gain) >= 8
    assert tuned.velocity_gain / tuned.reset_time >= 1.1 * RULE[name]


def test_sinamics_filter_is_the_manuals_transfer_function() -> None:
    """Band-stop of defined depth: Dn = B / 2f, Dz = Dn 10^(K/20), one frequency."""
    lines = {line.parameter.name: line.typed for line in sinamics.lines(LOOP, FACTS)}
    assert lines["p1460[0]"] == 2.3456 and lines["p1462[0]"] == 3.46  # down and up: the safe sides
    assert lines["MD32200"] == 5.2592  # 87.654 * 60 / 1000, down
    assert lines["p1656[0]"] == 1 and lines["p1657[0]"] == 2
    f, dn, fz, dz = (lines[f"p{number}[0]"] for number in (1658, 1659, 1660, 1661))
    frequency = np.geomspace(50, 3000, 60, dtype=np.float64)
    s = 2j * math.pi * frequency
    w, wz = 2 * math.pi * f, 2 * math.pi * fz
    manual = ((s / wz) ** 2 + 2 * dz * s / wz + 1) / ((s / w) ** 2 + 2 * dn * s / w + 1)
    (read,) = sinamics.settings(lines, FACTS).filters
    np.testing.assert_allclose(np.abs(read.filter.response(frequency) / manual - 1), 0, atol=1e-12)
    np.testing.assert_allclose(np.abs(LOOP.filters[0].filter.response(frequency) - manual), 0, atol=5e-3)  # 0.001 of D


@pytest.mark.parametrize("choice", [FilterChoice("notch", 525.0, 0.26), FilterChoice("PT2", 900.0, 0.7)])
def test_linuxcnc_filter_is_that_of_its_biquad(choice: FilterChoice) -> None:
    """The published component: alpha = sin(w)/(2 Q) in the usual bilinear notch and low-pass."""
    lines = {one.parameter.name: one.typed for one in linuxcnc.lines(replace(LOOP, filters=(choice,)), FACTS)}
    tick = 1 / FACTS.velocity_rate
    w, q = 2 * math.pi * lines["biquad.torque-0.f0"] * tick, lines["biquad.torque-0.Q"]
    assert 0.5 <= q <= 2
    alpha, c = math.sin(w) / (2 * q), math.cos(w)
    low_pass = lines["biquad.torque-0.type"] == 1
    b = [(1 - c) / 2, 1 - c, (1 - c) / 2] if low_pass else [1.0, -2 * c, 1.0]
    published = np.array([*b, -2 * c, 1 - alpha]) / (1 + alpha)
    (read,) = linuxcnc.settings(lines, FACTS).filters
    np.testing.assert_allclose(read.filter.discrete(tick), published, rtol=1e-9)


def test_linuxcnc_and_heidenhain_count_as_their_units_say() -> None:
    """A speed error of 1 mm/s, or of 1 rev/s, asks for the torque that K_p asks for."""
    bare = replace(LOOP, filters=())
    hal = {one.parameter.name: one.typed for one in linuxcnc.lines(bare, FACTS)}
    speed = 1e-3 / FACTS.radius  # of the motor at 1 mm/s [rad/s]
    assert hal["pid.velocity.Pgain"] == pytest.approx(LOOP.velocity_gain * speed, abs=1e-6)
    assert hal["pid.velocity.Igain"] == pytest.approx(LOOP.velocity_gain / LOOP.reset_time * speed, rel=1e-6)
    tnc = {one.parameter.name: one.typed for one in heidenhain.lines(bare, FACTS)}
    assert tnc["MP2500.0"] * 1.5 == pytest.approx(LOOP.velocity_gain * 2 * math.pi, abs=2e-3)
    assert tnc["MP2500.0"] / tnc["MP2510.0"] == pytest.approx(LOOP.reset_time, rel=1e-3)
    with pytest.raises(InputError, match="torque constant is not declared"):
        heidenhain.lines(bare, replace(FACTS, torque_constant=None))


def test_a_notch_wider_than_an_octave_is_written_as_the_low_pass_that_it_is(servo: Servo) -> None:
    wide = FilterChoice("notch", 1310.0, 1300 / (2 * 1310.0), 20.0)
    found = servo.recommendation
    handed = replace(found, velocity=replace(found.velocity, filters=(wide,)))
    typed = drive_settings(servo.plant, handed, "sinamics")
    assert "a notch at 1310 Hz that is 1300 Hz wide is a low-pass" in typed.text
    types = [line.typed for line in typed.lines if line.parameter.name in ("p1657[0]", "p1662[0]")]
    notches = [one for one in typed.cascade.torque_filters if one.kind == "notch"]
    widths = [one.denominator[1] / (2 * math.pi * one.frequency) for one in notches]
    assert len(types) == len(typed.cascade.torque_filters) and all(width < 0.71 for width in widths)


def test_present_settings_are_read_and_what_would_change_is_told(servo: Servo, tmp_path: Path) -> None:
    path = tmp_path / "now.txt"
    path.write_text("p1460[0] = 2.0 ; old\np1462[0] = 10\nMD32200 = 3\np1656[0] = 1\np1657[0] = 2\np1658[0] = 1310\n"
                    "p1659[0] = 0.496\np1660[0] = 1310\np1661[0] = 0.05\n", encoding="utf-8")  # fmt: skip
    retuned = servo.compare(path, "sinamics")
    assert retuned.present.velocity_gain == 2.0 and retuned.present.reset_time == 0.01
    assert [row[0] for row in retuned.changes] == ["K_p", "T_n", "K_p/T_n", "K_v", "filter 1"]
    assert any("1310 Hz that is 1300 Hz wide is a low-pass" in text for text in retuned.remarks)
    first = retuned.brings[0]
    assert first["before"]["velocity loop, phase margin"] < 10 < 45 <= first["after"]["velocity loop, phase margin"]
    assert first["after"]["circle, deviation"] < first["before"]["circle, deviation"]
    assert len(retuned.figures()) >= 3 and "circle, deviation" in repr(retuned)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("p1460[0] = x", "is no number, line|is no number"),
        ("p1460[0] = 1\np1460[0] = 2", "is set twice"),
        ("p9999 = 1", "unknown parameter"),
        ("p1460[0] = 1\nMD32200 = 3", r"p1462\[0\] is missing"),
        ("p1460[0] = -1", "is outside 0 to"),
        ("p1460[0] = nan", "is outside 0 to"),
        ("p1460[0] = 1\np1462[0] = 10\nMD32200 = 3\np1656[0] = 1\np1657[0] = 2\np1658[0] = 500\np1659[0] = 0.2\n"
         "p1660[0] = 700\np1661[0] = 0.01", "make no notch"),
    ],
)  # fmt: skip
def test_a_file_that_is_wrong_is_told_in_one_line(lines: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "drive.txt"
    path.write_text(lines, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_drive_file(path, "sinamics", FACTS)


def test_unknown_and_unpublished_forms_are_refused(servo: Servo) -> None:
    with pytest.raises(InputError, match="did you mean"):
        servo.to_drive("sinamic")
    with pytest.raises(InputError, match="in no public page"):
        servo.to_drive("fanuc")


def test_a_rigid_axis_is_at_its_limit() -> None:
    """EMPS has no resonance and needs no filter: the closed form of a mass behind a delay is the most there is."""
    tuned = fd.tune(fd.load("emps"))
    assert not tuned.cascade.torque_filters
    delay = 125e-6 + 125e-6 + 1 / (2 * math.pi * 1000)  # hold and difference are a tick; dead time; lag
    ratios = np.linspace(1.5, 8.0, 2000)  # w T_n
    best = tuned.cascade.feed_forward.inertia * np.max((math.pi / 4 - np.arctan(1 / ratios)) ** 2 / ratios) / delay**2
    # the lag taken as a delay turns the phase by 2 deg of 30 too much: 12 % of w^2
    assert 0.97 * best < tuned.velocity_gain / tuned.reset_time < 1.15 * best
