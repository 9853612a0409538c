"""Measured tests of ISO 230 against computation by hand, a printed example, and curves whose figures are known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.metrology.measured.standing import believed, stops_of

TABLE = """# laser, X axis
target [mm],up 1 [µm],down 1 [µm],up 2 [µm],down 2 [µm],up 3 [µm],down 3 [µm]
0,0.1,-2.2,0.3,-2.0,-0.1,-1.9
100,1.4,-0.6,1.2,-0.9,1.5,-0.7
200,3.1,0.9,2.8,1.1,3.0,0.8
"""
UP = [[0.1, 0.3, -0.1], [1.4, 1.2, 1.5], [3.1, 2.8, 3.0]]
DOWN = [[-2.2, -2.0, -1.9], [-0.6, -0.9, -0.7], [0.9, 1.1, 0.8]]


def by_hand() -> dict[str, float]:
    """The figures [µm] with sums alone, from the definitions of the standard."""

    def mean(row: list[float]) -> float:
        return math.fsum(row) / len(row)

    def s(row: list[float]) -> float:
        return math.sqrt(math.fsum((x - mean(row)) ** 2 for x in row) / (len(row) - 1))

    u, d = [mean(row) for row in UP], [mean(row) for row in DOWN]
    su, sd = [s(row) for row in UP], [s(row) for row in DOWN]
    b = [p - q for p, q in zip(u, d, strict=True)]
    m = [(p + q) / 2 for p, q in zip(u, d, strict=True)]
    r = [max(2 * p + 2 * q + abs(x), 4 * p, 4 * q) for p, q, x in zip(su, sd, b, strict=True)]
    high = [x + 2 * y for x, y in zip(u + d, su + sd, strict=True)]
    low = [x - 2 * y for x, y in zip(u + d, su + sd, strict=True)]
    return {
        "A": max(high) - min(low), "E": max(u + d) - min(u + d), "M": max(m) - min(m), "R": max(r),
        "B": max(map(abs, b)), "mean B": math.fsum(b) / 3, "A↑": max(high[:3]) - min(low[:3]), "E↑": max(u) - min(u),
        "R↑": 4 * max(su), "A↓": max(high[3:]) - min(low[3:]), "E↓": max(d) - min(d), "R↓": 4 * max(sd),
    }  # fmt: skip


def written(tmp_path: Path, text: str, name: str = "table.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_positioning_is_that_computed_by_hand(tmp_path: Path) -> None:
    found = fd.iso230(written(tmp_path, TABLE)).figures_si()
    expected = by_hand()
    assert list(found) == list(expected)
    for key, value in expected.items():
        assert found[key] == pytest.approx(1e-6 * value, rel=1e-12), key  # a dozen roundings of doubles
    # and the two that a reader can check with a pencil: means 2.96667 and -2.03333; 2 (0.1 + 0.15275) + 2.13333
    assert found["E"] == pytest.approx(5e-6, rel=1e-12)
    assert found["R"] == pytest.approx((2 * 0.2 + 2 * math.sqrt(0.07 / 3) + 2.1333333333333333) * 1e-6, rel=1e-12)


def test_all_layouts_of_a_positioning_table_say_the_same(tmp_path: Path) -> None:
    wide = fd.iso230(written(tmp_path, TABLE)).figures_si()
    rows, places = [], [0, 100, 200]
    for run in (3, 1, 2):  # runs need not stand in their order
        for place, up, down in zip(places, UP, DOWN, strict=True):
            rows += [f"{place};{run};1;{up[run - 1]}", f"{place};{run};-1;{down[run - 1]}"]
    long = "target [mm];run [1];direction [1];deviation [µm]\n" + "\n".join(rows).replace(".", ",") + "\n"
    assert fd.iso230(written(tmp_path, long)).figures_si() == pytest.approx(wide, rel=1e-12)
    heads = ",".join(f"{side}_{run} [mm]" for run in (1, 2, 3) for side in ("up", "down"))
    lines = [
        ",".join([str(place), *(repr(place + 1e-3 * row[run]) for run in range(3) for row in (up, down))])
        for place, up, down in zip(places, UP, DOWN, strict=True)
    ]
    positions = f"# readings = positions\ntarget [mm],{heads}\n" + "\n".join(lines) + "\n"
    # positions of 200 mm hold deviations of a micrometre to 1e-10 of them only
    assert fd.iso230(written(tmp_path, positions)).figures_si() == pytest.approx(wide, rel=1e-9)


def laser_file(ends: str = "\n") -> str:
    """The same test as a laser's program writes it: every run its way, up and down in turn, targets in mm."""
    rows, number = [], 0
    for run in range(3):
        for side in (UP, DOWN):
            number += 1
            order = range(3) if side is UP else (2, 1, 0)
            rows += [f"{number:4d}{place + 1:4d}{side[place][run]:12.4f}" for place in order]
    lines = ["HEADER::", "File type: LINEAR", "Owner: RENISHAW", "Version no: 2", "", "TARGET DATA::",
             "Filetype: LINEAR", "Target-count: 3", "Targets :", "  0.0000  100.0000", "  200.0000", "Flags: 0 0",
             "", "USER-TEXT::", "Machine: M1", "Date: 2026-03-01", "Axis: X", "", "RUNS::", "Run-count: 6", "",
             "DEVIATIONS::", "Run Target Data:", *rows, "", "ENVIRONMENT::", "Air temp: 20.1"]  # fmt: skip
    return ends.join([*lines, ""])


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_file_of_a_laser(tmp_path: Path, ends: str) -> None:
    path = tmp_path / "x.rtl"
    path.write_bytes(laser_file(ends).encode())
    assert fd.iso230(path).figures_si() == pytest.approx(fd.iso230(written(tmp_path, TABLE)).figures_si(), rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("File type: LINEAR", "File type: ANGULAR", "test of angular"),
        ("Target-count: 3", "Target-count: 4", "4 are declared"),
        ("   1   2      1.4000", "   1   9      1.4000", "there is no target 9"),
        ("   1   2      1.4000", "   1   2", "is not run, target, deviation"),
        ("   1   2      1.4000", "   1   1      1.4000", "in no order"),
        ("Run Target Data:", "Data:", "deviations are missing"),
    ],
)
def test_damage_of_a_laser_file_is_one_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in laser_file()
    with pytest.raises(fd.InputError, match=said):
        fd.iso230(written(tmp_path, laser_file().replace(old, new, 1), "x.rtl"))


