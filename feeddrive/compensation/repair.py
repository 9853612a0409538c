"""What a repair makes of a machine: worn parts renewed, everything else as it is."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.plant.plant import Plant

WORN = ("backlash", "preload_loss")
"""Effects that a new preload of the nut takes away; lead errors stay, they are the screw's own."""


def repaired(plant: Plant) -> Plant | None:
    """The plant with the preload renewed; None where none of it is lost."""
    kept = tuple(one for one in plant.effects if one.name not in WORN)
    return None if len(kept) == len(plant.effects) else replace(plant, effects=kept)
