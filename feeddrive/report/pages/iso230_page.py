"""The report of a measured test of ISO 230: one HTML file, its figures, and the JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.metrology.circular import Circular
from feeddrive.metrology.measured.measurements import CircleTest, DriftTest, LinearTest
from feeddrive.metrology.measured.plant_share import PlantShare, Share
from feeddrive.report.figures.drawing import RenderedFigure, render
from feeddrive.report.figures.figure_iso230 import iso230_figures
from feeddrive.report.pages.html import page
from feeddrive.report.pages.markup import Cell, bullets, figure, paragraph, section, table
from feeddrive.report.words.number_text import fixed
from feeddrive.units.quantity import percent

_TITLES = {2: "accuracy and repeatability of positioning", 3: "drift of an axis that warms itself", 4: "circular test"}


@dataclass(frozen=True, eq=False)
class Evaluated230:
    """A measured test, evaluated and ready to be written.

    Attributes:
        name, part: of what was measured, and of the standard (2, 3, 4).
        title: name and standard.
        rows: symbol and value of each figure, as shown.
        test: what was measured; for one axis of a circle its figures.
        share: what a plant explains; None without a plant.
        record: content of the JSON.
    """

    name: str
    part: int
    title: str
    rows: Sequence[Sequence[str]]
    test: LinearTest | DriftTest | CircleTest | Circular
    share: PlantShare | None
    record: Mapping[str, Any]


def write_iso230(found: Evaluated230, folder: Path) -> Path:
    """Write `iso230.json`, `report.html` and the figures into a folder.

    Raises:
        InputError: the folder cannot be written.
    """
    pictures = [render(one) for one in iso230_figures(found.test, found.share)]
    for picture in pictures:
        write_bytes_atomically(folder / f"{picture.stem}.png", picture.png)
    write_text_atomically(folder / "report.html", iso230_page(found, pictures))
    write_text_atomically(folder / "iso230.json", json.dumps(found.record, indent=2, ensure_ascii=False) + "\n")
    return folder


def iso230_page(found: Evaluated230, pictures: list[RenderedFigure]) -> str:
    """The page as text."""
    figures = table(["figure", "#value"], found.rows)
    parts = [section("Graph", figure(pictures[0])), section("Figures", figures)]
    if isinstance(found.test, LinearTest):
        parts.append(section("Targets", _targets(found.test)))
    if found.share is not None:
        explained = paragraph(_share_words(found.share))
        parts.append(section("What the plant explains", explained, _shares(found.share), *map(figure, pictures[1:])))
    parts.append(section("How it was evaluated", bullets(_method(found))))
    return page(f"{found.name}: {_TITLES[found.part]}", found.title, "".join(parts))


def _targets(test: LinearTest) -> str:
    """Target, mean and s of each direction, and B."""
    heads, columns = ["#target"], [[f"{1e3 * place:.6g} mm" for place in test.target]]
    for name, side in test.sides.items():
        arrow = "↑" if name == "up" else "↓"
        heads += [f"#mean {arrow}", f"#s {arrow}", f"#R {arrow}"]
        columns += [_column(side.mean), _column(side.deviation), _column(4 * side.deviation)]
    both = test.both
    if both is not None:
        heads.append("#B")
        columns.append(_column(both.reversal))
    return table(heads, zip(*columns, strict=True), "dense")


def _column(values: Iterable[float]) -> list[str]:
    """Lengths in µm, to the nanometre: what rounding leaves of nothing is shown as nothing."""
    return [f"{fixed(1e6 * value, 3)} µm" for value in values]


def _shares(share: PlantShare) -> str:
    heads = ["", "#E", "#M", "#B", "#explains"]
    rows = [
        _row("measured", share.measured, False),
        _row("the plant alone", share.predicted, False),
        _row("left of the measurement", share.left, True),
        *(_row(f"left if the plant had no {name.replace('_', ' ')}", one, True) for name, one in share.without.items()),
    ]
    return table(heads, rows)


def _row(name: str, one: Share, explains: bool) -> list[str | Cell]:
    lengths = (one.systematic, one.mean_range, one.reversal)
    return [name, *_column(lengths), percent(one.explains, 1) if explains else ""]


def _share_words(share: PlantShare) -> str:
    """Which effects carry what is explained."""
    carried = {name: share.left.explains - one.explains for name, one in share.without.items()}
    order = sorted((name for name, value in carried.items() if value > 0.01), key=lambda name: -carried[name])
    named = "".join(f", {name.replace('_', ' ')} {percent(carried[name])}" for name in order)
    creeps = (
        " Its friction is declared smooth in speed and lets the springs relax at rest: what they keep under friction "
        "(lost motion) is not in the plant's B."
    )
    return (
        f"The plant explains {percent(share.left.explains)} of the squared mean deviations{named}. "
        "The motor is taken to stand where it was sent: a control that reads the scale would hide what the screw does."
        f"{creeps if share.creeps else ''}"
    )


def _method(found: Evaluated230) -> list[str]:
    if isinstance(found.test, LinearTest):
        return [
            "Deviation is actual minus target; s with n − 1; R↑ = 4 s↑; R = max(2 s↑ + 2 s↓ + |B|, R↑, R↓).",
            "A and E over both directions, M over the means of both, B the largest |mean↑ − mean↓|.",
            "The uncertainty that the standard asks for is that of the instrument and is not estimated here.",
        ]
    if isinstance(found.test, DriftTest):
        return [
            "Errors count from the first reading; those of later targets are brought to the times of the first.",
            "Settled: within 5 % of the range while heating, of the value at the stop (a choice of this program).",
        ]
    lines = ["Radial deviations are about the least-squares centre; F is against the nominal radius."]
    if isinstance(found.test, CircleTest):
        lines.append(
            "A glitch is the largest deviation within 30° after a reversal, less centre, radius, gains and "
            "squareness; positive outwards."
        )
        if found.test.nominal is None:
            lines.append("No nominal radius was given: F is against the mean radius of the paths.")
    return lines
