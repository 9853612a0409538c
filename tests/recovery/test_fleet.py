"""The fleet of drawn machines: the same case every time, sizes that hold, verdicts that say what they should."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections import Counter
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from feeddrive.plant.file.plant_file import read_plant
from tests.generator.constants import declared_constants
from tests.generator.drawn_effects import MAKERS, OFF_GROUPS, TOLERANCES, Drawn
from tests.generator.effects import ChannelDelay, Payload, Presliding
from tests.generator.machines import drawn_machine
from tests.generator.runs import Array, changes, impedance, run, steps_of
from tests.generator.telling import (
    FARTHEST,
    beyond,
    calibration,
    changes_left,
    distance,
    from_declared,
    missed,
    nearest,
    simulated_calibration,
    visible,
)
from tests.recovery.fleet.case import LEAST_TOLD, MOST_STEPS, SHARES, Case, _grown, case, encoder_null_seeds, kind_of
from tests.recovery.fleet.floor import true_errors
from tests.recovery.fleet.run import Record, cases_done, until_late
from tests.recovery.fleet.state import state_files
from tests.recovery.fleet.table import section, wilson
from tests.recovery.fleet.verdict import Verdict, possible
from tests.recovery.page import with_section

NULL, PAIR, SPOILT, SLOW = 10, 3, 20, 1214
"""Seeds of quick cases: nothing planted, two effects, a torque from an rms current, rows of 4 ms."""


@pytest.fixture(scope="module")
def pair() -> Case:
    """Two effects with declared values off."""
    return case(PAIR)


def test_case_is_the_same_every_time(pair: Case) -> None:
    """A seed gives the same plant, truth and samples."""
    again = case(PAIR)
    assert again.plant == pair.plant and again.truth == pair.truth
    assert all(np.array_equal(again.judge[name], samples) for name, samples in pair.judge.items())


def test_a_bristle_that_takes_minutes_to_simulate_is_drawn_on_another_machine(pair: Case) -> None:
    """Steps grow with the stiffness of a bristle, and no case of the fleet takes more than it may."""
    soft = pair.true.axis.guide_coulomb / 1e-4
    soft_steps, stiff_steps = (steps_of(pair.true, (Presliding(by * soft),), 1000) for by in (1.0, 1000.0))
    assert stiff_steps == pytest.approx(1000 * soft_steps, rel=0.3)  # a soft one takes whole steps of a cycle
    hours = int(1000 * MOST_STEPS / stiff_steps) + 1
    drawn = Drawn(Presliding(1000 * soft), 1.0, 1.0)
    assert _grown(pair.true, drawn, 2.0, (np.zeros(hours), np.zeros(hours)), missed(pair.runs[0], 1)) is None


def test_kinds_come_as_often_as_asked() -> None:
    """Shares of 4000 seeds are those asked for, within four standard deviations of a binomial."""
    counts = Counter(kind_of(seed) for seed in range(4000))
    for kind, share in SHARES.items():
        assert abs(counts[kind] - 4000 * share) < 4 * math.sqrt(4000 * share * (1 - share))


def test_plant_file_is_read_with_the_declared_values(pair: Case, tmp_path: Path) -> None:
    """The file holds the declared machine, not the true one."""
    path, _, _ = pair.write(tmp_path)
    plant = read_plant(path)
    assert plant.chain.values["table_mass"] == pytest.approx(pair.declared.axis.table_mass)
    assert pair.true.axis.table_mass == pytest.approx(pair.declared.axis.table_mass * pair.off["table_mass"])
    assert tomllib.loads(path.read_text())["table"]["mass"]["tolerance"] == "5 %"


def test_declared_values_are_off_by_twice_their_tolerance_at_most(pair: Case) -> None:
    """Two of the groups beyond their tolerance at most."""
    beyond = 0
    for names, kind in OFF_GROUPS:
        off = abs(math.log(pair.off[names[0]]))
        assert off <= math.log1p(2 * TOLERANCES[kind]) + 1e-3
        beyond += off > math.log1p(TOLERANCES[kind]) + 1e-3
    assert beyond <= 2


def test_what_is_recorded_is_the_true_machine_and_its_sensors() -> None:
    """The true plant, led by the recorded angle, leaves the sensors' noise: a null recorded by 24 bits."""
    drawn = case(encoder_null_seeds(1, 1)[-1])
    sensors, error = drawn.true.axis.sensors, true_errors(drawn)["motor_torque"]
    noise = math.hypot(sensors.torque_noise, sensors.torque_step / math.sqrt(12))
    inner = error[2000:-2000]
    # The carried encoder error adds above the band; a running mean of 20 rows takes most of it away.
    smooth = np.convolve(inner, np.ones(20) / 20, mode="valid")
    assert np.std(smooth) == pytest.approx(noise / math.sqrt(20), rel=0.15)


