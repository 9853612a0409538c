"""The house as it stands: one floor for each folder of `feeddrive/`, in the order of imports, and who imports whom.

Read from the code: files, lines, the sentence of a folder, and its imports. The order is that of CONTRIBUTING.md.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from dataclasses import dataclass
from html import escape
from pathlib import Path
from textwrap import wrap

ROW, LEFT, TEXT, SIZES, GRID = 30, 16, 128, 560, 700
LETTERS = 72
"""Letters of a line of a floor's words that fit beside its size; there is room for two lines."""


@dataclass(frozen=True)
class Floor:
    """A folder of the package, or a module beside them.

    Attributes:
        name: of the folder.
        words: what happens there, the first line of its `__init__.py`.
        files: how many.
        lines: of all its files.
        imports: folder to the number of import statements of it.
    """

    name: str
    words: str
    files: int
    lines: int
    imports: Counter[str]


def order_of(contributing: Path) -> list[str]:
    """The folders in the order of imports, as CONTRIBUTING.md gives it."""
    chain = re.search(r"^    (\w+ →[^\n]*(?:\n    [^\n]*)*)", contributing.read_text(encoding="utf-8"), re.MULTILINE)
    if chain is None:
        raise ValueError(f"{contributing}: no chain of imports")
    return re.findall(r"\w+", chain[1])


def floors_of(package: Path, order: list[str]) -> list[Floor]:
    """The floors, the lowest first."""
    return [_floor(package, name, order) for name in order]


def _floor(package: Path, name: str, order: list[str]) -> Floor:
    folder = package / name
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [folder.with_suffix(".py")]
    imports: Counter[str] = Counter()
    lines = 0
    for path in files:
        text = path.read_text(encoding="utf-8")
        lines += text.count("\n")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("feeddrive."):
                target = str(node.module).split(".")[1]
                if target in order and target != name:
                    imports[target] += 1
    return Floor(name, _first_line(folder), len(files), lines, imports)


def _first_line(folder: Path) -> str:
    """What a folder says of itself."""
    text = (folder / "__init__.py").read_text(encoding="utf-8") if folder.is_dir() else ""
    return (ast.get_docstring(ast.parse(text)) or "").partition("\n")[0].rstrip(".").replace("`", "")


def house(root: Path) -> str:
    """The drawing, as SVG."""
    floors = floors_of(root / "feeddrive", order_of(root / "CONTRIBUTING.md"))
    count = len(floors)
    width, height = GRID + count * 19 + 20, 128 + count * ROW
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="DejaVu Sans,sans-serif">',
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        f'<path d="M8 92 L{(SIZES + 110) / 2} 22 L{SIZES + 112} 92 Z" fill="#1f5f8b"/>',
        _text((SIZES + 120) / 2, 76, "feeddrive", 'font-size="17" fill="#fff" text-anchor="middle"'),
        _text(GRID, 20, "imports of a floor (row)"),
        _text(GRID, 34, "from the floors below it"),
    ]
    for number, floor in enumerate(reversed(floors)):
        parts += _drawn(floor, number, floors)
    top = 96 + count * ROW
    parts.append(f'<rect x="8" y="{top}" width="{SIZES + 104}" height="8" fill="#39424a"/>')
    parts.append(_text(LEFT, top + 24, "A floor imports from the floors below it only."))
    return "\n".join([*parts, "</svg>\n"])


def _text(x: float, y: float, words: str, style: str = 'font-size="11" fill="#445"') -> str:
    return f'<text x="{x}" y="{y}" {style}>{escape(words)}</text>'


def _words(words: str, middle: int) -> list[str]:
    lines = wrap(words, LETTERS, max_lines=2, placeholder=" …")
    top = middle - 6 * (len(lines) - 1)
    return [_text(TEXT, top + 12 * number, line, 'font-size="10.5" fill="#223"') for number, line in enumerate(lines)]


def _drawn(floor: Floor, number: int, floors: list[Floor]) -> list[str]:
    y = 94 + number * ROW
    middle = y + 19
    shade = "#e9f0f5" if number % 2 else "#f6f9fb"
    size = f"{floor.files} file{'s' if floor.files > 1 else ''}, {floor.lines} lines"
    parts = [
        f'<rect x="8" y="{y}" width="{SIZES + 104}" height="{ROW - 2}" fill="{shade}" stroke="#9db4c2"/>',
        _text(LEFT, middle, floor.name, 'font-size="13" font-weight="bold" fill="#123"'),
        *_words(floor.words, middle),
        _text(SIZES + 104, middle, size, 'font-size="10" text-anchor="end" fill="#556"'),
    ]
    for column, below in enumerate(floors):
        x = GRID + 8 + column * 19
        if number == 0:
            turned = f'font-size="10" fill="#445" transform="rotate(-55 {x + 4} 88)"'
            parts.append(_text(x + 4, 88, below.name, turned))
        if below.name == floor.name:
            parts.append(f'<rect x="{x - 5}" y="{y + 9}" width="10" height="10" fill="#c9d6de"/>')
        elif floor.imports[below.name]:
            radius = min(8.0, 2.0 + 0.7 * floor.imports[below.name] ** 0.5)
            parts.append(
                f'<circle cx="{x}" cy="{y + 14}" r="{radius:.1f}" fill="#1f5f8b">'
                f"<title>{floor.name} imports {below.name} {floor.imports[below.name]} times</title></circle>"
            )
    return parts
