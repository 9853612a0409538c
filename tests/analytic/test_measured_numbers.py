"""Measured numbers against a plant file: evidence in closed form, planted values found, files checked."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.diagnosis.numbers.explanations import explanations, inclusion, numbers_problem
from feeddrive.diagnosis.numbers.measured_file import MEASURABLE, Setting, read_measured_numbers
from feeddrive.diagnosis.numbers.next_number import mixed, next_numbers
from feeddrive.diagnosis.numbers.numbers_result import diagnose_numbers
from feeddrive.diagnosis.plant_text import with_written_values
from feeddrive.report.words.explained_words import numbers_verdict

HEAD = 'format = "feeddrive-measured/1"\n'


def written(folder: Path, *numbers: str) -> Path:
    """A file of measured numbers."""
    path = folder / "measured.toml"
    path.write_text(HEAD + "".join(f"[[measured]]\n{one}\n" for one in numbers), encoding="utf-8")
    return path


def of_machine(axis: fd.Axis, folder: Path, places: tuple[float, ...] = (0.1, 0.45, 0.9), noise: float = 0.0) -> Path:
    """Stiffness and first frequency of a machine at some places, perhaps with noise of half their tolerance."""
    generator = np.random.default_rng(7)
    numbers = []
    for at in places:
        for quantity, unit, share in (("axial_stiffness", "N/m", 0.01), ("natural_frequency", "Hz", 0.005)):
            value = MEASURABLE[quantity].of(axis.plant, Setting(at))
            value *= 1 + noise * 0.5 * share * generator.standard_normal()
            numbers.append(
                f'quantity = "{quantity}"\nvalue = "{value!r} {unit}"\nat = "{at} m"\ntolerance = "{100 * share} %"'
            )
    return written(folder, *numbers)


def result_of(axis: fd.Axis, path: Path):  # type: ignore[no-untyped-def]
    return diagnose_numbers(axis.entries, axis.path, axis.plant, read_measured_numbers(path, axis.plant))


def test_evidence_is_the_density_of_the_numbers(tmp_path: Path) -> None:
    """Of a linear model the evidence is N(y; f, J P J' + Σ) exactly; small differences keep the model linear."""
    axis = fd.load("kimm_testbed")
    k = axis.stiffness(at="464 mm").total
    path = written(
        tmp_path, f'quantity = "axial_stiffness"\nvalue = "{1.001 * k!r} N/m"\nat = "464 mm"\ntolerance = "1 %"'
    )
    problem = numbers_problem(axis.entries, axis.path, axis.plant, read_measured_numbers(path, axis.plant))
    sets = explanations(problem)
    none = next(one for one in sets if not one.beyond)
    slopes = problem.slopes(np.zeros(len(problem.values)))[0]
    variance = np.array([one.deviation**2 for one in problem.values])
    spread = float(slopes**2 @ variance) + (0.5 * 0.01 * 1.001 * k) ** 2
    exact = -0.5 * (0.001 * k) ** 2 / spread - 0.5 * math.log(2 * math.pi * spread)
    # the missing housing cannot be below none, which the Gaussian does not know; the difference asked of it is 1e-3
    assert none.log_evidence == pytest.approx(exact, abs=0.05)
    assert sum(one.probability for one in sets) == pytest.approx(1.0)


def test_nothing_is_named_where_all_is_as_declared(tmp_path: Path) -> None:
    axis = fd.load("kimm_testbed")
    for number in range(2):
        folder = tmp_path / str(number)
        folder.mkdir()
        result = result_of(axis, of_machine(axis, folder, noise=1.0))
        assert not result.beyond
        assert not result.suspects
        assert result.explained


def test_nothing_is_named_within_tolerance(tmp_path: Path) -> None:
    """A nut 8 % softer, of 20 % that its catalogue leaves open, is calibration."""
    axis = fd.load("kimm_testbed")
    result = result_of(axis, of_machine(axis.with_values({"nut.axial_stiffness": "1380 N/µm"}), tmp_path))
    assert not result.beyond
    assert result.explained


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "text", "value"), [("table.mass", "190 kg", 190.0), ("ball_screw.diameter", "34 mm", 0.034)]
)
def test_a_value_beyond_its_tolerance_is_found(tmp_path: Path, key: str, text: str, value: float) -> None:
    axis = fd.load("kimm_testbed")
    found = fd.explain(axis, of_machine(axis.with_values({key: text}), tmp_path))
    beyond = found.result.beyond
    assert [one.value.key for one in beyond] == [key]
    # numbers of 0.5 to 1 % through values with tolerances of their own: the interval says how well it is known
    assert beyond[0].interval[0] <= value <= beyond[0].interval[1]
    assert beyond[0].now == pytest.approx(value, rel=0.03)
    assert found.plant.with_values({}).plant.name == axis.plant.name


