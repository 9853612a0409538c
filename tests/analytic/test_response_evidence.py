"""Measured frequency responses against a plant file, the measurement from matrices that are written here."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import feeddrive as fd
from feeddrive.diagnosis.responses.response_result import ResponseResult, diagnose_response
from feeddrive.interface.axis import axis_of_text
from feeddrive.recording.frequency_response import FrequencyResponse, write_response
from feeddrive.servo.mechanics_response import Case
from feeddrive.typing import ComplexArray, FloatArray

ROOT = Path(__file__).parents[2]
FREQUENCY = np.arange(8.0, 700.0, 2.0)
AVERAGES = 16
NOISE = 0.02
"""Relative scatter of a line where the response is as large as its median."""

LEAD = 0.020
MOTOR, SCREW, TWIST, TWIST_DAMPING = 2.6e-3, 2.37e-3, 11982.4, 0.074
AXIAL, AXIAL_DAMPING, TABLE = 244.7e6, 8650.0, 134.0
GUIDE, SLOPE_SPEED = 300.0, 0.05
"""plants/bench_axis.toml, typed again; the point moves at 0.05 m/s, where the Coulomb levels have no slope any more."""


TICK, GAIN, RESET = 125e-6, 2.0, 12e-3
"""Of the speed loop: tick [s], K_p [N m s/rad], T_n [s]; dead time of a tick, current loop of 1 kHz."""


def bench(seed: int, loop: str = "", **changed: float) -> FrequencyResponse:
    """Speed of the motor over its torque: three inertias, perhaps a mass on the table, a dead time, other values.

    Where a loop is named, "command" or "error", the speed over that of the speed loop.
    """
    values = {"motor": MOTOR, "screw": SCREW, "twist": TWIST, "axial": AXIAL, "table": TABLE, "delay": 0.0} | changed
    r = LEAD / (2 * math.pi)
    speed = SLOPE_SPEED / r
    drag = 0.02 * (2 / 3) * speed ** (-1 / 3)  # slope of the nut's drag
    mass, share = np.diag([values["motor"], values["screw"], values["table"], values.get("swinging", 1.0)]), 4
    damping, stiffness = np.zeros((4, 4)), np.zeros((4, 4))
    for row, k, c in (
        ([1.0, -1.0, 0.0, 0.0], values["twist"], TWIST_DAMPING),
        ([0.0, r, -1.0, 0.0], values["axial"], AXIAL_DAMPING),
    ):
        stiffness += k * np.outer(row, row)
        damping += c * np.outer(row, row)
    damping[1, 1] += drag
    damping[2, 2] += GUIDE
    if "swinging" in values:
        w = 2 * math.pi * values["frequency"]
        row = [0.0, 0.0, -1.0, 1.0]
        stiffness += values["swinging"] * w**2 * np.outer(row, row)
        damping += 2 * values["damping"] * values["swinging"] * w * np.outer(row, row)
    else:
        share = 3
    M, C, K = (matrix[:share, :share] for matrix in (mass, damping, stiffness))
    if loop:
        return measured(seed, looped(M, C, K, loop), f"speed_{loop}")
    s = 2j * math.pi * FREQUENCY
    exact = np.array([one * np.linalg.solve(M * one**2 + C * one + K, np.eye(share)[:, 0])[0] for one in s])
    return measured(seed, exact * np.exp(-s * values["delay"]), "motor_torque")


def looped(M: FloatArray, C: FloatArray, K: FloatArray, loop: str) -> ComplexArray:
    """The speed loop at `FREQUENCY`: PI by Euler, speed a difference of angles, torque held, a tick late, a lag."""
    n, lag = len(M), 1 / (2 * math.pi * 1000)
    whole = np.zeros((2 * n + 2, 2 * n + 2))  # coordinates, rates, torque, and its command, held
    whole[:n, n : 2 * n] = np.eye(n)
    whole[n : 2 * n, :n], whole[n : 2 * n, n : 2 * n] = -np.linalg.solve(M, K), -np.linalg.solve(M, C)
    whole[n : 2 * n, 2 * n] = np.linalg.solve(M, np.eye(n)[:, 0])
    whole[2 * n, 2 * n], whole[2 * n, 2 * n + 1] = -1 / lag, 1 / lag
    step = expm(whole * TICK)
    a, b = step[:-1, :-1], step[:-1, -1]
    z = np.exp(2j * math.pi * FREQUENCY * TICK)
    angle = np.array([np.linalg.solve(one * np.eye(len(a)) - a, b)[0] for one in z])
    opened = (GAIN + GAIN / RESET * TICK / (z - 1)) * angle / z * (1 - 1 / z) / TICK
    found: ComplexArray = opened if loop == "error" else opened / (1 + opened)
    return found


def measured(seed: int, exact: ComplexArray, given: str) -> FrequencyResponse:
    """A response with scatter and the coherence that belongs to it."""
    generator = np.random.default_rng([20261122, seed])
    scatter = NOISE * np.sqrt(np.maximum(1.0, np.median(np.abs(exact)) / np.abs(exact)))
    coherence = 1 / (1 + 2 * AVERAGES * scatter**2)
    error = scatter * (generator.standard_normal(len(exact)) + 1j * generator.standard_normal(len(exact)))
    return FrequencyResponse("made", given, "motor_speed", "", FREQUENCY, exact * np.exp(error), coherence)


CONTROLLER = f"""format = "feeddrive-controller/1"
velocity_rate = "8 kHz"
position_rate = "2 kHz"
position_gain = "30 1/s"
velocity_gain = "{GAIN} N m s/rad"
reset_time = "{RESET} s"
current_bandwidth = "1 kHz"
dead_time = "{TICK} s"
"""


@pytest.mark.slow
@pytest.mark.parametrize("loop", ["command", "error"])
def test_speed_loop_is_compared_with_its_controller(loop: str, tmp_path: Path) -> None:
    """Closed and open: nothing found where nothing is, a mass where one is, by the same oracle in matrices."""
    (tmp_path / "controller.toml").write_text(CONTROLLER, encoding="utf-8")
    for seed, changed in ((21, {}), (22, {"table": 200.0})):
        write_response(bench(seed, loop, **changed), tmp_path / "frf.csv")
        found = fd.explain(catalogued(), tmp_path / "frf.csv", at="x=0 mm, v=3 m/min",
                           controller=tmp_path / "controller.toml").result  # fmt: skip
        assert isinstance(found, ResponseResult)
        assert [one.parameters[0].key for one in found.asserted] == (["table.mass"] if changed else [])
        assert found.error_after == pytest.approx(found.scatter, rel=0.1)
        if changed:
            assert found.asserted[0].parameters[0].value == pytest.approx(200.0, rel=0.03)


def test_speed_loop_without_its_controller_is_refused() -> None:
    with pytest.raises(fd.InputError, match="give --controller FILE"):
        result_of(bench(0, "command"))


def catalogued() -> fd.Axis:
    """The bench axis as from a catalogue: of itself it declares the numbers that a simulation ran with, exactly."""
    path = ROOT / "plants" / "bench_axis.toml"
    text = path.read_text(encoding="utf-8")
    assert "of the simulated recordings" in text
    return axis_of_text(text.replace("of the simulated recordings", "of a catalogue"), path)


def result_of(response: FrequencyResponse):  # type: ignore[no-untyped-def]
    axis = catalogued()
    case = Case(axis.plant.middle, SLOPE_SPEED)
    return diagnose_response(axis.entries, axis.path, axis.plant, response, case)


@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_found_where_all_is_as_declared(seed: int) -> None:
    result = result_of(bench(seed))
    assert not result.found
    # the error before is the scatter itself, coherence and all
    assert result.error_after == pytest.approx(result.scatter, rel=0.1)


def test_a_file_of_exact_values_is_compared_too() -> None:
    """Values that are exact have no tolerance to be fitted within; a mass that is other is found all the same."""
    axis = fd.load("bench_axis")
    for seed, table in ((0, TABLE), (12, 200.0)):
        case = Case(axis.plant.middle, SLOPE_SPEED)
        result = diagnose_response(axis.entries, axis.path, axis.plant, bench(seed, table=table), case)
        assert [one.parameters[0].key for one in result.asserted] == ["table.mass"] * (table != TABLE)


def test_values_within_tolerance_are_calibrated() -> None:
    """Stiffnesses 10 % off, of 20 % that catalogues leave open, are no finding, and the response is met."""
    result = result_of(bench(11, axial=0.9 * AXIAL, twist=1.1 * TWIST))
    assert not result.asserted
    assert result.error_after == pytest.approx(result.scatter, rel=0.1)
    moved = {words: factor for words, factor, _ in result.calibrated_values}
    # lines of 2 % at resonances: stiffness to 3 %
    assert moved["axial stiffness"] == pytest.approx(0.9, rel=0.03)
    assert moved["torsional stiffness"] == pytest.approx(1.1, rel=0.03)


def test_a_mass_beyond_its_tolerance_is_found() -> None:
    result = result_of(bench(12, table=200.0))
    (found,) = result.found
    assert found.asserted
    assert found.parameters[0].key == "table.mass"
    assert found.parameters[0].value == pytest.approx(200.0, rel=0.03)
    assert found.parameters[0].interval[0] < 200.0 < found.parameters[0].interval[1]


def test_a_dead_time_is_found() -> None:
    result = result_of(bench(13, delay=0.4e-3))
    assert [one.name for one in result.asserted] == ["drive_delay"]
    # 350 lines of 2 % know a phase over 700 Hz to microseconds
    assert result.asserted[0].parameters[0].value == pytest.approx(0.4e-3, abs=5e-6)


def test_a_further_mode_is_found() -> None:
    result = result_of(bench(14, swinging=20.0, frequency=90.0, damping=0.03))
    assert [one.name for one in result.asserted] == ["structural_mode"]
    found = {one.key: one for one in result.asserted[0].parameters}
    assert found["frequency"].value == pytest.approx(90.0, rel=0.005)
    assert found["mass"].value == pytest.approx(20.0, rel=0.1)
    assert found["frequency"].interval[0] < 90.0 < found["frequency"].interval[1]
    assert result.error_after < 0.5 * result.error_before


def test_files_and_command(tmp_path: Path) -> None:
    """The file of a response goes through the command's own road and comes back as a plant that can be read."""
    path = tmp_path / "frf.csv"
    write_response(bench(15, delay=0.4e-3), path)
    found = fd.explain(catalogued(), path, at="x=0 mm, v=3 m/min")
    out = found.save(tmp_path / "out")
    record = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert [one["name"] for one in record["effects"]] == ["drive_delay"]
    after = fd.load(out / "plant_after.toml")
    assert after.plant.effects[-1].name == "drive_delay"
    assert "dead time" in found.verdict
    assert len(found.listing().rows) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"given": "motor_current"}, "motor_torque"),
        ({"output": "motor_position"}, "motor_speed"),
        ({"frequency": FREQUENCY[:10]}, "lines"),
        ({"values": np.zeros(len(FREQUENCY), dtype=complex)}, "zero"),
    ],
)
def test_mistakes_are_told_in_one_line(change: dict[str, object], words: str) -> None:
    made = bench(0)
    fields = {"name": "made", "given": made.given, "output": made.output, "unit": "", "frequency": made.frequency,
              "values": made.values, "coherence": made.coherence} | change  # fmt: skip
    if len(fields["frequency"]) < len(FREQUENCY):  # type: ignore[arg-type]
        fields["values"], fields["coherence"] = made.values[:10], made.coherence[:10]
    with pytest.raises(fd.InputError) as caught:
        result_of(FrequencyResponse(**fields))  # type: ignore[arg-type]
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("line", "said"),
    [("10,-2,-90,0.9", "a magnitude is below zero, -2 at 10 Hz"), ("10,0,-90,0.9", "a magnitude is zero"),
     ("10,0.1,-90,1.7", "outside of 0 to 1")],
)  # fmt: skip
def test_a_line_that_no_machine_gives_is_refused(tmp_path: Path, line: str, said: str) -> None:
    """One of them made a resonance of 7 kg, at odds of more than 999 to 1."""
    head = (
        "# from = motor_torque, to = motor_speed\nfrequency [Hz],magnitude [(rad/s)/(N m)],phase [deg],coherence [1]\n"
    )
    path = tmp_path / "frf.csv"
    path.write_text(head + f"1,1,-90,0.9\n5,0.2,-90,0.9\n{line}\n20,0.05,-90,0.9\n", encoding="utf-8")
    with pytest.raises(fd.InputError, match=re.escape(said)):
        fd.explain("bench_axis", path)