@pytest.mark.parametrize(
    "heads",
    [
        "Target position (mm);Run 1 forward (µm);Run 1 reverse (µm);Run 2 forward (µm);Run 2 reverse (µm);"
        "Run 3 forward (µm);Run 3 reverse (µm)",
        "Soll [mm];1 ↑ [µm];1 ↓ [µm];2 ↑ [µm];2 ↓ [µm];3 ↑ [µm];3 ↓ [µm]",
        "Nominal [mm];+ 1 [µm];- 1 [µm];+ 2 [µm];- 2 [µm];+ 3 [µm];- 3 [µm]",
    ],
)
def test_other_words_for_the_columns_of_a_table(tmp_path: Path, heads: str) -> None:
    rows = [
        ";".join([str(place), *(str(row[run]) for run in range(3) for row in (up, down))]).replace(".", ",")
        for place, up, down in zip((0, 100, 200), UP, DOWN, strict=True)
    ]
    found = fd.iso230(written(tmp_path, "\n".join([heads, *rows, ""]))).figures_si()
    assert found == pytest.approx(fd.iso230(written(tmp_path, TABLE, "other.csv")).figures_si(), rel=1e-12)


def test_one_direction_alone(tmp_path: Path) -> None:
    text = "target [mm],up 1 [µm],up 2 [µm]\n0,0,0.2\n50,1,1.4\n"
    found = fd.iso230(written(tmp_path, text)).figures_si()
    # means 0.1, 1.2; s = 0.2 / sqrt 2, 0.4 / sqrt 2
    s = (0.2 / math.sqrt(2), 0.4 / math.sqrt(2))
    assert found == pytest.approx(
        {"A↑": 1e-6 * (1.2 + 2 * s[1] - 0.1 + 2 * s[0]), "E↑": 1.1e-6, "R↑": 4e-6 * s[1]}, rel=1e-12
    )


PRINTED_UP = """-10.00008102 -10.00010202 -10.00008702 -10.00009202 -10.00010002
-4.88008702 -4.88009702 -4.88009702 -4.88009502 -4.88008202
0.23992798 0.23990998 0.23991198 0.23991298 0.23991298
5.35989798 5.35991398 5.35991398 5.35990698 5.35992198
10.47989998 10.47988798 10.47987098 10.47989098 10.47990298"""
PRINTED_DOWN = """-10.00009902 -10.00009402 -10.00008202 -10.00009102 -10.00009402
-4.88010302 -4.88010402 -4.88009502 -4.88011102 -4.88009302
0.23991398 0.23989798 0.23990898 0.23992398 0.23990098
5.35992798 5.35990798 5.35990498 5.35989698 5.35991898
10.47989598 10.47987398 10.47986998 10.47985898 10.47989298"""
PRINTED = {"B": 1.22, "mean B": 0.54, "M": 2.77, "R": 6.882, "E↑": 2.46, "E↓": 3.3, "R↑": 5.033, "R↓": 6.29,
           "A↑": 6.428, "A↓": 8.881}  # fmt: skip