@pytest.mark.slow
def test_springs_in_series_are_told_as_a_set(tmp_path: Path) -> None:
    """Nut, bearing and housing lie in series: numbers at the table cannot tell which of them is soft."""
    axis = fd.load("kimm_testbed")
    result = result_of(axis, of_machine(axis.with_values({"nut.axial_stiffness": "600 N/µm"}), tmp_path))
    named = {one.value.key for one in (*result.beyond, *result.suspects)}
    assert "nut.axial_stiffness" in named or "support.housing_stiffness" in named
    meeting = {one.value.key for one in result.singles if one.meets}
    assert {"nut.axial_stiffness", "support.housing_stiffness"} <= meeting
    chances = inclusion(result.problem, result.sets)
    assert np.max(chances) < 20 / 21  # none of them is asserted


def test_the_paper_is_explained_within_tolerances() -> None:
    """191 N/µm and 185 Hz against 202.8 and 185.6 computed: no single value meets both, tolerances do."""
    axis = fd.load("kimm_testbed")
    found = fd.explain(axis, Path(__file__).parents[2] / "scenarios" / "measured" / "kimm_testbed.toml")
    result = found.result
    assert result.declared == pytest.approx([202.76e6, 185.55], rel=1e-3)
    assert not result.beyond
    assert result.explained
    assert not any(one.meets for one in result.singles)
    assert "nothing has to be other than declared" in found.verdict
    assert result.further[0].information > 2.0
    after = [one.kind.of(found.plant.plant, one.setting) for one in result.problem.measured]
    assert after == pytest.approx(list(result.after), rel=1e-9)  # the plant that is written is the one that was told


def test_further_number_narrows_what_is_open(tmp_path: Path) -> None:
    """The information that is foretold is the one that the number brings: ½ log2 of the variances' ratio."""
    axis = fd.load("kimm_testbed")
    path = written(tmp_path, 'quantity = "axial_stiffness"\nvalue = "200 N/µm"\nat = "464 mm"\ntolerance = "1 %"')
    problem = numbers_problem(axis.entries, axis.path, axis.plant, read_measured_numbers(path, axis.plant))
    sets = explanations(problem)
    _, covariance = mixed(sets)
    place = next(i for i, one in enumerate(problem.values) if one.key == "nut.axial_stiffness")
    nut = next(one for one in next_numbers(problem, sets) if one.name == "nut stiffness")
    before = covariance[place, place]
    after = 1 / (1 / before + 1 / 0.025**2)
    assert nut.information == pytest.approx(0.5 * math.log2(before / after))


@pytest.mark.parametrize("name", ["bench_axis", "light_axis", "hsr_axis", "vertical_axis", "kimm_testbed"])
def test_every_quantity_of_every_elastic_machine(name: str) -> None:
    """What a plant gives agrees with its own linear algebra and equations, computed another way."""
    axis = fd.load(name)
    plant, at = axis.plant, axis.plant.middle
    stiffness = MEASURABLE["axial_stiffness"].of(plant, Setting(at))
    K = np.array(plant.chain.stiffness(plant.chain_values(), at), dtype=float)
    if plant.drive is None or plant.drive.motor.brake is None:
        held = np.linalg.inv(K[1:, 1:])[-1, -1]
        # the budget tells springs part by part and the chain by its matrices; both to rounding of the parts' values
        assert stiffness == pytest.approx(1 / held, rel=1e-3)
    first = MEASURABLE["natural_frequency"].of(plant, Setting(at, "free", 1))
    assert first == pytest.approx(axis.modes(at).free[0, 0])
    lost = MEASURABLE["lost_motion"].of(plant, Setting(at))
    assert 0 < lost < 50e-6
    worn = axis.with_effects(fd.effect("backlash", width="7.5 um")).plant
    # play adds to the wind-up as it is; a weight above the friction keeps the nut on one flank, and there is none
    play = 0.0 if name == "vertical_axis" else 7.5e-6
    assert MEASURABLE["lost_motion"].of(worn, Setting(at)) == pytest.approx(lost + play, rel=1e-6)