def test_rows_slower_than_a_drive_tell_the_motion_at_most_of_them() -> None:
    """At 250 Hz and 22 bits the sensors' noise is left at most rows; where the motor turns between rows more is."""
    drawn = case(SLOW)
    assert drawn.true.row_time > 2e-3
    sensors, left = drawn.true.axis.sensors, true_errors(drawn)
    torque = math.hypot(sensors.torque_noise, sensors.torque_step / math.sqrt(12))
    assert 0.9 < np.median(np.abs(left["motor_torque"])) / (0.6745 * torque) < 1.5
    position = math.hypot(sensors.scale_noise, sensors.scale_step / math.sqrt(12))
    of_zero = left["table_position"] - np.median(left["table_position"])
    assert np.median(np.abs(of_zero)) < 2 * 0.6745 * position


def test_spoilt_recordings_keep_their_channels() -> None:
    """An rms current is the torque over the root of two, everything else as it was."""
    drawn = case(SPOILT)
    assert drawn.spoiling == "torque from an rms current"
    assert set(drawn.runs[1].recorded(0)) == set(drawn.judge)
    torque, angle, _ = drawn.exact
    assert np.std(drawn.judge["motor_torque"]) == pytest.approx(np.std(torque) / math.sqrt(2), rel=0.01)
    assert np.max(np.abs(drawn.judge["motor_angle"] - angle)) <= math.pi / 2 ** drawn.truth["bits"] * 1.001


def test_size_is_the_error_over_what_the_true_plant_misses(pair: Case) -> None:
    """A change like what is missed makes the error the root of two times as large; declared values show as none."""
    one = pair.runs[0]
    floor = missed(one, pair.seed)
    random = np.random.default_rng(1)
    white = random.standard_normal(len(one.torque[one.rows]))
    shaped = np.fft.irfft(np.fft.rfft(white) * np.sqrt(floor.densities[0]), len(white)) / floor.weights[0]
    nothing = np.zeros(len(white))
    base = calibration(one, floor)
    assert visible(floor, base, shaped, nothing).torque == pytest.approx(1.0, rel=0.25)  # the best of six bands
    heavy = 0.02 * np.gradient(one.states[:, 1], pair.true.axis.sample_time)[one.rows] * pair.true.axis.motor_inertia
    assert visible(floor, base, heavy, nothing).torque < 0.5 * visible(floor, 1e-9 * base, heavy, nothing).torque


def test_planted_effects_are_told_from_declared_values(pair: Case) -> None:
    """A mass that is off by half its tolerance is no finding: its change is that of the prior, to half a deviation."""
    floor = missed(pair.runs[0], pair.seed)
    for one in pair.planted:
        assert from_declared(pair.runs[0], one.effect.name, floor) >= 0.7 * LEAST_TOLD  # another draw of the sensors
    columns = simulated_calibration(pair.runs[0], floor)
    assert distance(0.5 * columns[:, 0], columns, free=0) <= 0.5
    assert distance(np.ones(len(columns)), columns, free=0) > 0.5 * math.sqrt(len(columns))