"""10^-5 mm. Report of an acceptance test of a motion system at the Paul Scherrer Institute, 8 December 2023 (repository
paulscherrerinstitute/ecmccfg, examples/test/fat_sat/report.md). Its R here is that of its table over positions, R(5);
what it prints in bold for R, E and A of both directions takes the worse direction, which is not the standard's."""


def test_printed_example(tmp_path: Path) -> None:
    heads = ",".join(f"{side} {run} [mm]" for side in ("up", "down") for run in range(1, 6))
    places = ("-10.0", "-4.88", "0.24", "5.36", "10.48")
    rows = [
        ",".join([place, *up.split(), *down.split()])
        for place, up, down in zip(places, PRINTED_UP.split("\n"), PRINTED_DOWN.split("\n"), strict=True)
    ]
    text = f"# readings = positions\ntarget [mm],{heads}\n" + "\n".join(rows) + "\n"
    found = fd.iso230(written(tmp_path, text)).figures_si()
    for key, value in PRINTED.items():
        # half a unit of the last digit printed; B_i is printed as down less up, "E" with three digits
        digits = 5e-11 if key in ("B", "mean B", "M", "E↑", "E↓") else 5e-12
        assert abs(found[key]) == pytest.approx(1e-8 * value, abs=1.02 * digits), key
    # by the definition, from the printed means: -8.482e-5 (up, third) less -12.162e-5 (down, fifth)
    assert found["E"] == pytest.approx(3.68e-8, abs=1e-13)


def drift_table(stop: float = 480.0) -> str:
    """Growth 8 µm + 40 µm/m with a time constant of 90 min, cooling after the stop with 120 min, every 10 min."""
    rows = ["# stop = 480 min", "time [min],at 0 mm [µm],at 250 mm [µm],at 500 mm [µm]"]
    for t in range(0, 721, 10):
        shape = 1 - math.exp(-min(t, stop) / 90)
        shape *= math.exp(-max(t - stop, 0) / 120)
        rows.append(f"{t}," + ",".join(repr((8 + 40 * x) * shape) for x in (0.0, 0.25, 0.5)))
    return "\n".join(rows) + "\n"


def test_drift_of_a_curve_that_is_known(tmp_path: Path) -> None:
    found = fd.iso230(written(tmp_path, drift_table())).figures_si()
    heated = 1 - math.exp(-480 / 90)
    assert found["range at 500 mm, heating"] == pytest.approx(28e-6 * heated, rel=1e-12)
    assert found["range at 250 mm, first hour"] == pytest.approx(18e-6 * (1 - math.exp(-60 / 90)), rel=1e-12)
    assert found["slope at the stop"] == pytest.approx(40e-6 * heated, rel=1e-12)
    # within 5 % of the range of the value at the stop: exp(-t/90) - exp(-480/90) <= 0.05 (1 - exp(-480/90))
    t = -90 * math.log(0.05 * heated + math.exp(-480 / 90))
    assert found["settled at 0 mm after"] == 60 * 10 * math.ceil(t / 10)
    assert found["heating until"] == 480 * 60
    # without a stop the last reading is taken for it, and says so
    forgot = fd.iso230(written(tmp_path, drift_table().replace("# stop = 480 min\n", "")))
    assert ["heating until", "12 h"] in [list(row) for row in forgot.listing().rows]


def test_drift_in_rows(tmp_path: Path) -> None:
    """One row a reading, targets read one after the other: errors are brought to the times of the first target."""
    rows = ["# stop = 200 min", "time [min],target [mm],deviation [µm]"]
    rows += [f"{t + late},{place},{0.1 * (t + late) * (1 + place / 100)}" for t in range(0, 201, 5)
             for late, place in ((0, 0), (1, 100))]  # fmt: skip
    found = fd.iso230(written(tmp_path, "\n".join(rows) + "\n"), stop="199 min").figures_si()
    # straight lines in time: interpolation is exact; common times of the first target are 5 to 200 min
    assert found["range at 0 mm, whole test"] == pytest.approx(0.1e-6 * 195, rel=1e-12)
    assert found["range at 100 mm, whole test"] == pytest.approx(0.2e-6 * 195, rel=1e-12)


