"""A friction that is computed from carriages: what a recording tells of it stands in [guide], and is read back."""

from __future__ import annotations

from pathlib import Path

import pytest

from feeddrive.diagnosis.calibration.calibrated_result import CalibratedResult
from feeddrive.diagnosis.calibration.declared import calibrated_values
from feeddrive.diagnosis.plant_text import with_calibrated_values
from feeddrive.effects.friction.guide_friction import GuideFriction
from feeddrive.plant.file.plant_file import read_plant

HSR = Path(__file__).resolve().parents[2] / "plants" / "hsr_axis.toml"


def guide_values(path: Path) -> dict[str, float]:
    """Values of the guide friction of a plant file."""
    (found,) = [one for one in read_plant(path).effects if isinstance(one, GuideFriction)]
    return {key: float(found.values[key]) for key in ("coulomb", "smoothing_velocity", "film_force")}  # type: ignore[arg-type]


def test_calibrated_friction_of_carriages_is_read_back(tmp_path: Path) -> None:
    """Twice, as a later recording calibrates the plant that an earlier one wrote."""
    path, factors = HSR, {"table.coulomb": 1.3, "table.smoothing_velocity": 0.5}
    before = guide_values(path)
    for turn in (1, 2):
        values = [one for one in calibrated_values(read_plant(path)) if one.key in factors]
        assert len(values) == 2
        results = [
            CalibratedResult(
                one.key, one.words, one.unit, one.declared, one.declared * factors[one.key],
                (0.9 * one.declared * factors[one.key], 1.1 * one.declared * factors[one.key]), 0.3, one.written,
            )
            for one in values
        ]  # fmt: skip
        text = with_calibrated_values(path.read_text(encoding="utf-8"), results)
        path = tmp_path / f"after_{turn}.toml"
        path.write_text(text, encoding="utf-8")
        after = guide_values(path)
        assert after["coulomb"] == pytest.approx(1.3**turn * before["coulomb"], rel=1e-12)
        assert after["smoothing_velocity"] == pytest.approx(0.5**turn * before["smoothing_velocity"], rel=1e-12)
        assert after["film_force"] == before["film_force"]
