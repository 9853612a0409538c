"""The bench page: its numbers are those of `bode` and `run`, it fetches nothing, and a name stays a name."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

import feeddrive as fd
from feeddrive.bench_page.javascript import javascript
from feeddrive.bench_page.page import settings_of
from feeddrive.errors import InputError
from feeddrive.interface.benching import Bench
from feeddrive.plant.plant import Plant
from feeddrive.servo.loop_response import Loop, open_response
from feeddrive.servo.mechanics_response import Case
from feeddrive.simulate.scenario.scenario_controller import read_controller
from feeddrive.simulate.setpoints.trial_motions import HEIGHT, circle_about, step_at
from tests.analytic.browser import found_in_page

CONTROLLER = "scenarios/controllers/bench_axis.toml"

_COMPUTE = """const E = bench.E; return SETTINGS.map((s) => {
  const loops = computeLoops(E, s), step = computeStep(E, s), circle = computeCircle(E, s);
  return { loops, step: step.table, circle: circle.table, deviation: circle.deviation, glitch: circle.glitch,
           settling: step.figures.settling, overshoot: step.figures.overshoot,
           controller: controllerText(E, s) }; });"""


@pytest.fixture(scope="module")
def page() -> Bench:
    made: Bench = fd.bench(fd.load("bench_axis"), controller=CONTROLLER)
    return made


def _settings(bench: Bench, count: int, generator: np.random.Generator) -> list[dict[str, Any]]:
    """Settings drawn about those at the start: gains, filters, feed-forward, position, payload."""
    plant, drawn = bench.page.plant, []
    low, high = plant.stroke or (0.0, 0.3)
    for _ in range(count):
        one = settings_of(bench.page.cascade, float(generator.uniform(low, high)), float(generator.uniform(0, 80)))
        for key, least in (("velocity_gain", 0.3), ("position_gain", 0.3), ("reset_time", 0.8)):
            one[key] = float(f"{one[key] * generator.uniform(least, 3 * least):.5g}")
        kinds = generator.choice(["none", "notch", "PT2"], 2)
        for place, kind in enumerate(kinds):
            frequency = float(f"{generator.uniform(600, 1800):.4g}")
            one["filters"][place + 1] = {"kind": str(kind), "frequency": frequency, "damping": 0.3, "depth": 12.0}
        one["speed_share"] = float(generator.choice([1.0, 0.9]))
        drawn.append(one)
    return drawn


def _compared(bench: Bench, settings: list[dict[str, Any]], folder: Path) -> int:
    """Numbers of the page beside those of `bode` and `run`; how many settings were stable."""
    found = found_in_page(bench.text, f"const SETTINGS = {json.dumps(settings)};" + _COMPUTE, folder)
    stable = 0
    for number, (one, told) in enumerate(zip(settings, found, strict=True)):
        path = folder / f"{number}.toml"
        path.write_text(told["controller"], encoding="utf-8")
        case = Case(one["position"], payload=one["payload"])
        plant = case.on(bench.page.plant)
        cascade = read_controller(path, plant)
        for loop in Loop:
            response, margins = open_response(bench.page.plant, cascade, loop, case, 1.0, 4000.0)
            seen = told["loops"][str(loop)]
            values = np.array(seen["re"]) + 1j * np.array(seen["im"])
            assert np.array_equal(seen["frequency"], response.frequency)
            # a low-pass is zero at half the rate: what rounding leaves of it is below -240 dB
            np.testing.assert_allclose(values, response.values, rtol=1e-6, atol=1e-12)
            for key in ("gain", "gain_frequency", "phase", "phase_frequency", "sensitivity"):
                there = getattr(margins, key)
                # JSON has no infinity: a margin that there is not is None on the page
                assert (seen["margins"][key] is None) if not np.isfinite(there) else (
                    seen["margins"][key] == pytest.approx(there, rel=1e-6))  # fmt: skip
        if not told["loops"]["stable"]:
            continue
        stable += 1
        _same_runs(bench, one, told, path)
    return stable


def _same_runs(bench: Bench, one: dict[str, Any], told: dict[str, Any], controller: Path) -> None:
    plant = bench.page.plant
    for name, trial in (("step", step_at(plant, one["position"])), ("circle", circle_about(plant, one["position"]))):
        scenario = controller.with_suffix(f".{name}.toml")
        effect = f'[[effect]]\nname = "payload"\nmass = "{one["payload"]!r} kg"\n'
        scenario.write_text(
            f'format = "feeddrive-scenario/1"\nplant = "{plant.name}"\ncontroller = "{controller.name}"\n\n'
            f'[record]\nrate = "8 kHz"\n\n{effect}\n{trial.tables}', encoding="utf-8")  # fmt: skip
        run = fd.run(scenario, plant=bench_axis_of(bench))
        there = run["table_position"]
        # 1e-6 of the motion's range
        np.testing.assert_allclose(told[name], there, rtol=0, atol=1e-6 * float(np.ptp(there)))
        (figure,) = run.figures
        # Where the last digit of a reading decides into which step of an encoder it falls, the loop goes on from
        # another step, and the table with it.
        finest = max(1e-6 * float(np.ptp(there)), _encoder_step(plant))
        assert finest < 2e-8
        if name == "step":
            # neither knows a time for what has not settled
            assert told["settling"] == (
                None if figure["settling"] is None else pytest.approx(figure["settling"], abs=1e-9)
            )
            assert told["overshoot"] == pytest.approx(figure["overshoot"], abs=finest / HEIGHT)
        else:
            assert told["deviation"] == pytest.approx(figure["deviation"], abs=finest)
            assert told["glitch"] == pytest.approx(figure["glitch"], abs=finest)


def _encoder_step(plant: Plant) -> float:
    """Of the finest of the encoders, as travel of the table [m]."""
    radius = {"motor_angle": plant.chain.motor_radius, "table_position": 1.0}
    return min(one.resolution * radius[one.channel] for one in plant.sensors if one.channel in radius)


def bench_axis_of(bench: Bench) -> fd.Axis:
    """The axis whose plant the page has."""
    names = {fd.load(name).plant.name: name for name in ("bench_axis", "kimm_testbed", "vertical_axis")}
    return fd.load(names[bench.page.plant.name])


def test_numbers_are_those_of_bode_and_run(page: Bench, tmp_path: Path, generator: np.random.Generator) -> None:
    assert _compared(page, _settings(page, 3, generator), tmp_path) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bench_axis", "kimm_testbed", "vertical_axis"])
def test_numbers_at_twenty_settings(name: str, tmp_path: Path, generator: np.random.Generator) -> None:
    bench = fd.bench(fd.load(name), controller=None if name != "bench_axis" else CONTROLLER)
    assert _compared(bench, _settings(bench, 20, generator), tmp_path) >= 8


def test_page_is_one_file_and_asks_for_nothing(page: Bench) -> None:
    text = page.text
    assert "default-src 'none'" in text
    assert not re.search(r'(?:src|href)\s*=\s*["\']', text.replace("href = URL", ""))
    assert not re.search(r"https?:|//[a-z]|@import|url\(|fetch\(|XMLHttpRequest|WebSocket|import\(", text)


def test_hostile_name_stays_a_name(tmp_path: Path) -> None:
    name = '</script><script>window.bad=1</script><img src=x onerror="window.bad=2">"\'\\u2028'
    axis = fd.load("bench_axis")
    made = fd.bench(axis, controller=CONTROLLER)
    hostile = replace(made, page=replace(made.page, plant=replace(made.page.plant, name=name)))
    found = found_in_page(
        hostile.text,
        "return { bad: window.bad === undefined, heading: document.querySelector('h1').textContent, "
        "scripts: document.scripts.length, toml: controllerText(bench.E, bench.S) }", tmp_path)  # fmt: skip
    assert found["bad"] and found["scripts"] == 3  # data, page, and the one that asks
    assert "</script><script>" in found["heading"]
    (tmp_path / "c.toml").write_text(found["toml"], encoding="utf-8")
    read_controller(tmp_path / "c.toml", axis.plant)


def test_sliders_move_the_picture(page: Bench, tmp_path: Path) -> None:
    found = found_in_page(page.text, """
      const shot = () => document.getElementById("bode").toDataURL(), before = shot();
      const told = () => document.getElementById("numbers").textContent, first = told();
      const slider = document.querySelector('input[type=range]');
      slider.value = 300; slider.dispatchEvent(new Event("input")); bench.draw(true);
      const after = shot();
      return { changed: before !== after, told: first !== told(), gain: bench.S.velocity_gain,
               labels: document.querySelectorAll("input[type=range]").length };
    """, tmp_path)  # fmt: skip
    assert found["changed"] and found["told"] and found["labels"] > 10
    assert found["gain"] < page.page.cascade.velocity_gain


def test_sliders_of_effects_are_in_units_of_the_trade(tmp_path: Path) -> None:
    """A lead error of 40 µm/m was 4e-5 m/m, and a place at 160 mm was 160000 µm."""
    worn = fd.load("bench_axis").with_effects(
        fd.effect("lead_error_cumulative", slope="40 um/m"),
        fd.effect("friction_vs_position", peak="38 N", centre="160 mm", half_width="45 mm"),
    )
    found = found_in_page(fd.bench(worn, controller=CONTROLLER).text, """
      const typed = [...document.querySelectorAll("input.typed")];
      return Object.fromEntries(typed.map((one) => [one.getAttribute("aria-label"), one.value]));
    """, tmp_path)  # fmt: skip
    assert float(found["slope µm/m"]) == pytest.approx(40)
    assert float(found["centre mm"]) == pytest.approx(160)
    assert float(found["peak N"]) == pytest.approx(38)


def test_what_the_page_does_not_move_is_kept_or_refused(tmp_path: Path) -> None:
    axis, path = fd.load("bench_axis"), tmp_path / "own.toml"
    own = (
        'format = "feeddrive-controller/1"\nvelocity_rate = "8 kHz"\nposition_rate = "2 kHz"\n'
        'position_gain = "60 1/s"\n'
        'velocity_gain = "2 N m s/rad"\nreset_time = "8 ms"\ntracking_time = "5 ms"\nbalancing_time = "1 ms"\n'
        'torque_offset = "0.2 N m"\n[feed_forward]\nspeed = 1.0\ncoulomb = "0.3 N m"\nsmoothing_speed = "2 rad/s"\n'
    )
    path.write_text(own, encoding="utf-8")
    bench = fd.bench(axis, controller=path)
    assert _compared(bench, [settings_of(bench.page.cascade, 0.1)], tmp_path) == 1
    path.write_text(own + '[[filter]]\nat = "speed"\nkind = "PT1"\nfrequency = "300 Hz"\n', encoding="utf-8")
    with pytest.raises(InputError, match="the controller has others"):
        _ = fd.bench(axis, controller=path).text


def test_a_rigid_axis_and_a_folder_without_diagnosis_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="rigid plant has no mode"):
        _ = fd.bench(fd.load("emps")).text
    with pytest.raises(InputError, match="is no diagnosis"):
        fd.bench(fd.load("bench_axis"), controller=CONTROLLER, diagnosis=tmp_path)


def test_every_operation_is_translated_as_casadi_computes_it(tmp_path: Path, generator: np.random.Generator) -> None:
    """Functions of every kind that equations use, against CasADi's own virtual machine."""
    x, y = ca.SX.sym("x", 3), ca.SX.sym("y")
    made = ca.vertcat(
        x[0] * y + ca.tanh(x[1]), ca.fmax(y, x[2]) / (1 + x[0] ** 2), ca.if_else(x[0] > 0, y, ca.exp(-x[1] ** 2)),
        ca.fmod(x[2], 0.7), ca.sign(y) * ca.fabs(x[0]) ** (2 / 3), ca.sin(x[0]) - ca.cos(y) * ca.atan2(x[1], x[2]),
        ca.floor(x[0] / 0.3 + 0.5), ca.sqrt(1 + y**2), ca.logic_and(x[0] > 0, y < 1), ca.log(2 + ca.fabs(y)),
    )  # fmt: skip
    function = ca.Function("made", [x, y], [made, ca.jacobian(made, x)])
    points = generator.normal(size=(20, 4))
    script = f"{javascript(function, 'made')}; return {json.dumps(points.tolist())}.map((p) => {{ const a = Array(10).fill(0), b = Array(30).fill(0); made(p.slice(0, 3), [p[3]], a, b); return a.concat(b); }});"  # noqa: E501
    found = np.array(found_in_page("<!DOCTYPE html><body></body>", script, tmp_path))
    for point, told in zip(points, found, strict=True):
        values = [np.array(one.full()).ravel(order="F") for one in function(point[:3], point[3])]
        # the two libraries' exp, sin, pow may differ in the last digit
        np.testing.assert_allclose(told, np.concatenate(values), rtol=1e-13, atol=1e-14)
