"""Pieces of HTML: every text passes `text`, so nothing from a file can become markup."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from feeddrive.report.figures.drawing import RenderedFigure
from feeddrive.report.words.words import effect_words

_KEPT = "\n\N{NO-BREAK SPACE}"


@dataclass(frozen=True)
class Cell:
    """A table cell of HTML that is already escaped; plain text needs none."""

    inner: str


def text(words: str) -> str:
    """Words as HTML; control characters, which no page may hold, become spaces."""
    clean = "".join(letter if letter.isprintable() or letter in _KEPT else " " for letter in words)
    return html.escape(clean.encode("utf-8", "replace").decode("utf-8"), quote=True)


def effect_name(name: str, bold: bool = False) -> Cell:
    """What an effect is called, and below it its name in files where that is another."""
    words = text(effect_words(name))
    below = f"<br>{catalogue_name(name)}" if effect_words(name) != name else ""
    return Cell(f"{f'<b>{words}</b>' if bold else words}{below}")


def catalogue_name(name: str) -> str:
    """A name as it stands in files."""
    return f"<code>{text(name)}</code>"


def paragraph(content: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    return f"<p{_class(kind)}>{text(content)}</p>"


def verdict(sentences: Sequence[str], calm: bool, note: str = "") -> str:
    """A box with the main finding in bold and the other sentences below it; calm where nothing was found."""
    first, *others = (paragraph(one, "" if i else "main") for i, one in enumerate(sentences))
    return f'<div class="verdict{" clean" if calm else ""}">{first}{"".join(others)}{note}</div>'


def bullets(lines: Iterable[str]) -> str:
    """A list of plain texts."""
    return f"<ul>{''.join(f'<li>{text(line)}</li>' for line in lines)}</ul>"


def table(heads: Sequence[str], rows: Iterable[Sequence[str | Cell]], kind: str = "") -> str:
    """A table with one line of heads; a column whose head begins with "#" holds numbers and stands flush right."""
    columns = [(_class("number" if head.startswith("#") else ""), text(head.removeprefix("#"))) for head in heads]
    head = "".join(f"<th{side}>{label}</th>" for side, label in columns)
    cells = ("".join(map(_data_cell, row, columns)) for row in rows)
    body = "".join(f"<tr>{row}</tr>\n" for row in cells)
    return f'<div class="wide"><table{_class(kind)}><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>'


def _data_cell(cell: str | Cell, column: tuple[str, str]) -> str:
    """A cell under its column; its label stands beside it where a narrow page sets a row as a list."""
    side, label = column
    named = f' data-label="{label}"' if label else ""
    inner = cell.inner if isinstance(cell, Cell) else text(cell)
    # one box beside the label, whatever breaks and code the cell holds
    return f"<td{side}{named}>{inner and f'<div>{inner}</div>'}</td>"


def section(title: str, *parts: str) -> str:
    """A section with its heading; nothing at all where no part has content."""
    body = "\n".join(part for part in parts if part)
    return f"<section>\n<h2>{text(title)}</h2>\n{body}\n</section>\n" if body else ""


def figure(rendered: RenderedFigure) -> str:
    """A figure with the picture inside the page."""
    data = base64.b64encode(rendered.png).decode("ascii")
    title, caption = text(rendered.title), text(rendered.caption)
    picture = f'<img alt="{title}" src="data:image/png;base64,{data}">'
    return f"<figure>\n{picture}\n<figcaption><b>{title}.</b> {caption}</figcaption>\n</figure>\n"


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""
