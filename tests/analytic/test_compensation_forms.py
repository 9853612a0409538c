"""Every form of compensation table against what its control's documents say, read back by readers of their own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.compensation.applied import AxisLimits, motor_setpoint, ramped
from feeddrive.compensation.forms.all_forms import FORMS, HEAT, as_held, control
from feeddrive.compensation.forms.control import checked_axis
from feeddrive.compensation.table import CompensationTable, Deviations, fitted, grid, measured
from feeddrive.errors import InputError
from tests.analytic import compensation_readers as read

REFERENCE, STEP, PLAY = 0.1, 0.01, 6e-6
HOSTILE = "X\n$MA_BACKLASH[0,X1]=9\r; *) (* M30 % \x1b[31m\u202e\u00e4\N{MICRO SIGN}"
TABLES = [form for form in FORMS if form != HEAT]


def lead(p: np.ndarray) -> np.ndarray:
    """A bow, a slope and an offset [m] along 0 to 0.5 m."""
    return 25e-6 * p - 9e-6 * np.sin(2 * np.pi * p / 0.6) + 3e-6


def known() -> Deviations:
    p = np.linspace(0.0, 0.5, 5001)
    return Deviations(p, lead(p) - PLAY / 2, lead(p) + PLAY / 2)


def table() -> CompensationTable:
    return fitted(known(), grid((0.0, 0.5), STEP, REFERENCE), REFERENCE, STEP)


def text_of(form: str, head: tuple[str, ...] = ()) -> tuple[str, CompensationTable]:
    wanted = control(form)
    held = as_held(wanted, table())
    return wanted.write(held, head, "X1"), held


def wanted_at(p: float) -> float:
    """Mean deviation over the reference [m]."""
    return float(lead(np.array(p)) - lead(np.array(REFERENCE)))


# a bow of 9 um over 0.6 m leaves d^2 f'' / 8 = 0.012 um between points 10 mm apart
BETWEEN = 0.02e-6


def test_table_is_zero_at_the_reference_and_holds_the_play() -> None:
    held = table()
    assert float(np.interp(REFERENCE, held.positions, held.mean)) == pytest.approx(0.0, abs=1e-15)
    assert held.play == pytest.approx(PLAY, rel=1e-9)
    assert pytest.approx(held.positions[np.argmin(np.abs(held.positions - REFERENCE))], abs=1e-15) == REFERENCE
    for p in np.linspace(0, 0.5, 77):
        assert held.at(p) == pytest.approx(wanted_at(p) - PLAY / 2, abs=BETWEEN)


def test_periods_that_the_points_do_not_resolve_are_not_folded() -> None:
    """Sampled every 21 mm, an error of period 20 mm comes back with a period of 420 mm and its whole size, 4 um."""
    p = np.linspace(0.0, 0.5, 5001)
    wave = 2e-6 * np.sin(2 * np.pi * p / 0.02 + 1.3)
    found = fitted(Deviations(p, wave, wave), grid((0.0, 0.5), 0.021, 0.0), 0.0, 0.021)
    assert np.ptp(np.interp(found.positions[:-1], p, wave)) > 3.8e-6
    # straight pieces pass sinc^2(21/20) = 0.2 % of it, three times as much between neighbours; ends have one side only
    assert np.ptp(found.forward[3:-3]) < 0.05e-6


# --- LinuxCNC ---


def test_linuxcnc_reads_all_lines_and_corrects_both_directions() -> None:
    text, held = text_of("linuxcnc")
    joint = read.LinuxCncJoint(velocity_limit=100.0, acceleration_limit=1000.0, period=1e-3)
    assert joint.load(text) == len(held) == len(text.splitlines())
    for way in (1.0, -1.0):
        at, span = (20.0, 460.0) if way > 0 else (480.0, -460.0)
        told = [joint.cycle(at + span * i / 20000, way * 23.0) for i in range(20001)]
        for i in range(1000, 20001, 700):
            p = (at + span * i / 20000) * 1e-3
            # the machine's own error added to what the motor is told
            stands = told[i] * 1e-3 + wanted_at(told[i] * 1e-3) - way * PLAY / 2
            # 1 nm of the file's digits, the line between points, and a cycle's change of the correction
            assert stands == pytest.approx(p, abs=BETWEEN + 3e-9)


def test_linuxcnc_stops_at_a_comment_so_there_is_none() -> None:
    text, _ = text_of("linuxcnc", ("# a line that would end the table",))
    assert all(len(line.split()) == 3 and float(line.split()[0]) >= 0 for line in text.splitlines())


def test_ramp_is_that_of_linuxcnc() -> None:
    """A step of the correction, cycle by cycle, and its time and way under half the limits."""
    joint = read.LinuxCncJoint(velocity_limit=20.0, acceleration_limit=400.0, period=1e-3)
    joint.load("0 0 0.008\n500 500 500.008\n")
    theirs = np.array([joint.cycle(100.0, -1.0) - 100.0 for _ in range(60)])
    ours = 1e3 * ramped(np.full(60, -8e-6), 1e-3, AxisLimits(0.02, 0.4))
    np.testing.assert_allclose(theirs, ours, atol=1e-12)  # rounding at 100 mm
    # 8 um at 0.2 m/s^2 take 2 sqrt(s / a) = 12.6 cycles; it may stop short by a T^2 = 0.2 um
    assert abs(ours[15] + 0.008) <= 0.2001e-3
    assert np.all(np.diff(ours) <= 0)


def test_linuxcnc_takes_256_points_and_no_more() -> None:
    many = fitted(known(), grid((0.0, 0.5), 0.5 / 256, 0.0), 0.0, 0.5 / 256)
    with pytest.raises(InputError, match=r"257 points.* takes 256.*--every"):
        as_held(control("linuxcnc"), many)


# --- ISG ---


def test_isg_worked_example_exactly() -> None:
    """ISG kernel documentation: programmed 19866.7 um, measured 19856.5 and 19874.7 um, give -102 and 80."""
    um = 1e-6
    programmed = um * np.array([-20000.0, 19866.7, 33559.1])
    forward = um * np.array([-20000.0, 19856.5, 33553.6])
    reverse = um * np.array([-20000.0, 19874.7, 33570.5])
    made = fitted(measured(programmed, forward, reverse), programmed, float(programmed[0]))
    rows = read.read_isg(control("isg").write(as_held(control("isg"), made), (), "Y"))
    assert rows == [(-200000, 0, 0), (198667, -102, 80), (335591, -55, 114)]


def test_isg_values_are_measured_less_programmed() -> None:
    text, held = text_of("isg", ("a head",))
    for (p, pos, neg), x in zip(read.read_isg(text), held.positions, strict=True):
        assert p == round(x * 1e7)
        # a step of the unit is 0.1 um, half of it rounding
        assert pos * 1e-7 == pytest.approx(wanted_at(p * 1e-7) - PLAY / 2, abs=0.05e-6 + BETWEEN)
        assert neg * 1e-7 == pytest.approx(wanted_at(p * 1e-7) + PLAY / 2, abs=0.05e-6 + BETWEEN)


# --- SINUMERIK ---


def test_encoder_compensation_line_by_line() -> None:
    """6FC5397-1BP40-3BA1, page 242."""
    text, held = text_of("sinumerik-enc", ("first", "second"))
    lines = text.splitlines()
    n = len(held)
    assert lines[0] == "%_N_AX_EEC_INI"
    assert lines[1:3] == ["; first", "; second"]
    assert lines[3] == "CHANDATA(1)"
    for i in range(n):
        assert lines[4 + i] == f"$AA_ENC_COMP[0,{i},X1]={round(held.mean[i] * 1e3, 4) + 0.0:.4f}"
    assert lines[4 + n :] == [
        "$AA_ENC_COMP_STEP[0,X1]=10.0", "$AA_ENC_COMP_MIN[0,X1]=0.0", "$AA_ENC_COMP_MAX[0,X1]=500.0",
        "$AA_ENC_COMP_IS_MODULO[0,X1]=0", "M17",
    ]  # fmt: skip


def test_encoder_compensation_makes_the_actual_value_true() -> None:
    """The value is added to the actual value: the axis stands where indicated + value is the target."""
    text, _ = text_of("sinumerik-enc")
    found = read.read_encoder_table(text, "X1")
    assert found.at(1e3 * REFERENCE) == 0.0
    for p in np.linspace(1.0, 499.0, 60):
        indicated = p
        for _ in range(6):
            indicated = p - found.at(indicated)
        stands = indicated + 1e3 * wanted_at(indicated * 1e-3)
        assert stands == pytest.approx(p, abs=1e3 * (0.05e-6 + BETWEEN))  # 0.1 um digits


def test_direction_tables_line_by_line() -> None:
    """6FC5397-1BP40-3BA1, pages 248 and 264: points, axes, step, ends, direction, multiplication, modulo."""
    text, held = text_of("sinumerik-cec", ("first",))
    lines, n = text.splitlines(), len(held)
    assert lines[:3] == ["%_N_NC_CEC_INI", "; first", "CHANDATA(1)"]
    assert lines[-1] == "M17"
    for t, way in ((0, 1), (1, -1)):
        block = lines[3 + t * (n + 8) : 3 + (t + 1) * (n + 8)]
        assert [line.split("=")[0] for line in block[:n]] == [f"$AN_CEC[{t},{i}]" for i in range(n)]
        assert block[n:] == [
            f"$AN_CEC_INPUT_AXIS[{t}]=(X1)", f"$AN_CEC_OUTPUT_AXIS[{t}]=(X1)", f"$AN_CEC_STEP[{t}]=10.0",
            f"$AN_CEC_MIN[{t}]=0.0", f"$AN_CEC_MAX[{t}]=500.0", f"$AN_CEC_DIRECTION[{t}]={way}",
            f"$AN_CEC_MULT_BY_TABLE[{t}]=0", f"$AN_CEC_IS_MODULO[{t}]=0",
        ]  # fmt: skip


def test_direction_tables_add_what_is_lacking() -> None:
    tables = read.read_cec_tables(text_of("sinumerik-cec")[0], "X1")
    for way, found in tables.items():
        for p in np.linspace(0.0, 500.0, 60):
            told = p + found.at(p)
            stands = told + 1e3 * (wanted_at(told * 1e-3) - way * PLAY / 2)
            assert stands == pytest.approx(p, abs=1e3 * (0.06e-6 + BETWEEN))  # 0.1 um digits


def test_limits_of_points_and_slopes_are_kept() -> None:
    with pytest.raises(InputError, match=r"501 points.*takes 350.*--every"):
        as_held(control("sinumerik-cec"), fitted(known(), grid((0, 0.5), 1e-3, 0.0), 0.0, 1e-3))
    p = np.linspace(0.0, 0.5, 501)
    steep = fitted(Deviations(p, 0.02 * p, 0.02 * p), grid((0, 0.5), 0.01, 0.0), 0.0, 0.01)
    for form in ("sinumerik-enc", "sinumerik-cec", "heidenhain-csv"):
        with pytest.raises(InputError, match=r"20 mm/m.*allows.*lead"):
            as_held(control(form), steep)
    assert len(as_held(control("linuxcnc"), steep)) == 51  # which has no such limit
    with pytest.raises(InputError, match="check the units"):
        fitted(Deviations(p, 0.2 * p, 0.2 * p), grid((0, 0.5), 0.01, 0.0), 0.0, 0.01)


# --- Heidenhain, FANUC, CSV ---


def test_heidenhain_columns() -> None:
    text, held = text_of("heidenhain-csv", ("sign",))
    names, rows = read.read_csv(text)
    assert names == ["AXISPOS", "BACKLASH", "X1"]
    for row, x in zip(rows, held.positions, strict=True):
        assert row[0] == pytest.approx(1e3 * x, abs=1e-4)
        assert row[2] == pytest.approx(1e3 * (wanted_at(x) - PLAY / 2), abs=0.06e-3)
        assert row[1] == pytest.approx(1e3 * (wanted_at(x) + PLAY / 2), abs=0.06e-3)


@pytest.mark.parametrize("reference", [0.0, 0.1, 0.5])
def test_fanuc_increments_sum_to_the_error(reference: float) -> None:
    made = fitted(known(), grid((0.0, 0.5), STEP, reference), reference, STEP)
    wanted = control("fanuc-parameters")
    axis = read.read_fanuc(wanted.write(as_held(wanted, made), (), "X1"))
    assert axis.interval == 10.0
    assert axis.parameters[1851] == axis.parameters[1852] == 6
    held = as_held(wanted, made)
    for p in held.positions:
        error = float(lead(p) - lead(np.array(reference)))
        # whole detection units of 1 um: half of one, however many increments are summed
        assert axis.pulses(1e3 * p, 1e3 * reference) == pytest.approx(-1e3 * error, abs=0.5e-3 + 1e-6)
        # and the program applies what the file says
        assert float(np.interp(p, held.positions, held.mean)) * 1e3 == pytest.approx(
            -axis.pulses(1e3 * p, 1e3 * reference), abs=1e-9
        )


def test_fanuc_magnifies_where_increments_are_too_large() -> None:
    p = np.linspace(0.0, 0.5, 501)
    made = fitted(Deviations(p, 2e-3 * p, 2e-3 * p), grid((0, 0.5), 0.01, 0.0), 0.0, 0.01)  # 20 um a point
    wanted = control("fanuc-parameters")
    axis = read.read_fanuc(wanted.write(as_held(wanted, made), (), "X1"))
    assert axis.parameters[3623] == 3  # 20 um / 3 = 6.7, the least that stays within 7
    assert axis.pulses(500.0, 0.0) == pytest.approx(-1.0, abs=1.5e-3)


def test_csv_is_the_table() -> None:
    text, held = text_of("csv")
    names, rows = read.read_csv(text)
    assert names == ["position [mm]", "forward [um]", "reverse [um]"]
    expected = np.column_stack([1e3 * held.positions, 1e6 * held.forward, 1e6 * held.reverse])
    np.testing.assert_allclose(np.array(rows), expected, atol=0.51e-3)  # three digits of um


# --- what all share ---


@pytest.mark.parametrize("form", TABLES)
def test_hostile_names_end_no_comment(form: str) -> None:
    clean, _ = text_of(form, ("a name",))
    dirty, _ = text_of(form, (HOSTILE,))
    assert dirty.isascii()
    assert dirty.count("\n") == clean.count("\n")
    assert all(letter.isprintable() for letter in dirty if letter != "\n")
    kept = [[line for line in text.splitlines() if line[:1] not in "#;"] for text in (clean, dirty)]
    assert kept[0] == kept[1]


@pytest.mark.parametrize("name", ["", "X 1", "X]=1", "1X", "X\n", "X;M30", "\N{CYRILLIC CAPITAL LETTER HA}1", "X" * 33])
def test_axis_names_are_names(name: str) -> None:
    with pytest.raises(InputError, match="no name of an axis"):
        checked_axis(name)


@pytest.mark.parametrize("form", TABLES)
def test_every_form_says_its_sign_and_its_source(form: str) -> None:
    wanted = control(form)
    assert re_words(wanted.sign_rule) >= 5
    assert re_words(wanted.source) >= 2
    assert wanted.load(as_held(wanted, table()), "X1")


def re_words(text: str) -> int:
    return len(text.split())


@pytest.mark.parametrize("form", TABLES)
def test_program_applies_the_table_as_the_control_does(form: str) -> None:
    """Set-points that the simulation feeds, against the errors they have to meet."""
    wanted, held = control(form), as_held(control(form), table())
    cycle = 1e-3
    there = np.linspace(0.02, 0.48, 4601)
    position = np.concatenate([there, there[::-1]])
    velocity = np.concatenate([np.full(4601, 0.1), np.full(4601, -0.1)])
    told = motor_setpoint(wanted, held, position, velocity, cycle, AxisLimits(0.2, 2.0))
    way = np.sign(velocity)
    stands = told + lead(told) - lead(np.array(REFERENCE)) - way * PLAY / 2
    settled = np.ones(len(told), dtype=bool)
    settled[:100] = settled[4601:4701] = False  # the reversal: at most 15 ms, or the ramp of 5 ms
    # half a step of the control; FANUC also jumps by its increments, of 1 um at most here
    allowed = 0.5 * wanted.resolution * 2 + BETWEEN + (1.2e-6 if wanted.stepwise else 0.0) + 5e-9
    assert np.max(np.abs(stands - position)[settled]) < allowed


def test_direction_holds_at_rest_and_spreads_over_its_time() -> None:
    held = as_held(control("heidenhain-csv"), table())
    velocity = np.array([1.0] * 5 + [0.0] * 5 + [-1.0] * 30 + [0.0] * 5)
    told = motor_setpoint(control("heidenhain-csv"), held, np.full(45, 0.3), velocity, 1e-3)
    given = told - told[0]
    assert np.all(given[:10] == 0)
    assert given[-1] == pytest.approx(-PLAY, abs=1e-7)
    assert given[10 + 7] == pytest.approx(-PLAY * 8 / 15, abs=1e-7)  # 15 ms, evenly
    assert np.all(given[30:] == given[-1])


@pytest.mark.parametrize(
    ("form", "words"),
    [
        ("isg", "n_backlash_cyc 13:"), ("heidenhain-csv", "MP752 (MP_filterTime) = 12.5 ms"),
        ("sinumerik-enc", "MD32457 $MA_BACKLASH_DYN_MAX_VELO = 28.8 mm/min"), ("csv", "within 12.5 ms"),
    ],
)  # fmt: skip
def test_reversal_is_set_as_the_control_takes_it(form: str, words: str) -> None:
    """6 um within 12.5 ms are 28.8 mm/min."""
    asked = control(form)
    set_to = replace(asked, reversal=asked.reversal.over(12.6e-3 if form == "isg" else 12.5e-3, 1e-3))
    held = table()
    assert any(words in line for line in set_to.loading(held, "X1"))
    without_play = replace(held, forward=held.mean, reverse=held.mean)
    assert not any(words in line for line in set_to.loading(without_play, "X1"))
    assert asked.reversal.over(5.0, 1e-3).longest == 1.0


def test_resolution_of_a_form_can_be_coarser_not_finer() -> None:
    assert control("isg", 1e-6).resolution == 1e-6
    with pytest.raises(InputError, match="or more"):
        control("isg", 1e-9)
    assert control("fanuc-parameters", 1e-7).resolution == 1e-7
    with pytest.raises(InputError, match='did you mean "linuxcnc"'):
        control("linuxcn")


def test_grid_refuses_what_makes_no_table() -> None:
    for step in (0.0, -1.0, 1.0, math.nan):
        with pytest.raises(InputError, match="every"):
            grid((0.0, 0.5), step, 0.0)
    with pytest.raises(InputError, match="check the unit"):
        grid((0.0, 0.5), 1e-7, 0.0)
