"""What a plant file says of its own values: which are still guesses, and which differ from the part that it names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from feeddrive.plant.analysis.plausibility import Finding, Sense, Verdict
from feeddrive.plant.file.named_parts import Departure, departures
from feeddrive.plant.plant import Plant

_GUESS = "guess"


def check_declared(entries: Mapping[str, Any], where: str, plant: Plant) -> tuple[Finding, ...]:
    """Values of a file that differ from their part as warnings, values whose source is a guess as notes.

    Takes the entries as written, their file, and the plant that was read from them, whose origins name the sources.
    Raises InputError for a part that the catalogue does not hold.
    """
    known = plant.chain.known_values if plant.has_motion else ()
    written = {one.key: f"{one.section}.{one.section_key}" for one in known}
    guessed = {written.get(key, key): text for key, text in plant.origins.items() if text.startswith(_GUESS)}
    return (
        *(_departed(one) for one in departures(entries, where)),
        *(
            Finding(f"{key} is still a guess", None, None, "1", Sense.EQUAL, Verdict.NOTE, text)
            for key, text in guessed.items()
        ),
    )


def _departed(one: Departure) -> Finding:
    copied = one.part in one.source or one.source.startswith("catalogue")
    source = f"prints {one.part}; the file's source still names it" if copied else f"prints {one.part}"
    rule = f"{one.key} as its part"
    return Finding(rule, one.written, one.catalogue, one.unit, Sense.EQUAL, Verdict.BROKEN, source)
