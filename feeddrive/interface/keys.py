"""The reference of keys: what may stand in each section of every file, as its reader declares it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from feeddrive.errors import InputError
from feeddrive.interface.shown import Listing, Shown
from feeddrive.plant.file.plant_schema import PLANT
from feeddrive.schema.controller import CONTROLLER
from feeddrive.schema.key import Key
from feeddrive.schema.mapping import MAPPING
from feeddrive.schema.measured import MEASURED
from feeddrive.schema.section import Section
from feeddrive.schema.toml_text import nearest_choice
from feeddrive.simulate.scenario.scenario_file import SCENARIO

ROOTS = {one.path: one for one in (PLANT, CONTROLLER, SCENARIO, MAPPING, MEASURED)}
"""The kinds of files by their name."""


@dataclass(frozen=True, repr=False, eq=False)
class Keys(Shown):
    """Keys of one section, and the sections inside it.

    Attributes:
        path: of the section, "plant.ball_screw"; "" for all files.
        meaning: of the section, in a few words.
        keys: each with name, meaning, unit, range, default, whether it is required and when it counts.
        sections: path to meaning of what is inside, and of the kinds among which a word chooses.
    """

    path: str
    meaning: str
    keys: Sequence[Key]
    sections: dict[str, str]

    def listing(self) -> Listing:
        """One row per key, then one per section inside."""
        records = [
            {
                "key": key.name,
                "unit": key.unit,
                "kind": str(key.kind),
                "range": key.range,
                "usual": key.usual_range,
                "required": key.required,
                "default": key.default,
                "meaning": key.meaning,
                "when": key.when,
            }
            for key in self.keys
        ]
        rows = [
            [key.name, key.unit or str(key.kind), key.range, key.usual_range, key.needed, _sentence(key)]
            for key in self.keys
        ]
        records += [{"section": path, "meaning": text} for path, text in self.sections.items()]
        rows += [[path, "section", "", "", "", text] for path, text in self.sections.items()]
        title = f"{self.path}: {self.meaning}" if self.path else self.meaning
        caption = "" if self.keys else f"feeddrive keys {next(iter(self.sections), 'plant')} shows what is in one"
        return Listing(title, ("key", "unit", "range", "usual", "needed", "meaning"), rows, records, caption)


def keys(path: str = "") -> Keys:
    """What may stand in a section of a file: meaning, unit, range, default, required or not.

    Args:
        path: "plant", "plant.ball_screw", "plant.effect.backlash", "controller.filter.notch", ...; all files if left
            out. A key at its end shows that key alone: "plant.table.mass".

    Raises:
        InputError: no such file, section or key; names the nearest.

    >>> import feeddrive as fd
    >>> [key.unit for key in fd.keys("plant.ball_screw").keys if key.name == "lead"]
    ['m']
    >>> fd.keys("plant.table.mass").keys[0].meaning
    'mass that moves with the table'
    """
    if not path:
        return Keys("", "files and their keys", (), {name: root.meaning for name, root in ROOTS.items()})
    first, *steps = path.split(".")
    if first not in ROOTS:
        raise InputError(f'no file "{first}"', "keys", nearest_choice(first, ROOTS))
    section = ROOTS[first]
    for place, step in enumerate(steps):
        inner = section.sections.get(step) or section.kinds.get(step)
        if inner is not None:
            section = section.of_kind(step) if step in section.kinds else inner
            continue
        if step in section.keys and place == len(steps) - 1:
            return Keys(path, section.meaning, (section.keys[step],), {})
        known = (*section.keys, *section.sections, *section.kinds)
        raise InputError(f'no key or section "{step}"', ".".join([first, *steps[:place]]), nearest_choice(step, known))
    below = {**section.sections, **section.kinds}
    return Keys(
        section.path,
        section.meaning,
        tuple(section.keys.values()),
        {f"{path}.{name}": one.meaning for name, one in below.items()},
    )


def every_section() -> tuple[Section, ...]:
    """Every section of every file, for tests and the documentation."""
    return tuple(section for root in ROOTS.values() for section in root.walk())


def _sentence(key: Key) -> str:
    return f"{key.meaning} ({key.when})" if key.when else key.meaning
