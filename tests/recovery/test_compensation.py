"""Lead errors, backlash and heat that were planted, taken away by the files that are written for controls.

The truth is a formula of this file; the files are read and applied by the readers of `tests/analytic`, which know the
controls' documents alone.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.compensation.compensate import Compensated, Wishes, cascade_of, compensate_plant, plant_table
from feeddrive.compensation.forms.all_forms import FORMS, HEAT
from feeddrive.compensation.predicted_accuracy import Applied, circle_figures, contour, sticking
from feeddrive.compensation.sheet import left, predicted_rows, sections, sheet_text, text
from feeddrive.compensation.temperature import HeatTable
from feeddrive.servo.cascade import Feedback
from feeddrive.simulate.scenario.scenario_controller import read_controller
from tests.analytic import compensation_readers as read

ROOT = Path(__file__).resolve().parents[2]
TABLES = [form for form in FORMS if form != HEAT]
WIDTH, SLOPE, AMPLITUDE, PHASE, PITCH = 7.5e-6, 20e-6, 1.5e-6, 0.6, 0.02
STROKE = (0.0, 0.4)
FINE = {"fanuc-parameters": 1e-7}
"""An IS-C axis; in steps of 1 um nobody takes 10 % of an error of 1.5 um away."""


def error(p: float, way: float) -> float:
    """Planted, with the motor at p: actual minus target in slow motion [m]."""
    return SLOPE * p + AMPLITUDE * float(np.sin(2 * np.pi * p / PITCH + PHASE)) - way * WIDTH / 2


def planted(*more: fd.Effect) -> fd.Axis:
    return fd.load("bench_axis").with_effects(
        fd.effect("backlash", width="7.5 um"),
        fd.effect("lead_error_cumulative", slope="20 um/m"),
        fd.effect("lead_error_periodic", amplitude="1.5 um", order=1, phase="0.6 rad"),
        *more,
    )


def motor_told(form: str, written: str, p: float, way: float, play: float) -> float:
    """Where a control of that form sends the motor for a target p [m], moving `way`, long after the reversal."""
    mm = 1e3 * p
    if form == "linuxcnc":
        joint = read.LinuxCncJoint(250.0, 10.0, 1e-3)
        joint.load(written)
        told = mm
        for _ in range(400):
            told = joint.cycle(mm, way)
        return told * 1e-3
    if form == "sinumerik-enc":
        table, told = read.read_encoder_table(written, "X1"), mm
        for _ in range(6):
            told = mm - table.at(told)
        return told * 1e-3 + way * play / 2  # MD32450, half either way
    if form == "sinumerik-cec":
        return (mm + read.read_cec_tables(written, "X1")[int(way)].at(mm)) * 1e-3
    if form == "isg":
        rows = np.array(read.read_isg(written), dtype=float) * 1e-7
        return p - float(np.interp(p, rows[:, 0], rows[:, 1 if way > 0 else 2]))
    if form == "heidenhain-csv":
        table = np.array(read.read_csv(written)[1])
        return p - 1e-3 * float(np.interp(mm, table[:, 0], table[:, 2 if way > 0 else 1]))
    if form == "fanuc-parameters":
        axis = read.read_fanuc(written)
        axis.unit = 1e-4
        return (mm + axis.pulses(mm, 0.0) + way * axis.parameters[1851] * axis.unit / 2) * 1e-3
    table = np.array(read.read_csv(written)[1])
    return p - 1e-6 * float(np.interp(mm, table[:, 0], table[:, 1 if way > 0 else 2]))


def left_over(form: str) -> tuple[float, float]:
    """Range of the planted error along + and -, and of what the written file leaves of it [m]."""
    made = plant_table(planted().plant, Wishes(form, stroke=STROKE, axis="X1", resolution=FINE.get(form)))
    written = text(made)
    before, after = [], []
    for p in np.linspace(0.011, 0.389, 97):
        for way in (1.0, -1.0):
            told = motor_told(form, written, float(p), way, made.table.play)
            before.append(error(float(p), way))
            after.append(told + error(told, way) - p)
    return float(np.ptp(before)), float(np.ptp(after))  # the datum is nobody's: ISO 230-2 judges the range


@pytest.mark.parametrize("form", TABLES)
def test_written_file_takes_the_planted_errors_away(form: str) -> None:
    before, after = left_over(form)
    assert before > 15e-6
    assert after < 0.10 * before
    if form != "fanuc-parameters":  # it puts increments out in jumps, see below
        assert after < 0.3e-6  # the periodic part too: 10 % of its 3 um


@pytest.mark.parametrize(("length", "unit"), [(0.4, 1e-7), (0.2, 1e-7), (0.4, 1e-8), (0.4, 1e-6)])
def test_distance_of_points_is_what_fanuc_leaves(length: float, unit: float) -> None:
    """Jumps of the steepest slope times the distance of the points, and roundings, which tell where they are 1 um."""
    made = plant_table(planted().plant, Wishes("fanuc-parameters", stroke=(0.0, length), resolution=unit))
    axis = read.read_fanuc(text(made))
    axis.unit = 1e3 * unit
    left_over = []
    for p in np.linspace(0.011, length - 0.011, 397):
        for way in (1.0, -1.0):
            told = p + 1e-3 * (axis.pulses(1e3 * p, 0.0) + way * axis.parameters[1851] * axis.unit / 2)
            left_over.append(told + error(told, way) - p)
    jump = (SLOPE + AMPLITUDE * 2 * np.pi / PITCH) * made.table.step
    rounding = unit * axis.parameters[3623] + unit  # of the sum, and of the play
    assert 0.7 * jump < np.ptp(left_over) < jump + 2 * rounding
    told = next(line for line in left(made) if "in jumps" in line)
    assert ("detection unit" in told) is (unit == 1e-6)


@pytest.mark.slow
def test_prediction_is_that_of_the_planted_machine() -> None:
    """The simulated machine before and after, under a recommended cascade; the truth before is the formula."""
    made = compensate_plant(planted().plant, Wishes("csv", stroke=STROKE), beside=False)
    assert made.prediction is not None
    before, after = made.prediction.before.positioning, made.prediction.after.positioning
    for way, found in ((1.0, before.mean_up), (-1.0, before.mean_down)):
        formula = [error(float(p), way) for p in before.target]
        # friction keeps half of its wind-up of 0.8 um at each stop, or less where the loop has let it go
        behind = way * (np.array(formula) - found)
        assert np.all((behind > -0.1e-6) & (behind < 0.5e-6))
    assert after.accuracy < 0.1 * before.accuracy
    # At 3 m/min a value that goes over at once throws the table. Within the time told it leaves half as much, and
    # neither half of that time nor twice as much does better.
    assert made.prediction.after.circular.deviation < 0.6 * made.prediction.before.circular.deviation
    assert made.prediction.usual_contour is not None
    assert made.prediction.after.contour < 0.6 * made.prediction.usual_contour
    assert made.lost is not None and made.prediction.circle is not None
    told, loop = made.control.reversal, cascade_of(planted().plant, None)
    for share in (0.5, 2.0):
        other = replace(made.control, reversal=replace(told, spread=share * told.spread))
        ran = circle_figures(sticking(planted().plant, made.lost), loop, made.prediction.circle,
                             Applied(other, made.table))  # fmt: skip
        assert contour(ran) > made.prediction.after.contour
    assert made.prediction.repaired is not None
    # renewed preload takes the play away; the lead error stays, and of the wind-up what friction holds at rest
    assert made.prediction.repaired.positioning.reversal_value < made.lost.wind_up
    assert made.prediction.repaired.positioning.mean_range == pytest.approx(before.mean_range, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("form", TABLES)
def test_prediction_in_every_form(form: str) -> None:
    wishes = Wishes(form, stroke=STROKE, axis="X1", resolution=FINE.get(form))
    made = compensate_plant(planted().plant, wishes, beside=form == "sinumerik-enc")
    assert made.prediction is not None
    before, after = made.prediction.before.positioning, made.prediction.after.positioning
    # FANUC leaves its jumps, 7 % of the planted error, beside the wind-up of friction, which was not planted
    assert made.prediction.repaired is not None
    beside = made.prediction.repaired.positioning.reversal_value if made.control.stepwise else 0.0
    assert after.accuracy - beside < 0.1 * before.accuracy
    assert len(predicted_rows(made)) == 6
    if made.friction is not None:
        # what is told to be best is no worse than nothing
        assert max(map(abs, made.friction.pulsed.glitch)) <= max(map(abs, made.friction.before.glitch))


# --- what is no play ---


@pytest.mark.parametrize("form", TABLES)
def test_wind_up_is_refused_in_every_form(form: str) -> None:
    """Friction over compliance: lost motion, and no play."""
    with pytest.raises(fd.InputError, match=r"wind-up, not play.*friction") as caught:
        fd.compensate("bench_axis", form, stroke=("0 mm", "400 mm"))
    assert "preload" in caught.value.mend
    assert "scale" in caught.value.mend


def test_soft_preload_is_refused_too() -> None:
    worn = fd.load("bench_axis").with_effects(fd.effect("preload_loss", ratio=0.2, force="300 N"))
    with pytest.raises(fd.InputError, match="wind-up, not play"):
        fd.compensate(worn, "sinumerik-cec", stroke=("0 mm", "400 mm"))


def test_wind_up_is_in_no_table_beside_a_lead_error() -> None:
    axis = fd.load("bench_axis").with_effects(fd.effect("lead_error_cumulative", slope="20 um/m"))
    made = plant_table(axis.plant, Wishes("isg", stroke=STROKE))
    assert not made.table.directions_differ
    assert any("wind-up" in line for line in left(made))


def test_wind_up_is_friction_over_stiffness() -> None:
    """Two times (F / k + T r / k_torsion), by hand for the bench axis at 5 mm/s."""
    made = plant_table(planted().plant, Wishes("csv", stroke=STROKE))
    assert made.lost is not None
    lead = 0.02 / (2 * np.pi)
    table = 60.0 * np.tanh(5.0 / 0.5) + 300 * 5e-3
    w = 5e-3 / lead
    screw = 0.25 * np.tanh(w / 0.15) + 0.02 * w ** (2 / 3) + 0.10 * np.tanh(w / 0.15)
    by_hand = 2 * (table / 244.7e6 + lead * (table * lead + screw) / 11982.4)
    assert made.lost.wind_up == pytest.approx(by_hand, rel=1e-6)  # Newton's tolerance on the forces
    assert made.lost.force == pytest.approx(table, rel=1e-6)
    assert made.lost.play == WIDTH


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"ambiguous": [["preload_loss", "backlash"]]}, "cannot tell it from preload loss"),
        ({"effects": [{"name": "backlash", "carries": False}]}, "not confirmed"),
    ],
)
def test_backlash_that_is_not_sure_is_in_no_table(tmp_path: Path, entry: dict[str, object], words: str) -> None:
    fd.load("bench_axis").with_effects(fd.effect("backlash", width="7.5 um")).save(tmp_path / "plant_after.toml")
    (tmp_path / "diagnosis.json").write_text(json.dumps({"effects": [], "ambiguous": []} | entry))
    with pytest.raises(fd.InputError, match=f"no table is written.*{words}"):
        fd.compensate(tmp_path, "linuxcnc", stroke=("0 mm", "400 mm"))


def test_stroke_is_that_of_the_diagnosis_where_none_is_declared(tmp_path: Path) -> None:
    """As the report has it; a stroke that is no range of positions is no stroke."""
    fd.load("bench_axis").with_effects(fd.effect("backlash", width="7.5 um")).save(tmp_path / "plant_after.toml")
    for stroke in ([0.05, 0.35], None, [0.3, 0.1], ["0", 0.3], [0.0, float("nan")]):
        (tmp_path / "diagnosis.json").write_text(json.dumps({"effects": [], "recorded_stroke": stroke}))
        if stroke == [0.05, 0.35]:
            made = fd.compensate(tmp_path, "csv").done
            assert isinstance(made, Compensated)
            assert (made.table.positions[0], made.table.positions[-1]) == (0.05, 0.35)
        else:
            with pytest.raises(fd.InputError, match="no stroke is declared"):
                fd.compensate(tmp_path, "csv")


def test_play_that_weight_holds_closed_is_in_no_table() -> None:
    """A vertical axis hangs on one flank: +-w/2 would put the play in."""
    hung = fd.load("vertical_axis").with_effects(fd.effect("backlash", width="6 um"))
    with pytest.raises(fd.InputError, match=r"6 µm does not show.*one flank"):
        fd.compensate(hung, "sinumerik-cec")
    leads = hung.with_effects(fd.effect("lead_error_cumulative", slope="20 um/m"))
    made = plant_table(leads.plant, Wishes("isg"))
    assert not made.table.directions_differ
    assert any("one flank" in line for line in left(made))
    assert made.lost is not None
    # what the file declares, by hand: weight of the table less counterbalance, over friction
    assert abs(made.lost.weight) > made.lost.force > 0


def test_loop_that_reads_the_scale_needs_no_table() -> None:
    with pytest.raises(fd.InputError, match=r"reads the scale.*motor"):
        fd.compensate(planted(), "isg", stroke=("0 mm", "400 mm"), controller="scenarios/controllers/bench_axis.toml")


def test_growth_is_in_no_table_of_positions() -> None:
    made = plant_table(
        planted(fd.effect("thermal_growth", strain="20 um/m", time_constant="60 s")).plant, Wishes("csv", stroke=STROKE)
    )
    assert made.of_time == ("thermal_growth",)
    assert any("sinumerik-temp" in line for line in left(made))
    alone = plant_table(planted().plant, Wishes("csv", stroke=STROKE))
    np.testing.assert_array_equal(made.table.forward, alone.table.forward)


# --- recordings ---


def _staircase(noise: float) -> fd.Recording:
    """Slow strokes with dwells over the scale and the motor encoder; the axis' own errors are those above."""
    rng, rate = np.random.default_rng(3), 500.0
    targets = np.linspace(0.0, 0.4, 161)
    way = [*targets, *targets[::-1]]
    pieces, at = [np.full(100, way[0])], way[0]
    for target in way[1:]:
        if target != at:
            pieces += [np.linspace(at, target, 100), np.full(100, target)]
            at = target
    p = np.concatenate(pieces)
    move = np.sign(np.diff(p, prepend=p[0]))
    last = np.maximum.accumulate(np.where(move != 0, np.arange(len(p)), 0))
    side = np.where(move[last] == 0, 1.0, move[last])
    table = p + np.array([error(one, way) for one, way in zip(p, side, strict=True)])
    return fd.Recording.from_arrays(
        "staircase", time=np.arange(len(p)) / rate, setpoint=p, motor_angle=p / (PITCH / 2 / np.pi),
        table_position=table + noise * rng.standard_normal(len(p)),
    )  # fmt: skip


