"""A lead map tells nothing of a name, and counts again once the names are found."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from feeddrive.diagnosis.motion.lead_map import lead_map
from feeddrive.diagnosis.motion.preparing import prepare
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.recording import Recording

SCREW = 0.010
"""Travel of a revolution [m]."""


def test_a_stroke_of_few_revolutions_has_no_map() -> None:
    for revolutions, count in ((1.5, 0), (2.5, 1), (3.5, 2), (40.0, 2)):
        place = np.linspace(0.0, revolutions * SCREW, 100)
        columns = lead_map(place, SCREW / (2 * math.pi))
        assert columns.shape == (100, count)
        assert np.all(np.abs(columns.T @ (place - place.mean())) < 1e-9)  # beside a line


def test_a_parabola_is_taken_out_of_comparisons_and_not_of_the_rest() -> None:
    plant = read_plant(Path(plants_folder()) / "bench_axis.toml")
    radius = plant.chain.motor_radius
    time = np.arange(0.0, 8.0, 1e-3)
    angle = 0.05 / radius * (1 - np.cos(2 * np.pi * 0.5 * time))
    noise = 1e-7 * np.random.default_rng(1).standard_normal(len(time))
    table = radius * angle + noise
    evidence = prepare(Recording("map", time, {"motor_angle": angle, "table_position": table}, 1e-3), plant, 1.0)
    rows = evidence.thinned(evidence.fit_rows)
    x = table - table.mean()
    shapes = {"map": (4e-6 * (x / 0.05) ** 2, 0.0), "line": (4e-6 * x / 0.05, 1.0)}
    shapes["revolutions"] = (4e-6 * np.sin(2 * np.pi * x / SCREW), 1.0)
    for shape, told in shapes.values():
        series = {"table_position": evidence.in_band(shape)}
        left, whole = (float(np.linalg.norm(one.weighted(series, rows))) for one in (evidence.with_map(True), evidence))
        # the scale's own noise, a five-hundredth of the stroke's, is in the columns; the ends of the stroke are cut off
        assert abs(left / whole - told) < 0.03


def test_a_map_of_no_columns_takes_nothing_away() -> None:
    """A recording of a short stroke is judged beside one whose map is open."""
    plant = read_plant(Path(plants_folder()) / "bench_axis.toml")
    time = np.arange(0.0, 8.0, 1e-3)
    angle = 0.6 * np.pi * (1 - np.cos(2 * np.pi * 0.5 * time))
    table = plant.chain.motor_radius * angle + 1e-7 * np.random.default_rng(1).standard_normal(len(time))
    evidence = prepare(Recording("short", time, {"motor_angle": angle, "table_position": table}, 1e-3), plant, 1.0)
    assert evidence.lead_map is not None and evidence.lead_map.shape[1] == 0
    rows, series = evidence.thinned(evidence.fit_rows), {"table_position": evidence.in_band(table)}
    opened = evidence.with_map(True)
    assert np.array_equal(opened.weighted(series, rows), evidence.weighted(series, rows))
