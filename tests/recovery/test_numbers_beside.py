"""Measured numbers beside recordings: one likelihood, so that each tells of the plant what the others leave open."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd
from feeddrive.cli.main import main
from feeddrive.diagnosis.calibration.calibrate import calibrated, calibrated_list
from feeddrive.diagnosis.diagnose import diagnose
from feeddrive.diagnosis.likelihood.fit import Fit, fit
from feeddrive.diagnosis.likelihood.folds import FOLDS, block_numbers, blocks_in_time
from feeddrive.diagnosis.likelihood.problem import Problem
from feeddrive.diagnosis.numbers.measured_file import MEASURABLE, MeasuredNumber, Setting
from feeddrive.diagnosis.numbers.number_rows import MeasuredRows
from feeddrive.diagnosis.preparation import prepared
from feeddrive.effects.chain.payload import Payload
from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.interface.axis import axis_of_text
from feeddrive.plant.plant import Plant
from feeddrive.typing import FloatArray
from tests.recovery.planted import pair


def catalogued() -> fd.Axis:
    """The bench axis with the tolerances of a catalogue: of itself it declares what the recordings were made with."""
    path = plants_folder() / "bench_axis.toml"
    text = path.read_text(encoding="utf-8")
    assert "of the simulated recordings" in text
    return axis_of_text(text.replace("of the simulated recordings", "of a catalogue"), path)


def number(plant: Plant, quantity: str, share: float, factor: float = 1.0) -> MeasuredNumber:
    """A number that the plant gives, times a factor, known to a share of itself (two standard deviations)."""
    setting = Setting(plant.middle)
    value = factor * MEASURABLE[quantity].of(plant, setting)
    return MeasuredNumber(quantity, value, 0.5 * share * value, setting, "")


def problem_of(case: str) -> tuple[Plant, Problem]:
    plant = catalogued().plant
    fitted, judged = pair("bench", case)
    return plant, prepared(plant, [fitted], [judged], 0.75)[0]


def test_a_number_weighs_by_its_own_tolerance() -> None:
    """Most likely values are those of the normal equations of recordings, number and prior, written down here."""
    plant, alone = problem_of("null")
    one = number(plant, "axial_stiffness", 0.01, 1.02)
    beside = calibrated(replace(alone, numbers=MeasuredRows((one,))))
    known, whitened = beside.calibration, beside.whitener
    assert known is not None and whitened is not None
    residual, at = beside.unwhitened(()), known.coordinates

    def given(coordinates: FloatArray) -> float:
        there = replace(beside, calibration=replace(known, coordinates=coordinates)).machine()
        return one.kind.of(there, one.setting) / one.deviation

    slopes = np.array([(given(at + 1e-4 * unit) - given(at - 1e-4 * unit)) / 2e-4 for unit in np.eye(len(at))])
    columns, rows = whitened.columns[:-1], residual[:-1]
    normal = columns.T @ columns / known.variance + np.eye(len(at)) + np.outer(slopes, slopes)
    pulled = columns.T @ (rows + columns @ at) / known.variance
    pulled += slopes * (one.value / one.deviation - given(at) + slopes @ at)
    # slopes by differences to one side over a tenth of a per cent here, to both sides there
    assert whitened.most_likely(residual) == pytest.approx(np.linalg.solve(normal, pulled), abs=2e-3)


def test_what_the_recordings_leave_open_a_number_settles() -> None:
    plant, alone = problem_of("null")
    none = Fit((), np.zeros(0), np.zeros((0, 0)), np.zeros(0))
    key = "axial_stiffness"
    before, after = (
        {one.value.key: one for one in calibrated_list(calibrated(problem), none)}
        for problem in (alone, replace(alone, numbers=MeasuredRows((number(plant, key, 1e-3),))))
    )
    assert after[key].deviation < 0.5 * before[key].deviation
    low, high = after[key].ci95
    assert low <= plant.chain.values[key] <= high


def test_every_row_has_a_block_of_its_own_and_a_fit_takes_it() -> None:
    plant, alone = problem_of("payload")
    numbers = MeasuredRows((number(plant, "natural_frequency", 0.01), number(plant, "drag_torque", 0.05)))
    beside = replace(alone, numbers=numbers)
    effects = [Payload.of(mass=20.0)]
    one = fit(beside, effects)
    assert len(one.residual) == len(fit(alone, effects).residual) + 2 == len(one.jacobian)
    for blocks in (block_numbers(beside), blocks_in_time(beside)):
        assert len(blocks) == len(one.residual)
        assert len({*blocks[-2:], *blocks[:-2]}) == len({*blocks[:-2]}) + 2
    assert block_numbers(beside)[-2] % FOLDS == 0
    # the frequency falls with the payload, the drag does not: its slope is a rounding, on some processors of 1e-13 of
    # 20 deviations, over a step of 1e-4
    assert abs(one.jacobian[-1, 0]) < 1e-7 * abs(one.jacobian[-2, 0])


def test_numbers_that_the_plant_cannot_give_are_refused() -> None:
    plant = catalogued().plant
    fitted, judged = pair("bench", "null")
    second = replace(number(plant, "natural_frequency", 0.01), setting=Setting(plant.middle, mode=9))
    with pytest.raises(InputError, match="there is no mode 9"):
        diagnose(plant, [fitted], [judged], measured=[second])


def test_a_file_of_numbers_alone_is_named_behind_the_plant(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "numbers.toml"
    path.write_text('[[measured]]\nquantity = "axial_stiffness"\nvalue = "200 N/µm"\n', encoding="utf-8")
    words = ["diagnose", "bench_axis", str(path), "--measured", str(path), "--out", str(tmp_path / "out")]
    assert main(words) == 2
    assert "name the file behind the plant" in capsys.readouterr().err


@pytest.mark.slow
def test_a_diagnosis_tells_what_the_numbers_are_and_become(tmp_path: Path) -> None:
    """The payload is found by the recordings; the frequency that was measured falls to where it is."""
    axis = catalogued()
    true = axis.plant.with_effects(Payload.of(mass=22.0))
    one, other = number(true, "natural_frequency", 0.01), number(true, "axial_stiffness", 0.02)
    path = tmp_path / "numbers.toml"
    path.write_text(
        f'[[measured]]\nquantity = "natural_frequency"\nvalue = "{one.value!r} Hz"\ntolerance = "1 %"\n'
        f'[[measured]]\nquantity = "axial_stiffness"\nvalue = "{other.value!r} N/m"\ntolerance = "2 %"\n',
        encoding="utf-8",
    )
    fitted, judged = pair("bench", "payload")
    found = fd.diagnose(axis, fitted, validate=judged, measured=path)
    assert [effect.name for effect in found.diagnosis.effects] == ["payload"]
    frequency, stiffness = found.diagnosis.measured
    assert frequency.met and stiffness.met
    assert abs(frequency.before / frequency.number.value - 1) > 0.05  # the declared plant has it without the payload
    written = found.save(tmp_path / "out")
    record = json.loads((written / "diagnosis.json").read_text(encoding="utf-8"))
    assert [row["met"] for row in record["measured"]] == [True, True]
    assert "Measured numbers" in (written / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("case", ["null", "payload"])
def test_a_number_that_all_else_contradicts_is_told_and_not_fitted(case: str) -> None:
    """A quarter less than the stiffness that recordings tell to a per cent; a right one beside it is fitted."""
    plant = catalogued().plant
    wrong, right = number(plant, "axial_stiffness", 0.01, 0.74), number(plant, "drag_torque", 0.05)
    fitted, judged = pair("bench", case)
    found, _ = diagnose(plant, [fitted], [judged], measured=[wrong, right])
    assert [effect.name for effect in found.effects] == ([] if case == "null" else [case])
    assert {one.number.quantity: one.fitted for one in found.measured} == {
        "drag_torque": True,
        "axial_stiffness": False,
    }
    assert any("axial_stiffness" in note and "it was not fitted" in note for note in found.notes)