@pytest.mark.parametrize("lead", ["20 mm", None])
def test_recorded_lead_error_is_taken_away_and_its_reversal_is_not(lead: str | None) -> None:
    noise = 20e-9
    done = fd.compensate(_staircase(noise), "csv", lead=lead, every="1 mm")
    assert isinstance(done.done, Compensated)
    table, measured = done.done.table, done.done.measured
    assert measured is not None
    assert measured.difference == pytest.approx(WIDTH, abs=3 * noise)
    assert not table.directions_differ
    assert any("does not tell play from wind-up" in line for line in done.left)
    p = np.linspace(0.01, 0.39, 300)
    mean = np.array([0.5 * (error(float(x), 1) + error(float(x), -1)) for x in p])
    rest = mean - table.at(p)
    # targets every 2.5 mm see a period of 20 mm with a chord of 4 %; the scale's noise is averaged over 25 samples
    assert np.ptp(rest) < 0.1 * np.ptp(mean)


def test_recordings_that_tell_nothing_are_refused() -> None:
    t = np.arange(2000) / 500.0
    plain = {"time": t, "table_position": 1e-3 * t}
    with pytest.raises(fd.InputError, match="neither motor_angle nor setpoint"):
        fd.compensate(fd.Recording.from_arrays(**plain), "csv")
    with pytest.raises(fd.InputError, match="--lead"):
        fd.compensate(fd.Recording.from_arrays(motor_angle=t, **plain), "csv")
    with pytest.raises(fd.InputError, match="no table_position"):
        fd.compensate(fd.Recording.from_arrays(time=t, motor_angle=t), "csv", lead="20 mm")
    with pytest.raises(fd.InputError, match="fewer than two targets"):
        fd.compensate(fd.Recording.from_arrays(setpoint=1e-3 * t, **plain), "csv")
    with pytest.raises(fd.InputError, match="was recorded"):
        fd.compensate(_staircase(0.0), "csv", lead="20 mm", stroke=("0 mm", "900 mm"))