def test_a_value_is_told_by_what_is_beyond_its_tolerance(pair: Case) -> None:
    """Of a table a fifth heavier 73 % are beyond 5 %, and told from every value but the mass; within, nothing is."""
    machine, one, seed = pair.declared, pair.runs[0], pair.seed
    heavy = Payload(0.2 * machine.axis.table_mass)
    assert beyond(heavy, machine) == pytest.approx({"table_mass": 1 - math.log(1.05) / math.log(1.2)})
    bare = dataclasses.replace(one, machine=machine, effects=(), constants=declared_constants(machine.axis))
    floor, told = missed(bare, seed), {}
    for share in (0.04, 0.2):
        payload = Payload(share * machine.axis.table_mass)
        loaded = dataclasses.replace(bare, effects=(payload,), constants=payload.planted(bare.constants))
        told[share] = from_declared(loaded, "payload", floor)
    assert told[0.04] < 0 < told[0.2]


@pytest.mark.parametrize("seed", range(4))
def test_values_are_as_near_as_bounded_least_squares_find_them(seed: int) -> None:
    """Four values of a resonance, each within three deviations of 5 %, against another payload: SciPy's own search."""
    random = np.random.default_rng([seed, 61])
    hertz = np.linspace(0.2, 2.0, 400)

    def response(sizes: Array) -> Array:
        gain, stiffness, mass, damping = np.exp(0.05 * sizes)
        return np.asarray(gain * hertz**2 / np.hypot(stiffness - mass * hertz**2, 0.1 * damping * hertz))

    off = random.uniform(-2.0, 2.0, 4)
    wanted = 30.0 * (response(off) + 0.02 * random.standard_normal() * hertz**2)

    def left(sizes: Array) -> Array:
        return np.asarray(wanted - 30.0 * response(sizes))

    best = min(
        least_squares(lambda x: np.concatenate([left(x), x]), begun, bounds=(-FARTHEST, FARTHEST)).cost
        for begun in (np.zeros(4), *random.uniform(-2.0, 2.0, (5, 4)))
    )
    columns = np.column_stack([(left(off) - left(off + 1e-3 * one)) / 1e-3 for one in np.eye(4)])
    # the last step and the last slopes gain less than a fiftieth each
    assert (1 - 1e-6) * math.sqrt(2 * best) <= nearest(left, columns) <= 1.04 * math.sqrt(2 * best)


def test_nothing_is_left_of_values_that_are_off_as_far_as_their_sizes_say(pair: Case) -> None:
    """The plant of a run whose values are off comes back to the last rounding, and only from those sizes."""
    one = pair.runs[0]
    sizes = np.random.default_rng(5).normal(size=len(OFF_GROUPS))
    sizes[[names == ("torque_constant",) for names, _ in OFF_GROUPS].index(True)] = 0.0
    factors = {
        name: (1.0 + TOLERANCES[kind]) ** size
        for (names, kind), size in zip(OFF_GROUPS, sizes, strict=True)
        for name in names
    }
    factors.pop("torque_constant")
    machine = dataclasses.replace(one.machine, axis=one.machine.axis.off_by(factors))
    constants = declared_constants(machine.axis)
    other = run(machine, (), one.setpoint, np.zeros(len(one.setpoint)))
    assert other.constants == constants
    declared = dataclasses.replace(other, machine=one.machine)
    near, far = (changes_left(declared, (), (), values) for values in (sizes, np.zeros_like(sizes)))
    for left, whole in zip(near, far, strict=True):
        assert np.linalg.norm(left) < 1e-6 * np.linalg.norm(whole)