def circle_table(paths: dict[int, float], centre: tuple[float, float]) -> str:
    """Points of circles, radius 100 mm + 2 µm cos 2θ about a shifted centre, each direction with its own size [µm]."""
    rows = ["# radius = 100 mm", "x [mm],y [mm],direction [1]"]
    for direction, larger in paths.items():
        for k in range(721):
            a = direction * math.radians(k / 2)
            r = 100 + 1e-3 * (larger + 2 * math.cos(2 * a))
            rows.append(f"{centre[0] + r * math.cos(a)!r},{centre[1] + r * math.sin(a)!r},{direction}")
    return "\n".join(rows) + "\n"


def test_circle_of_known_shape(tmp_path: Path) -> None:
    found = fd.iso230(written(tmp_path, circle_table({1: 5.0, -1: -3.0}, (0.4, -0.2)))).figures_si()
    # an ellipse about its own centre: G = 4 µm in either direction, 5 ± 2 and -3 ± 2; both together 12 µm
    expected = {"G +": 4.0, "F max +": 7.0, "F min +": 3.0, "G -": 4.0, "F max -": -1.0, "F min -": -5.0, "G(b)": 12.0}
    for key, value in expected.items():
        # the first point comes twice (a closed turn), which draws the centre by a thousandth of the ellipse
        assert found[key] == pytest.approx(1e-6 * value, abs=0.02e-6), key
    for key, value in found.items():
        if key.startswith("glitch"):
            assert abs(value) < 0.02e-6, key  # an ellipse is no glitch


def test_glitches_stand_where_the_axes_reverse(tmp_path: Path) -> None:
    rows = ["# radius = 50 mm", "angle [deg],radial [µm],direction [1]"]
    for direction, height in ((1, 4.0), (-1, 2.0)):
        for k in range(720):
            angle = direction * k / 2
            after = [(direction * (angle - 90 * q)) % 360 for q in range(4)]
            rest = sum(height * math.exp(-(((a - 6) / 2) ** 2)) for a in after[:2])  # at 0 and 90 degrees alone
            rows.append(f"{angle},{rest!r},{direction}")
    found = fd.iso230(written(tmp_path, "\n".join(rows) + "\n")).figures_si()
    for sign, height in (("+", 4.0), ("-", 2.0)):
        for q in (0, 90):
            # the smooth path takes its share of a peak that is 4 degrees wide: less than a tenth
            assert 0.9 * height < 1e6 * found[f"glitch {sign} at {q}°"] <= height
        for q in (180, 270):
            assert abs(1e6 * found[f"glitch {sign} at {q}°"]) < 0.1 * height


def test_a_point_at_the_reversal_itself_has_not_turned_yet(tmp_path: Path) -> None:
    """The radius jumps from +height to -height behind a reversal; the point that stands on it is still before."""
    rows = ["# radius = 150 mm", "angle [deg],radial [µm],direction [1]"]
    for direction in (1, -1):
        for k in range(721):
            way = k / 2 % 360  # since 0 degrees
            height = 3.2 if way in (0, 180) else 3.0  # and noise would make it the largest
            rest = height * (1 if 0 < way <= 180 else -1) * abs(math.cos(math.radians(way)))
            rows.append(f"{direction * k / 2},{rest!r},{direction}")
    found = fd.iso230(written(tmp_path, "\n".join(rows) + "\n")).figures_si()
    for sign in "+-":
        # the smooth path, 1.9 µm sin and no cos, leaves the height at 0 and 180 degrees as it is
        assert 1e6 * found[f"glitch {sign} at 0°"] == pytest.approx(3.0, abs=0.05)
        assert 1e6 * found[f"glitch {sign} at 180°"] == pytest.approx(-3.0, abs=0.05)


def staircase(lead_slope: float, play: float, noise: float = 0.0) -> fd.Recording:
    """A set-point from stop to stop, three runs to and fro over five targets and 5 mm beyond, and a scale with play."""
    rate, places = 500.0, [0.0, 0.1, 0.2, 0.3, 0.4]
    run = [-0.005, *places, 0.405, *places[::-1]]
    sent, side, last = [np.full(100, -0.005)], [np.zeros(100)], -0.005
    for target in (run * 3)[1:]:
        n = 300
        s = np.arange(1, n + 1) / n
        move = last + (target - last) * s**3 * (10 - 15 * s + 6 * s**2)
        sent += [move, np.full(200, target)]
        side.append(np.full(n + 200, np.sign(target - last)))
        last = target
    setpoint, came = np.concatenate(sent), np.concatenate(side)
    scale = setpoint * (1 + lead_slope) - 0.5 * play * came
    scale = scale + noise * np.random.default_rng(5).standard_normal(len(scale))
    time = np.arange(len(setpoint)) / rate
    return fd.Recording.from_arrays("staircase", time=time, setpoint=setpoint, table_position=scale)