# --- cogging ---


def test_cogging_map_is_the_planted_torque() -> None:
    from feeddrive.compensation.cogging import cogging_map

    plant = fd.load("bench_axis").with_effects(
        fd.effect("torque_ripple", amplitude="0.05 N m", order=6, phase="0.2 rad")
    ).plant  # fmt: skip
    cascade = read_controller(ROOT / "scenarios" / "controllers" / "bench_axis.toml", plant)
    found = cogging_map(plant, replace(cascade, feedback=Feedback.MOTOR))
    assert found is not None
    np.testing.assert_allclose(found.torque, 0.05 * np.sin(6 * found.angle + 0.2), atol=1e-12)
    _, rows = read.read_csv(found.text)
    # six digits of N m, and a straight line over a degree of the sixth order
    assert np.interp(100.5, *np.array(rows).T) == pytest.approx(0.05 * np.sin(np.radians(603.0) + 0.2), abs=1e-4)
    assert found.after < 0.1 * found.before
    assert cogging_map(fd.load("bench_axis").plant, cascade) is None


# --- heat ---


@pytest.mark.slow
@pytest.mark.parametrize("machine", ["thermal_bench", "warm_axis"])
def test_table_over_one_sensor_leaves_a_fifth(machine: str, tmp_path: Path) -> None:
    """A warm-up at 0.6 of the highest speed, which nothing was fitted to, and the text run by a reader of its own."""
    axis = fd.load(machine)
    done = fd.compensate(axis, HEAT, axis="X1")
    assert isinstance(done.done, HeatTable)
    assert done.done.sensor == "nut"
    assert done.done.left.rms_after < 0.2 * done.done.left.rms_before
    assert done.done.left.largest_after < 0.2 * done.done.left.largest_before
    written = done.save(tmp_path / "temp.st").read_text()
    warm = fd.warm_up(axis, speed=0.6 * axis.heat.highest_speed, duration="240 min")
    places = axis.heat.rig.growth_positions
    grown = np.column_stack([warm[f"table_growth_{1e3 * x:g}mm"] for x in places])
    told = []
    for reading in warm["nut_temperature"]:
        offset, slope, p0 = read.run_structured_text(written, float(reading))
        told.append([1e-3 * (offset + slope * (1e3 * x - p0)) for x in places])
    rest = grown - np.array(told)
    assert np.sqrt(np.mean(rest**2)) < 0.2 * np.sqrt(np.mean(grown**2))