def test_a_late_torque_shows_in_the_torque_alone(pair: Case) -> None:
    """By a third of a cycle: angle and table are read later together, and the one follows from the other."""
    one = pair.runs[0]
    cycle = one.machine.axis.sample_time
    late = run(one.machine, (ChannelDelay("motor_torque", cycle / 3),), one.setpoint, np.zeros(len(one.setpoint)))
    torque, position = changes(late, ())
    speed = np.abs(late.states[late.rows, 5])
    assert np.sqrt(np.mean(position**2)) < 0.02 * np.sqrt(np.mean(speed**2)) * 2 * cycle / 3
    # of what changes it is told by the time that it lags
    rate = np.gradient(late.torque, cycle)[late.rows]
    assert abs(torque @ rate / (rate @ rate)) == pytest.approx(cycle / 3, rel=0.5)
    # beside a plant that is late as well, declared values change what they change of one that is not
    ready = run(one.machine, (), one.setpoint, np.zeros(len(one.setpoint)))
    floor = missed(ready, NULL)
    there, here = simulated_calibration(late, floor), simulated_calibration(ready, floor)
    assert np.linalg.norm(there - here) < 1e-9 * np.linalg.norm(here)  # but for rounding, 4e-15


def test_simulated_slopes_are_the_quasi_static_ones_below_the_resonance(pair: Case) -> None:
    """Up to 5 Hz, for the masses, the frictions and the springs; what a spring's damper does there is nothing."""
    one = pair.runs[0]
    floor = missed(one, pair.seed)
    simulated = simulated_calibration(one, floor)[:, 2:]
    quasi_static = calibration(one, floor)[:, :-2]
    slow = np.tile(floor.hertz[floor.inside] <= 5.0, 2 * len(floor.densities))
    for place, (names, _) in enumerate(OFF_GROUPS):
        if names[0].endswith("damping"):
            continue
        a, b = simulated[slow, place], quasi_static[slow, place]
        assert a @ b > 0.98 * np.linalg.norm(a) * np.linalg.norm(b), names


def test_impedance_at_low_frequency_is_the_inertia() -> None:
    """Far below the first resonance the motor moves all masses, and the table goes with it."""
    machine = drawn_machine(np.random.default_rng(6))
    rigid = machine.with_axis(guide_viscous=0.0)
    torque, position = impedance(rigid, np.array([0.05]))
    assert float(-torque[0].real / (2 * math.pi * 0.05) ** 2) == pytest.approx(machine.inertia, rel=1e-3)
    assert float(position[0].real) == pytest.approx(machine.radius, rel=1e-3)


def test_state_covers_the_package_and_its_c() -> None:
    """Everything that can change a result: the whole package with its C, plants, generator and fleet."""
    names = {path.as_posix().split("/feeddrive/")[-1] for path in state_files()}
    assert any(name.endswith(".c") or name.endswith(".h") for name in names) or not list(Path("feeddrive").rglob("*.c"))
    text = "\n".join(path.as_posix() for path in state_files())
    for part in ("feeddrive/cli/", "feeddrive/report/", "plants/", "tests/generator/", "tests/recovery/fleet/"):
        assert part in text


def test_a_run_that_ends_by_its_time_keeps_what_is_in_work() -> None:
    begun: list[int] = []

    def begin(seed: int) -> Future[Record | None]:
        begun.append(seed)
        future = Future[Record | None]()
        future.set_result({"seed": seed})
        return future

    results = list(until_late(begin, range(10), 2, lambda: len(begun) >= 5))
    assert begun == [0, 1, 2, 3, 4]
    assert sorted(one["seed"] for one in results if one is not None) == begun


def test_broken_last_line_is_run_again(tmp_path: Path) -> None:
    """What was being written when it was killed counts as not there."""
    (tmp_path / "results.jsonl").write_text('{"seed": 1, "state": "a"}\n{"seed": 2, "sta', encoding="utf-8")
    assert set(cases_done(tmp_path)) == {1}
    assert cases_done(tmp_path, "b") == {}


