"""Rated life of a plant's ball screw: closed forms at no force, beyond opening, and between."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.files import plants_folder
from feeddrive.parts.life.life import life_together
from feeddrive.parts.screw.double_nut import rigid_sharing
from feeddrive.plant.analysis.rated_life import rated_life
from feeddrive.plant.file.plant_file import read_plant

HSR = (plants_folder() / "hsr_axis.toml").read_text(encoding="utf-8")
PRELOAD, RATING, LEAD, SLOPE = 3600.0, 52e3, 0.016, 3.6


def _rows(tmp_path: Path, *changes: tuple[str, str]) -> list[tuple[float, float]]:
    text = HSR
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "axis.toml"
    path.write_text(text, encoding="utf-8")
    return [(row.force, row.revolutions) for row in rated_life(read_plant(path))]


def test_preload_alone_takes_two_equal_nuts() -> None:
    row = rated_life(read_plant(plants_folder() / "hsr_axis.toml"))[0]
    assert row.force == 0.0
    assert row.nut_loads == pytest.approx((PRELOAD, PRELOAD), rel=1e-9)
    assert row.revolutions == pytest.approx(1e6 * (RATING / PRELOAD) ** 3 * 2 ** (-1 / SLOPE), rel=1e-9)
    assert row.travel == pytest.approx(row.revolutions * LEAD, rel=1e-12)
    # 40 m/min on a lead of 16 mm are 2500 rev/min.
    assert row.time == pytest.approx(row.revolutions / 2500 * 60, rel=1e-12)


def test_axial_load_is_shared_with_the_preload() -> None:
    row = rated_life(read_plant(plants_folder() / "hsr_axis.toml"))[1]
    assert row.nut_loads == pytest.approx(rigid_sharing(4000.0, PRELOAD), rel=1e-12)
    lives = [1e6 * (RATING / load) ** 3 for load in row.nut_loads]
    assert row.revolutions == pytest.approx(sum(life**-SLOPE for life in lives) ** (-1 / SLOPE), rel=1e-9)


def test_beyond_opening_one_nut_carries_all(tmp_path: Path) -> None:
    rows = _rows(tmp_path, ('axial_load = "4 kN"', 'axial_load = "20 kN"'))
    assert rows[1][1] == pytest.approx(1e6 * (RATING / 20e3) ** 3, rel=1e-6)


def test_more_than_half_the_rating_is_told(tmp_path: Path) -> None:
    with pytest.warns(ValidityWarning, match="of the rating"):
        _rows(tmp_path, ('axial_load = "4 kN"', 'axial_load = "30 kN"'))


def test_no_rating_no_life(tmp_path: Path) -> None:
    assert _rows(tmp_path, ('dynamic_rating = "52 kN"', "")) == []
    assert rated_life(read_plant(plants_folder() / "kimm_testbed.toml")) == ()


def test_lives_together() -> None:
    assert life_together([2.0, 2.0]) == pytest.approx(2.0 * 2 ** (-1 / SLOPE), rel=1e-12)
    assert life_together([2.0, math.inf]) == 2.0
    assert life_together([math.inf]) == math.inf


@pytest.mark.parametrize(("lives", "whole"), [([0.0, 1e6], 0.0), ([math.inf, math.inf], math.inf), ([5.0], 5.0)])
def test_a_set_of_bodies_lasts_no_longer_than_one_of_them(lives: list[float], whole: float) -> None:
    assert life_together(lives) == pytest.approx(whole)


@pytest.mark.parametrize("lives", [[], [-1.0, 1.0], [math.nan]])
def test_lives_that_are_none(lives: list[float]) -> None:
    with pytest.raises(InputError, match="none of them negative"):
        life_together(lives)