def test_recorded_heat(tmp_path: Path) -> None:
    """A growth that follows one of two sensors: that one is chosen, and its line comes back."""
    t = np.arange(0.0, 8 * 3600.0, 60.0)
    rise = 20 * (1 - np.exp(-t / 3000)) * np.where(t < 5 * 3600, 1.0, np.exp(-(t - 5 * 3600) / 3000))
    other = 6 * (1 - np.exp(-t / 9000))
    rng = np.random.default_rng(5)
    grown = {f"table_growth_{x}mm": rise * (0.2e-6 + 8e-6 * x * 1e-3) for x in (100, 300, 500)}
    recording = fd.Recording.from_arrays(
        "warm", time=t, nut_temperature=20 + rise + 0.02 * rng.standard_normal(len(t)),
        bed_temperature=20 + other, **grown,
    )  # fmt: skip
    done = fd.compensate(recording, HEAT, axis="X1", reference="100 mm")
    assert isinstance(done.done, HeatTable)
    assert done.done.sensor == "nut_temperature"
    for temperature in (25.0, 35.0):
        offset, slope, p0 = read.run_structured_text(done.text, temperature)
        assert p0 == 100.0
        # noise of 0.02 K on 20 K, and the rounding of the file: 10 nm of K0, 1e-9 of tan beta
        assert offset == pytest.approx(1e3 * (temperature - 20) * (0.2e-6 + 0.8e-6), rel=5e-3, abs=1e-5)
        assert slope == pytest.approx((temperature - 20) * 8e-6, rel=5e-3, abs=1e-9)
    assert done.done.left.rms_after < 0.02 * done.done.left.rms_before
    with pytest.raises(fd.InputError, match="growths"):
        fd.compensate(fd.Recording.from_arrays(time=t, nut_temperature=20 + rise), HEAT)


def test_sheet_has_all_its_parts() -> None:
    made = plant_table(planted().plant, Wishes("linuxcnc", stroke=STROKE, axis="X1"))
    told = sheet_text(sections(made))
    for words in ("Sign", "Source", "Check of one point", "COMP_FILE_TYPE = 0", "What is left", "wind-up", "flank"):
        assert words in told, words


if __name__ == "__main__":  # python -m tests.recovery.test_compensation: what every form leaves
    for form in TABLES:
        before, after = left_over(form)
        sys.stdout.write(f"{form:18} {1e6 * before:6.2f} um -> {1e6 * after:6.3f} um  {100 * after / before:5.2f} %\n")
