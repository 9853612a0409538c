"""Figures of stiffness: the numbers that they show, and what they refuse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.errors import InputError
from feeddrive.files import plants_folder
from feeddrive.parts.combined_stiffness import combined_stiffness, stiffness_along
from feeddrive.plant.file.plant_file import read_plant
from feeddrive.report.figures.drawing import ReportFigure, render
from feeddrive.report.figures.figure_stiffness import participation_figure, stiffness_position_figure
from tests.analytic.stiffness_cases import AT_NUT, paper_drive

POSITIONS = np.linspace(0.1, 1.1, 11)


def _texts(entry: ReportFigure) -> list[str]:
    return [text.get_text().replace("\n", " ") for axes in entry.figure.axes for text in axes.texts]


def test_every_part_is_labelled_with_its_share() -> None:
    entry = participation_figure(combined_stiffness(paper_drive(), AT_NUT))
    assert set(_texts(entry)) == {
        "axial 83 %", "torsional 17 %", "screw 43 %", "bearing 26 %", "nut 14 %", "coupling 8 %", "screw 7 %",
        "motor shaft 3 %",
    }  # fmt: skip
    widths = [patch.get_width() for patch in entry.figure.axes[0].patches]
    assert sum(widths) == pytest.approx(100.0, rel=1e-12)  # rounding
    assert "202.8" in entry.caption


def test_lines_are_the_stiffness_along_the_stroke() -> None:
    drives = {"one end": paper_drive(), "both ends": paper_drive(both_ends=True)}
    entry = stiffness_position_figure(drives, POSITIONS)
    lines = entry.figure.axes[0].get_lines()
    for line, drive in zip(lines, drives.values(), strict=True):
        assert np.array_equal(line.get_xdata(), 1e3 * POSITIONS)
        assert np.array_equal(line.get_ydata(), stiffness_along(drive, POSITIONS) / 1e6)
    assert len(entry.figure.axes[1].get_lines()) == 4
    assert "one end 138, both ends 300" in entry.caption


def test_too_many_drives_are_refused() -> None:
    with pytest.raises(InputError, match="5 drives in one figure"):
        stiffness_position_figure({str(i): paper_drive() for i in range(5)}, POSITIONS)
    with pytest.raises(InputError, match="0 drives in one figure"):
        stiffness_position_figure({}, POSITIONS)


@pytest.mark.parametrize("housing", [None, 3e9])
def test_figures_render(housing: float | None) -> None:
    drive = replace(paper_drive(both_ends=True), housing_stiffness=housing)
    png = render(participation_figure(combined_stiffness(drive, AT_NUT))).png
    assert png.startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["vertical_axis", "hsr_axis", "kimm_testbed"])
def test_labels_of_shipped_machines_do_not_meet(name: str) -> None:
    plant = read_plant(plants_folder() / f"{name}.toml")
    assert plant.drive is not None
    entry = participation_figure(combined_stiffness(plant.drive, 0.4 * plant.drive.screw.length))
    render(entry)
    boxes = [text.get_window_extent() for axes in entry.figure.axes for text in axes.texts]
    assert not [(a, b) for i, a in enumerate(boxes) for b in boxes[:i] if a.overlaps(b)]
