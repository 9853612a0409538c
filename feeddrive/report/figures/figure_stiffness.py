"""Figures along the stroke of a machine: static stiffness, whose compliance it is, and natural frequencies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from feeddrive.errors import InputError
from feeddrive.parts.combined_stiffness import CombinedStiffness, Deformation, combined_stiffness, stiffness_along
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.analysis.mode_map import ModeMap, mode_map
from feeddrive.plant.analysis.modes import held_frequency
from feeddrive.plant.plant import Plant
from feeddrive.report.figures.drawing import AFTER, BEFORE, ReportFigure, dress, legend_above, new_figure
from feeddrive.report.words.number_text import fixed, significant, with_unit
from feeddrive.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_PLACES = 61
"""Nut positions of the figure along the stroke."""

_SHADES = {
    Deformation.AXIAL: ("#0072b2", "#4c9ccb", "#8fc1de", "#bcd9ea", "#dcebf4"),
    Deformation.TORSIONAL: ("#d55e00", "#e58a45", "#f0b288", "#f6d0b5", "#fae5d8"),
}
_DARK_SHADES = 2
"""How many shades of each chain are dark enough for white text."""

_ROW = 0.3
"""Height of a row of labels below the bar, which is 0.72 high."""

_LETTER, _LEAST_LETTERS = 0.0085, 7
"""Share that one letter of a label takes, and letters that any label has; a narrower part has its label below."""

_LINES = (("#0072b2", "-"), ("#d55e00", "--"), ("#009e73", "-."), ("#cc79a7", ":"))


def stiffness_figures(plant: Plant, position: float) -> tuple[ReportFigure, ...]:
    """Whose compliance it is at a position [m], then stiffness along the stroke; none without parts of a screw."""
    if plant.drive is None or not plant.chain.varies:
        return ()
    first, length = plant.chain.nut_at_zero, plant.drive.screw.length
    low, high = plant.stroke or (-first, length - first)
    # the nut has screw on both sides
    places = np.clip(first + np.linspace(low, high, _PLACES), 1e-3 * length, 0.999 * length)
    return (
        participation_figure(combined_stiffness(plant.drive, first + position)),
        stiffness_position_figure({plant.name: plant.drive}, places),
    )


def participation_figure(found: CombinedStiffness) -> ReportFigure:
    """One bar of all compliances at the table, axial parts at the left, torsional at the right, each part by share."""
    figure = new_figure(1.75)
    axes = figure.subplots()
    left, below = 0.0, list[tuple[float, str]]()
    for chain in Deformation:
        share = found.share(chain)
        if share <= 0.0:
            continue
        _brace(axes, left, share, f"{chain.value} {100.0 * share:.0f} %")
        left = _chain_bar(axes, found, chain, left, below)
    rows = _labels_below(axes, below)
    axes.set_xlim(0.0, 100.0)
    axes.set_ylim(-0.45 - _ROW * max(rows, 2), 1.0)
    axes.set_yticks([])
    dress(axes, "share in the compliance at the table [%]", "")
    axes.spines["left"].set_visible(False)
    axes.grid(False)
    return ReportFigure("stiffness_shares", "Which part gives way", _participation_caption(found), figure)


def _chain_bar(
    axes: Axes, found: CombinedStiffness, chain: Deformation, left: float, below: list[tuple[float, str]]
) -> float:
    """The parts of one chain, the softest first; adds the labels that find no room to those below the bar, and returns
    where the next chain begins."""
    parts = sorted(found.shares_within(chain).items(), key=lambda one: -one[1])
    for number, (part, within) in enumerate(parts):
        share = within * found.share(chain)
        shade = _SHADES[chain][min(number, len(_SHADES[chain]) - 1)]
        axes.barh(0.0, 100.0 * share, left=100.0 * left, color=shade, height=0.72, edgecolor="white", linewidth=0.8)
        middle, text = 100.0 * (left + share / 2.0), f"{part}\n{100.0 * share:.0f} %"
        if share >= _LETTER * max(len(part), _LEAST_LETTERS):
            colour = "white" if number < _DARK_SHADES else "#222222"
            axes.text(middle, 0.0, text, ha="center", va="center", fontsize=8.5, color=colour)
        else:
            below.append((middle, text.replace("\n", " ")))
        left += share
    return left


def _labels_below(axes: Axes, labels: list[tuple[float, str]]) -> int:
    """Labels under their parts, each in the first row where it meets no other; returns how many rows there are."""
    ends: list[float] = []
    for middle, text in labels:
        half = 50.0 * _LETTER * (len(text) + 1)
        row = next((i for i, end in enumerate(ends) if middle - half > end), len(ends))
        ends[row:] = [middle + half, *ends[row + 1 :]]
        axes.text(middle, -0.42 - _ROW * row, text, ha="center", va="top", fontsize=8)
    return len(ends)


def _brace(axes: Axes, left: float, share: float, text: str) -> None:
    """A line over the bar, with the chain's share."""
    axes.plot([100.0 * left + 0.4, 100.0 * (left + share) - 0.4], [0.5, 0.5], color="#6b6b6b", lw=1.2)
    axes.text(100.0 * (left + share / 2.0), 0.58, text, ha="center", va="bottom", fontsize=9)


