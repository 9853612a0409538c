"""`feeddrive show PLANT --out FOLDER`: everything as JSON, and what stiffness is made of and does, as figures."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from feeddrive.files import write_bytes_atomically, write_text_atomically
from feeddrive.plant.plant import Plant


def is_folder(out: Path | None) -> bool:
    """Whether an --out means a folder: one that is there, or a name without an ending such as .json or .txt."""
    return out is not None and (out.is_dir() or not out.suffix)


def write_folder(plant: Plant, position: float, content: dict[str, Any], folder: Path) -> None:
    """Write show.json, and stiffness_shares.png and stiffness_position.png of a machine that is described by parts.

    Args:
        plant: the machine.
        position: of the table, for the shares [m].
        content: of show.json.
        folder: made where it is not there.

    Raises:
        InputError: the folder cannot be written, or a position off the screw.
    """
    write_text_atomically(folder / "show.json", json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    if plant.drive is None or not plant.chain.varies:
        return
    # Matplotlib takes time to import.
    from feeddrive.report.figures.drawing import render
    from feeddrive.report.figures.figure_stiffness import stiffness_figures

    for figure in stiffness_figures(plant, position):
        write_bytes_atomically(folder / f"{figure.stem}.png", render(figure).png)
