"""The pages that are written from the package when the site is built: effects, reference, the house."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from effect_pages import write_effect_pages
from house import house
from sphinx.application import Sphinx
from written_pages_text import ROOT, commands_page, files_page, interface_page, scenarios_page

FOLDER = "generated"


def write_pages(app: Sphinx) -> None:
    """Write everything that is made from the package."""
    folder = Path(app.srcdir) / FOLDER
    reference = folder / "reference"
    reference.mkdir(parents=True, exist_ok=True)
    write_effect_pages(folder / "effects", Path(app.srcdir) / "recovery.md")
    for name, text in {
        "commands": commands_page(),
        "interface": interface_page(),
        "files": files_page(),
        "scenarios": scenarios_page(),
    }.items():
        (reference / f"{name}.md").write_text(text, encoding="utf-8")
    (folder / "house.svg").write_text(house(ROOT), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages before they are read."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
