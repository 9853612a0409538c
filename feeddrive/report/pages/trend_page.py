"""The page of a watched axis: trend.html, with trend.json, trend.csv and the figures beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.report.figures.drawing import RenderedFigure, render
from feeddrive.report.figures.figure_trend import trend_figures
from feeddrive.report.pages.html import page
from feeddrive.report.pages.markup import bullets, figure, paragraph, section, table, verdict
from feeddrive.report.words.trend_words import date_words, event_sentence, odds_words, quantity_rows, verdict_lines
from feeddrive.trend.checkpoint import USED
from feeddrive.trend.watch import Trend

_MOST_FILES = 200


def write_trend(trend: Trend, searched: Mapping[int, str], title: str, record: Mapping[str, Any], folder: Path) -> None:
    """Write the page, the JSON, the table and the figures into a folder.

    Raises:
        InputError: the folder cannot be written.
    """
    pictures = [render(one) for one in trend_figures(trend)]
    for picture in pictures:
        write_bytes_atomically(folder / f"{picture.stem}.png", picture.png)
    write_text_atomically(folder / "trend.csv", trend_table(trend))
    write_text_atomically(folder / "trend.json", json.dumps(record, indent=2, ensure_ascii=False) + "\n")
    write_text_atomically(folder / "trend.html", trend_page(trend, searched, title, pictures))


def trend_table(trend: Trend) -> str:
    """The values of every recording as CSV, SI; an empty cell where one does not show a quantity."""
    heads = ["date", "day [d]", "file", *(f"{one.name} [{one.unit}]" for one in trend.quantities)]
    rows = [",".join(heads)]
    for i, (day, entry) in enumerate(zip(trend.days, trend.used, strict=True)):
        cells = [f"{one.values[i]:.9g}" if np.isfinite(one.values[i]) else "" for one in trend.quantities]
        name = '"' + entry.key.replace('"', '""') + '"'
        rows.append(",".join([trend.when(float(day)).isoformat(), f"{day:.9g}", name, *cells]))
    return "\n".join(rows) + "\n"


def trend_page(trend: Trend, searched: Mapping[int, str], title: str, pictures: list[RenderedFigure]) -> str:
    """The page as text."""
    parts = (
        verdict(verdict_lines(trend, searched), calm=not trend.events),
        section("Over the recordings", *(figure(one) for one in pictures if one.stem.startswith("trend"))),
        section("Quantities", table(_QUANTITIES, quantity_rows(trend), "dense")),
        section("Changes", _changes(trend, searched)),
        section("Recordings that stand alone", bullets(_odd(trend)) if trend.odd else ""),
        section("The same in all recordings", *(figure(one) for one in pictures if one.stem.startswith("map"))),
        section("Files", paragraph(_counted(trend)), bullets(_unused(trend)), bullets(trend.notes)),
        section("How it was judged", bullets(_METHOD)),
    )
    return page(
        title, "Recordings of one axis against its declared plant, compared at equal positions.", "".join(parts)
    )


_QUANTITIES = ("quantity", "#at first", "#at last", "#one file", "what it did", "limits")

_METHOD = (
    "Odds compare a course (jump, slope, settling) with none, its size, the scatter and any wandering of the machine "
    "integrated out, and count every date, kind and quantity that was tried. A change is reported from 100 : 1: where "
    "nothing changes, at most one watch in a hundred reports one.",
    "Limits from the first recordings are left by chance in one of a hundred steady years of 250 recordings.",
    "The band of a line is that of what was found; ± one file is the scatter of a single recording, 95 %.",
)


def _changes(trend: Trend, searched: Mapping[int, str]) -> str:
    heads = ["what", "date, 95 %", "#odds", "full search"]
    rows = [
        [
            event_sentence(trend, event),
            " to ".join(date_words(trend, day) for day in event.dates),
            odds_words(max(one.found.odds for one in event.changes)),
            searched.get(i, "not asked for"),
        ]
        for i, event in enumerate(trend.events)
    ]
    return table(heads, rows) if rows else paragraph("None.")


def _odd(trend: Trend) -> list[str]:
    return [f"{trend.used[i].key}: {name.replace('_', ' ')}" for name, i in trend.odd]


def _counted(trend: Trend) -> str:
    reading, whole = trend.seconds
    return (
        f"{len(trend.used)} recordings are followed. {trend.fresh} files were read anew, in {reading:.1f} s; all took "
        f"{whole:.1f} s."
    )


def _unused(trend: Trend) -> list[str]:
    others = [one for one in trend.entries if one.status != USED]
    lines = [f"{one.key}: {one.status}: {one.reason}" for one in others[:_MOST_FILES]]
    return [*lines, f"and {len(others) - _MOST_FILES} more"] if len(others) > _MOST_FILES else lines
