"""Values that nobody means, in every place of every shipped plant file: refused in one line, whoever reads the file."""

from __future__ import annotations

import copy
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from feeddrive.cli.main import main
from feeddrive.errors import InputError
from feeddrive.files import plants_folder, shipped_plants
from feeddrive.plant.file.plant_file import plant_from_entries

_QUANTITY = re.compile(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?(?P<unit>\s*[A-Za-z°µ%].*)")
_WORDS = ("source", "tolerance", "format", "name", "structure", "description", "kind", "carriage")
WARM = (plants_folder() / "warm_axis.toml").read_text(encoding="utf-8")


def _quantities(entries: Any, way: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Every dimensional value of a file: the way to it, and its unit."""
    if isinstance(entries, dict):
        for key, inner in entries.items():
            if key not in _WORDS:
                yield from _quantities(inner, (*way, key))
    elif isinstance(entries, list):
        for i, inner in enumerate(entries):
            yield from _quantities(inner, (*way, i))
    elif isinstance(entries, str) and (match := _QUANTITY.fullmatch(entries)):
        yield way, match["unit"]


def _read(entries: dict[str, Any], path: Path) -> None:
    plant_from_entries(entries, path)


@pytest.mark.parametrize("number", ["1e150", "-1e150"])
@pytest.mark.parametrize("path", shipped_plants(), ids=lambda path: path.stem)
def test_no_place_of_a_plant_takes_it(path: Path, number: str) -> None:
    entries = tomllib.loads(path.read_text(encoding="utf-8"))
    places = list(_quantities(entries))
    assert len(places) > 8  # the walk finds the file's values
    for way, unit in places:
        changed = copy.deepcopy(entries)
        inside: Any = changed
        for key in way[:-1]:
            inside = inside[key]
        inside[way[-1]] = number + unit
        with pytest.raises(InputError) as refused:
            _read(changed, path)
        assert str(path) in str(refused.value), way


@pytest.mark.parametrize("command", ["show", "check", "modes"])
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("contact_conductance = ", "contact_conductanc = ", ["contact_conductanc", "did you mean"]),
        ('nut_length = "', 'nut_length = "-', ["nut.length", "not possible"]),
        ('spacer = "oversize"', 'spacer = "overside"', ["thermal, coupling.spacer", '"oversize"']),
        ('nut_at_zero = "250 mm"', 'nut_at_zero = "1e150 mm"', ["nut_at_zero", "above what is usual"]),
        ('static_rating = "', 'static_rating = "-', ["static_rating", "not possible"]),
        ('\nmass = "250 kg"', '\nmass = "2.5e14 kg"', ["table.mass", "above what is usual"]),
    ],
)
def test_every_command_reads_the_whole_file(
    command: str, old: str, new: str, told: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in WARM
    path = tmp_path / "warm.toml"
    path.write_text(WARM.replace(old, new), encoding="utf-8")
    assert main([command, str(path)]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    line = shown.err.replace("\n", " ")
    assert not [part for part in told if part not in line], line


def test_temperature_below_the_absolute_zero(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = re.sub(r'ambient = "[^"]*"', 'ambient = "-275 degC"', WARM)
    path = tmp_path / "warm.toml"
    path.write_text(text, encoding="utf-8")
    assert main(["thermal", str(path)]) == 2
    assert "thermal.ambient: -275 °C is below the absolute zero" in capsys.readouterr().err.replace("\n", " ")