def verdict(planted: list[dict[str, Any]], found: list[str], **more: Any) -> Verdict:
    """A record by hand: names found at the table."""
    truth: dict[str, Any] = {
        "seed": 1, "kind": "single" if planted else "null", "planted": planted, "may": [], "off": {}, "spoiling": "",
        "rows": [10000, 10000], "rate_hz": 1000.0, "mass": 50.0, "motor_inertia": 1e-3, "screw_inertia": 1e-3,
    }  # fmt: skip
    truth |= {key: more.pop(key) for key in list(more) if key in truth}
    one: dict[str, Any] = {"asserted": True, "odds": None, "explains": {}, "parameters": {}}
    record = {
        "seed": 1, "truth": truth, "outcome": "done", "cpu": 1.0, "ambiguous": [], "plant_after": "readable",
        "found": [one | {"name": name, "place": "table"} for name in found],
        "before": {"motor_torque": 2.0}, "after": {"motor_torque": 1.0}, "floor": {"motor_torque": 1.0},
        "band": {"motor_torque": 100.0},
    }  # fmt: skip
    return Verdict(record | more)


def planted(name: str, place: str = "", relative: bool = False) -> dict[str, Any]:
    """One planted effect of a truth."""
    return {"name": name, "place": place, "relative": relative, "values": {}, "size": 2.0}


def test_verdicts() -> None:
    """Right, with a name too many, with a set, at another place, a value that may be named."""
    backlash = [planted("backlash")]
    assert verdict(backlash, ["backlash"]).right
    assert not verdict(backlash, ["backlash", "stribeck"]).right
    assert verdict(backlash, ["backlash", "payload"], may=["payload"]).right
    assert verdict(backlash, ["presliding"], ambiguous=[["presliding", "backlash"]]).right_in_sets
    assert not verdict(backlash, ["presliding"], ambiguous=[["presliding", "backlash"]]).right
    assert not verdict([planted("friction_deviation", "screw")], ["friction_deviation"]).right
    assert verdict([], ["stribeck"]).extra == ["stribeck"]
    assert verdict([], ["channel_delay"], spoiling="position recorded 3 ms late").extra == []


def test_worse_channels_and_values_out_of_range() -> None:
    """Beyond three deviations of an rms; no negative mass."""
    # 2 * 100 Hz * 9 s: 1800 independent samples, of which an rms scatters by 1.7 %, three times 5 %.
    assert verdict([], [], before={"motor_torque": 1.0}, after={"motor_torque": 1.04}).worse_channels == []
    assert verdict([], [], before={"motor_torque": 1.0}, after={"motor_torque": 1.06}).worse_channels
    truth = verdict([], []).truth
    assert not possible("payload", "table", "mass", -51.0, truth) and possible("payload", "table", "mass", -49.0, truth)
    assert not possible("drive_delay", "motor", "delay", -1e-6, truth)


def test_share_intervals() -> None:
    """Wilson's interval of 0 of 120 ends at 3.1 %, of 95 of 100 lies from 88.8 to 97.8 %."""
    assert wilson(0, 120) == pytest.approx((0.0, 0.0310), abs=1e-3)
    assert wilson(95, 100) == pytest.approx((0.888, 0.978), abs=1e-3)


def test_table_goes_into_its_page() -> None:
    """In place of the section that is there, the rest untouched."""
    verdicts = [verdict([planted("backlash")], ["backlash"]), verdict([], ["stribeck"])]
    page = with_section("# Recovery\n\nbefore\n", section(verdicts, "abc"))
    again = with_section(page + "\nafter\n", section(verdicts[:1], "def"))
    assert "before" in again and "after" in again and again.count("## Fleet") == 1
    assert "abc" not in again and "nothing planted: cases with a false name | 0 of 120 | 1 |" in page


def test_every_effect_is_drawn() -> None:
    """All effects of motion in the table can be planted."""
    from feeddrive.effects.catalogue import EFFECTS

    declared = {"guide_friction", "nut_drag", "bearing_drag", "nut_friction"}
    tables = {name for name in EFFECTS if name.startswith("tabulated")}
    assert set(MAKERS) == set(EFFECTS) - declared - tables


@pytest.mark.slow
def test_a_hanging_table_softer_than_its_law_comes_to_rest() -> None:
    """A relative of a spring law is softer than the law near its own zero: the stretch was looked for too near."""
    assert case(703291).truth["planted"]