def test_recording_of_a_staircase() -> None:
    found = fd.iso230(staircase(30e-6, 4e-6)).figures_si()
    assert found["B"] == pytest.approx(4e-6, rel=1e-6)  # no noise: rounding of positions of 0.4 m
    assert found["M"] == pytest.approx(0.4 * 30e-6, rel=1e-6)
    assert found["E"] == pytest.approx(0.4 * 30e-6 + 4e-6, rel=1e-6)
    assert found["R"] == pytest.approx(4e-6, rel=1e-6)


@pytest.mark.parametrize("control", ["twincat.csv", "edge_hfdata.csv"])
def test_trace_of_a_control_is_no_table(control: str, tmp_path: Path) -> None:
    """A capture of set-point and position [mm], as the control writes it."""
    recording = staircase(30e-6, 4e-6)
    asked, there = (1e3 * recording[name] for name in ("setpoint", "table_position"))
    if control == "edge_hfdata.csv":
        rows = [f"{5000 + i},{a!r},{b!r}" for i, (a, b) in enumerate(zip(asked.tolist(), there.tolist(), strict=True))]
        text = "\n".join(["CYCLE,DES_POS|1,ENC_POS|1", *rows, ""])
    else:
        head = ["Name\ttest", "Starttime of export\t132959733843760000\tMontag\t15:56", "", "Name\tSetPos\tActPos",
                "Data-Type\tREAL64\tREAL64", "SymbolName\tAxes.A.SetPos\tAxes.A.ActPos",
                "Unit\tmm (Length)\tmm (Length)", ""]  # fmt: skip
        stamps = (1e3 * recording.time).tolist()
        rows = [f"{t!r}\t{a!r}\t{b!r}" for t, a, b in zip(stamps, asked.tolist(), there.tolist(), strict=True)]
        text = "\n".join([*head, *rows, ""])
    found = fd.iso230(written(tmp_path, text, control)).figures_si()
    assert found == pytest.approx(fd.iso230(recording).figures_si(), abs=1e-12)


def test_only_stops_are_read() -> None:
    recording = staircase(0.0, 0.0)
    stops = stops_of(recording, believed(recording, None))
    assert len(stops) == 36 and {round(one.target, 9) for one in stops} == {-0.005, 0.0, 0.1, 0.2, 0.3, 0.4, 0.405}
    assert [one.direction for one in stops[:3]] == [0, 1, 1]


def test_circle_of_one_axis_with_its_run_up() -> None:
    """Radius 10 mm at 1 Hz after a second of standing; the scale lags by 5 degrees and is 1 % small."""
    time = np.arange(6000) / 1000
    angle = 2 * math.pi * np.clip(time - 1.0, 0, None)
    setpoint = 0.01 * np.sin(angle)
    scale = 0.0099 * np.sin(angle - math.radians(5.0))
    found = fd.iso230(fd.Recording.from_arrays("circle", time=time, setpoint=setpoint, table_position=scale))
    figures = found.figures_si()
    assert found.part == 4
    assert figures["gain"] == pytest.approx(0.99, abs=1e-4)
    assert figures["lag"] == pytest.approx(math.radians(5.0), abs=1e-3)
    assert figures["G"] < 1e-6


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("target [mm],up 1 [µm]\n0,1\n10,2\n", "every target is approached once; approach every target twice"),
        ("target [mm],up 1 [µm],up 2 [µm],down 1 [µm]\n0,1,2,3\n", "not approached alike"),
        ("target [mm],up 1,up 2\n0,1,2\n", "has no unit"),
        ("target [mm],direction [1],deviation [µm]\n0,3,1\n", "neither 1 nor -1"),
        ("angle [deg],radial [µm]\n0,1\n90,1\n", "no nominal radius"),
        ("# radius = 10 mm\nangle [deg],radial [µm]\n0,1\n90,1\n180,2\n270,1\n", "degrees"),
        ("time [min],at 0 mm [µm]\n0,0\n100,1\n", "one target only"),
        ("# stop = 30 min\ntime [min],at 0 mm [µm],at 1 m [µm]\n0,0,0\n30,1,1\n", "heat for an hour"),
        ("target [mm],up 1 [µm],up 2 [µm]\n0,1,nan\n", "not finite"),
        ("speed [m/s],force [N]\n0,1\n", "make no test of ISO 230"),
    ],
)
def test_what_makes_no_test_is_refused_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(fd.InputError, match=said) as told:
        fd.iso230(written(tmp_path, text))
    assert "\n" not in str(told.value)