def _participation_caption(found: CombinedStiffness) -> str:
    chains = f"axial chain alone {with_unit(significant(found.axial / 1e6, 4), 'N/µm')}"
    if np.isfinite(found.torsional):
        chains += f", torsional chain alone {with_unit(significant(found.torsional, 4), 'N m/rad')}"
    total = f"{with_unit(significant(found.total / 1e6, 4), 'N/µm')} at the table"
    return (
        f"Motor held; the parts act in series. Together they give {total} ({chains}). "
        "The widest field is the part to strengthen first."
    )


def stiffness_position_figure(drives: Mapping[str, BallScrewDrive], positions: FloatArray) -> ReportFigure:
    """Stiffness and first natural frequency of up to four drives, by name, against the nut's place, (n,) [m].

    Places count from the near bearing; refuses no drive, more than four, or a place outside a screw.
    """
    if not 0 < len(drives) <= len(_LINES):
        raise InputError(f"{len(drives)} drives in one figure", "drives", f"give one to {len(_LINES)}")
    figure = new_figure(3.4)
    stiffness, frequency = figure.subplots(1, 2)
    places = 1e3 * positions
    for (name, drive), (colour, style) in zip(drives.items(), _LINES, strict=False):
        look = {"color": colour, "ls": style, "lw": 1.8}
        stiffness.plot(places, stiffness_along(drive, positions) / 1e6, label=name, **look)
        frequencies = [held_frequency(drive, float(position)) for position in positions]
        alone = [combined_stiffness(drive, float(p)).natural_frequency(drive.table_mass) for p in positions]
        frequency.plot(places, frequencies, label="with the screw's mass and inertia", **look)
        frequency.plot(places, alone, color=colour, ls=style, lw=0.8, alpha=0.5, label="table's mass alone")
    dress(stiffness, "nut from the bearing at the motor [mm]", "stiffness at the table [N/µm]")
    dress(frequency, "nut from the bearing at the motor [mm]", "first natural frequency [Hz]")
    stiffness.set_ylim(bottom=0.0)
    frequency.set_ylim(bottom=0.0)
    if len(drives) > 1:
        legend_above(stiffness, columns=2)
    else:  # with several, the line's style marks the drive, and the caption the rest
        legend_above(frequency, columns=2)
    return ReportFigure(
        "stiffness_position", "Stiffness along the stroke", _position_caption(drives, positions), figure
    )


def _position_caption(drives: Mapping[str, BallScrewDrive], positions: FloatArray) -> str:
    softest = ", ".join(
        f"{name} {fixed(float(stiffness_along(drive, positions).min()) / 1e6, 0)}" for name, drive in drives.items()
    )
    return (
        f"Motor held. Softest along the stroke, in N/µm: {softest}. Right: with the screw's own mass and inertia, "
        "thin: with the table's mass alone. Lines that coincide lie over each other."
    )


SHOWN = 3
"""Modes that are drawn."""

_POINTS = 61


def modes_figure(plant: Plant) -> ReportFigure:
    """The first natural frequencies, motor held and free, and the static stiffness, over the stroke.

    Raises:
        InputError: no stroke is declared.
    """
    stroke = plant.stroke
    found = mode_map(plant, None if stroke is None else np.linspace(*stroke, _POINTS), SHOWN)
    figure = new_figure(5.2)
    frequency, stiffness = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1.2))
    brake = plant.drive is not None and plant.drive.motor.brake is not None
    _draw_frequencies(frequency, found, "motor held by its brake" if brake else "motor held: its anti-resonances")
    stiffness.plot(1e3 * found.positions, 1e-6 * found.stiffness, color="#333333")
    low, high = float(np.min(found.stiffness)), float(np.max(found.stiffness))
    stiffness.set_ylim(0, 1.15e-6 * high)
    dress(stiffness, "table position [mm]", "stiffness [N/µm]", "static stiffness at the table, motor held")
    return ReportFigure("modes", "Natural frequencies along the stroke", _caption(found, low, high), figure)


def _draw_frequencies(axes: Axes, found: ModeMap, held: str) -> None:
    places = 1e3 * found.positions
    for frequencies, colour, style, label in (
        (found.free, BEFORE, "-", "motor free: resonances"),
        (found.held, AFTER, "--", held),
    ):
        for number in range(min(SHOWN, frequencies.shape[1])):
            axes.plot(places, frequencies[:, number], color=colour, linestyle=style, label="" if number else label)
    axes.set_ylim(0, None)
    dress(axes, "", "natural frequency [Hz]")
    legend_above(axes, 2)


def _caption(found: ModeMap, low: float, high: float) -> str:
    first = found.held[:, 0]
    place = 1e3 * found.positions[int(np.argmin(first))]
    return (
        f"The first frequency with the motor held goes from {first.min():.4g} to {first.max():.4g} Hz and is lowest "
        f"with the table at {place:.4g} mm; the stiffness at the table goes from {1e-6 * low:.4g} to "
        f"{1e-6 * high:.4g} N/µm."
    )