@pytest.mark.parametrize(
    ("number", "words"),
    [
        ('quantity = "axial_stifness"\nvalue = "191 N/µm"', "axial_stiffness"),
        ('quantity = "axial_stiffness"\nvalue = 191', "bare number"),
        ('quantity = "axial_stiffness"\nvalue = "191 Hz"', "Hz"),
        ('quantity = "axial_stiffness"\nvalue = "-191 N/µm"', "not above zero"),
        ('quantity = "axial_stiffness"\nvalue = "191 N/µm"\nat = "3 m"', "off the stroke"),
        ('quantity = "axial_stiffness"\nvalue = "191 N/µm"\nmode = 1', "mode"),
        ('quantity = "axial_stiffness"\nvalue = "191 N/µm"\ntolerance = "0 %"', "not above zero"),
        ('quantity = "natural_frequency"\nvalue = "185 Hz"\nmode = 0', "count from 1"),
        ('quantity = "natural_frequency"\nvalue = "185 Hz"\nmode = 40', "there is no mode 40"),
        ('quantity = "natural_frequency"\nvalue = "185 Hz"\nmotor = "loose"', "loose"),
        ('quantity = "lost_motion"\nvalue = "3 um"\nvelocity = "0 m/min"', "velocity"),
    ],
)
def test_mistakes_are_told_in_one_line(tmp_path: Path, number: str, words: str) -> None:
    with pytest.raises(fd.InputError) as caught:
        fd.explain(fd.load("kimm_testbed"), written(tmp_path, number))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_values_are_written_where_they_stand() -> None:
    text = '[table]\nmass = "134 kg"  # weighed\n[[effect]]\nname = "guide_friction"\ncoulomb = "60 N"\n'
    changed = with_written_values(
        text,
        {
            "table.mass": ("190.0 kg", "2 %", "found"),
            "effect.guide_friction.coulomb": ("80.0 N", "5 %", "found"),
            "nut.axial_stiffness": ("900.0 N/m", "5 %", "found"),
        },
    )
    assert "# weighed" in changed
    assert changed.count("mass = ") == 1
    with pytest.raises(fd.InputError):
        with_written_values('table = { mass = "134 kg" }\n', {"table.mass": ("190.0 kg", "2 %", "found")})


def test_files_of_the_command(tmp_path: Path) -> None:
    axis = fd.load("kimm_testbed")
    numbers = of_machine(axis.with_values({"table.mass": "190 kg"}), tmp_path)
    out = fd.explain(axis, numbers).save(tmp_path / "out")
    record = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert record["format"] == "feeddrive-diagnosis/1"
    assert [one["name"] for one in record["effects"]] == ["payload"]
    assert record["effects"][0]["parameters"]["mass"]["value"] == pytest.approx(56.0, rel=0.1)
    after = fd.load(out / "plant_after.toml")
    assert after.plant.chain_values()["table_mass"] == pytest.approx(190.0, rel=0.02)
    before, left = (sum(one[when]["relative"] for one in record["channels"]) for when in ("before", "after"))
    assert left < 0.1 * before
    assert (out / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_a_value_that_is_asserted_does_not_hide_that_another_is_beyond_too(tmp_path: Path) -> None:
    """A table of 82 kg keeps the frequency of a stiffness of 120 N/µm, which it cannot make: a spring is soft too."""
    axis = fd.load("kimm_testbed")
    stiff = 'quantity = "axial_stiffness"\nvalue = "120 N/µm"\nat = "464 mm"\ntolerance = "2 %"'
    first = 'quantity = "natural_frequency"\nmotor = "held"\nvalue = "185 Hz"\nat = "464 mm"\ntolerance = "2 Hz"'
    result = result_of(axis, written(tmp_path, stiff, first))
    assert [one.value.key for one in result.beyond] == ["table.mass"]
    assert len(result.suspects) > 1 and "table.mass" not in {one.value.key for one in result.suspects}
    line = numbers_verdict(result)[0]
    assert line.startswith("Other than declared: table mass") and "So is one more value" in line


@pytest.mark.parametrize("value", ["191 N/m", "191 kN/um"])
def test_a_number_in_another_unit_is_refused(tmp_path: Path, value: str) -> None:
    """A million times less than the plant gives is no bracket: the unit is the next prefix, or the one after."""
    path = tmp_path / "numbers.toml"
    text = f'format = "feeddrive-measured/1"\n[[measured]]\nquantity = "axial_stiffness"\nvalue = "{value}"\n'
    path.write_text(text, encoding="utf-8")
    with pytest.raises(fd.InputError, match=r"is measured where the plant gives .*; correct the unit"):
        fd.explain("kimm_testbed", path)
