"""Pieces of HTML: every text passes `text`, so nothing from a file can become markup."""

from __future__ import annotations

import base64
import html
import re
from collections.abc import Iterable
from dataclasses import dataclass

from feeddrive.report.figures.drawing import RenderedFigure

_TAG = re.compile(r"<[^>]*>")
_KEPT = "\n\N{NO-BREAK SPACE}"


@dataclass(frozen=True)
class Cell:
    """One table cell: inner HTML that is already escaped, and whether it is a number (set flush right)."""

    inner: str
    number: bool = False


def text(words: str) -> str:
    """Words as HTML; control characters, which no page may hold, become spaces."""
    clean = "".join(letter if letter.isprintable() or letter in _KEPT else " " for letter in words)
    return html.escape(clean.encode("utf-8", "replace").decode("utf-8"), quote=True)


def words(content: str) -> Cell:
    """A cell of plain text."""
    return Cell(text(content))


def number(content: str) -> Cell:
    """A cell that holds a number and perhaps its unit."""
    return Cell(text(content), number=True)


def catalogue_name(name: str) -> str:
    """A name as it stands in files."""
    return f"<code>{text(name)}</code>"


def paragraph(content: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    return f"<p{_class(kind)}>{text(content)}</p>"


def bullets(lines: Iterable[str]) -> str:
    """A list of plain texts."""
    return f"<ul>{''.join(f'<li>{text(line)}</li>' for line in lines)}</ul>"


def table(heads: list[Cell], rows: Iterable[list[Cell]], kind: str = "") -> str:
    """A table with one line of heads; numbers and their heads stand flush right."""
    head = "".join(f"<th{_class('number' if cell.number else '')}>{cell.inner}</th>" for cell in heads)
    labels = [_TAG.sub(" ", cell.inner).strip() for cell in heads]  # beside each cell where a row is set as a list
    cells = ("".join(_data_cell(cell, label) for cell, label in zip(row, labels, strict=False)) for row in rows)
    body = "".join(f"<tr>{row}</tr>\n" for row in cells)
    return f'<div class="wide"><table{_class(kind)}><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>'


def _data_cell(cell: Cell, label: str) -> str:
    named = f' data-label="{label}"' if label else ""
    return f"<td{_class('number' if cell.number else '')}{named}>{cell.inner}</td>"


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