PLANT = """format = "feeddrive-plant/1"
name = "axis with play"
structure = "rigid"

[ball_screw]
lead = "10 mm"

[table]
mass = "100 kg"

[[effect]]
name = "lead_error_cumulative"
slope = "30 µm/m"

[[effect]]
name = "guide_friction"
port = "table"
coulomb = "40 N"
smoothing_velocity = "1 mm/s"
viscous = "100 N s/m"
"""


def test_what_a_plant_explains(tmp_path: Path) -> None:
    """A lead of 30 µm/m explains M and leaves B; without it nothing is explained."""
    axis = fd.load(written(tmp_path, PLANT, "plant.toml"))
    found = fd.iso230(staircase(30e-6, 4e-6), plant=axis)
    share = found.share
    assert share is not None
    assert share.measured.mean_range == pytest.approx(12e-6, rel=1e-5)
    assert share.left.mean_range < 1e-9
    assert share.left.reversal == pytest.approx(4e-6, rel=1e-5)
    # squared mean deviations about their mean: slope 30 µm/m over five targets, and ± 2 µm of play
    slope = 30e-6**2 * 2 * sum((x - 0.2) ** 2 for x in (0, 0.1, 0.2, 0.3, 0.4))
    assert share.left.explains == pytest.approx(slope / (slope + 10 * 2e-6**2), rel=1e-4)
    assert share.without["lead_error_cumulative"].explains == pytest.approx(0.0, abs=1e-4)
    assert share.without["guide_friction"].explains == pytest.approx(share.left.explains, rel=1e-6)


def test_a_plant_that_explains_nothing_says_so_in_plain_digits(tmp_path: Path) -> None:
    """What rounding leaves of nothing was 0.0002919 nm and -0 %."""
    found = fd.iso230(staircase(30e-6, 4e-6), plant=fd.load("bench_axis"))
    found.save(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    alone = found.tables()[-1].rows[1]
    assert list(alone) == ["the plant alone", "0.000 µm", "0.000 µm", "0.000 µm", ""]
    assert "The plant explains 0 % of the squared mean deviations." in page
    assert " nm<" not in page and "-0 %" not in page and "-0.0 %" not in page


def test_page_holds_graph_and_figures(tmp_path: Path) -> None:
    axis = fd.load(written(tmp_path, PLANT, "plant.toml"))
    fd.iso230(staircase(30e-6, 4e-6), plant=axis).save(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    for word in (
        "Bidirectional accuracy",
        "What the plant explains",
        "16 µm",
        "lead error cumulative",
        "data:image/png",
    ):
        assert word in page, word
    assert (tmp_path / "out" / "iso230.json").is_file() and (tmp_path / "out" / "positioning.png").is_file()


def test_positions_in_the_place_of_deviations_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "laser.csv"
    rows = "".join(f"{x},{x + 0.001},{x + 0.002}\n" for x in (0, 100, 200, 300))
    path.write_text("target [mm],up 1 [mm],up 2 [mm]\n" + rows, encoding="utf-8")
    with pytest.raises(fd.InputError, match=r"span 300 mm over 300 mm of travel; correct .*# readings = positions"):
        fd.iso230(path)
    path.write_text("# readings = positions\ntarget [mm],up 1 [mm],up 2 [mm]\n" + rows, encoding="utf-8")
    assert fd.iso230(path).part == 2


def test_a_radius_of_another_circle_is_refused(tmp_path: Path) -> None:
    angle = np.linspace(0.0, 2 * np.pi * 1.01, 400)
    rows = "".join(f"{150 * np.cos(a):.6f},{150 * np.sin(a):.6f}\n" for a in angle)
    path = tmp_path / "ballbar.csv"
    path.write_text("# radius = 1 m\nx [mm],y [mm]\n" + rows, encoding="utf-8")
    with pytest.raises(fd.InputError, match="has a radius of 150 mm, and 1000 mm is given"):
        fd.iso230(path)
