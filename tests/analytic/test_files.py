"""Finding shipped files, and writing that leaves the old file or the new one."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from feeddrive import files
from feeddrive.errors import InputError


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout with two plants and one scenario with its data; the working folder is elsewhere and empty."""
    package = tmp_path / "checkout" / "feeddrive"
    for name in ("plants/bench_axis.toml", "plants/light_axis.toml", "plants/bench_map.toml", "plants/notes.txt"):
        _touch(package.parent / name)
    for name in ("scenarios/warm_up.toml", "scenarios/bode.py", "scenarios/demo/measured.csv.gz"):
        _touch(package.parent / name)
    package.mkdir()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    monkeypatch.setattr(files, "_PACKAGE", package)
    return package.parent


def _touch(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("", encoding="utf-8")


def test_checkout_lists_plants_and_scenarios_only(library: Path) -> None:
    assert [plant.name for plant in files.shipped_plants()] == ["bench_axis.toml", "light_axis.toml"]
    assert [scenario.name for scenario in files.shipped_scenarios()] == ["warm_up.toml"]


def test_installed_library_wins_over_a_neighbour_of_the_package(library: Path) -> None:
    """In site-packages a foreign folder `plants` may lie beside the package."""
    _touch(library / "feeddrive" / "library" / "plants" / "installed.toml")
    assert [plant.stem for plant in files.shipped_plants()] == ["installed"]


@pytest.mark.parametrize("name", ["light_axis", "light_axis.toml"])
def test_plant_by_name(library: Path, name: str) -> None:
    assert files.find_plant(name) == library / "plants" / "light_axis.toml"


def test_plant_by_path_wins_over_the_shipped_name(library: Path) -> None:
    own = Path("light_axis.toml")
    _touch(own)
    assert files.find_plant("light_axis.toml") == own
    assert files.find_plant(str(own.resolve())) == own.resolve()


def test_folder_of_the_plants_name_does_not_hide_the_plant(library: Path) -> None:
    Path("light_axis").mkdir()
    assert files.find_plant("light_axis") == library / "plants" / "light_axis.toml"


@pytest.mark.parametrize("name", ["ligth_axis", "ligth_axis.toml", "somewhere/ligth_axis.toml"])
def test_misspelt_plant_names_the_nearest(library: Path, name: str) -> None:
    with pytest.raises(InputError) as refusal:
        files.find_plant(name)
    assert refusal.value.where == name
    assert refusal.value.mend.startswith("the nearest shipped plants: light_axis")


@pytest.mark.parametrize("name", ["", ".", "..", "/", "zzz", "a\x00b", "x" * 5000, "two\nlines"])
def test_unusable_plant_name_is_refused_in_one_line(library: Path, name: str) -> None:
    with pytest.raises(InputError) as refusal:
        files.find_plant(name)
    assert "\n" not in str(refusal.value)


def test_folder_is_refused_as_a_folder(library: Path) -> None:
    Path("machines").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        files.find_plant("machines")


def test_scenario_file(library: Path) -> None:
    expected = library / "scenarios" / "demo" / "measured.csv.gz"
    assert files.find_scenario_file("demo/measured.csv.gz") == expected


@pytest.mark.parametrize("relative", ["demo", "demo/absent.csv", "../plants/light_axis.toml", "x" * 5000, os.devnull])
def test_scenario_file_absent_or_outside_is_refused(library: Path, relative: str) -> None:
    with pytest.raises(InputError, match="no such file among the shipped scenarios"):
        files.find_scenario_file(relative)


def test_installation_without_library_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "_PACKAGE", tmp_path / "feeddrive")
    with pytest.raises(InputError, match="holds no plants"):
        files.shipped_plants()


def test_write_replaces_and_makes_folders(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "report.txt"
    files.write_text_atomically(path, "old")
    files.write_text_atomically(path, "k = 245 N/µm\nlast line\n")
    assert path.read_bytes() == "k = 245 N/µm\nlast line\n".encode()
    assert [entry.name for entry in path.parent.iterdir()] == ["report.txt"]


@pytest.mark.skipif(os.name != "posix", reason="permission bits are POSIX")
def test_written_file_has_the_permissions_of_any_new_file(tmp_path: Path) -> None:
    """A temporary file is often private to its owner; a report must not be."""
    files.write_bytes_atomically(tmp_path / "written", b"x")
    (tmp_path / "ordinary").write_bytes(b"x")
    modes = {stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("written", "ordinary")}
    assert len(modes) == 1


@pytest.mark.parametrize("failure", [KeyboardInterrupt(), OSError(28, "No space left on device")])
def test_failure_keeps_the_old_file_and_leaves_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException
) -> None:
    path = tmp_path / "report.txt"
    path.write_text("old", encoding="utf-8")

    def fail(source: Path, target: Path) -> None:
        raise failure

    monkeypatch.setattr(os, "replace", fail)
    expected = InputError if isinstance(failure, OSError) else KeyboardInterrupt
    with pytest.raises(expected):
        files.write_text_atomically(path, "new")
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_impossible_place_is_refused_with_its_name(tmp_path: Path) -> None:
    occupied = tmp_path / "file"
    occupied.write_text("", encoding="utf-8")
    for path in (occupied / "below.txt", tmp_path):
        with pytest.raises(InputError, match="cannot be written") as refusal:
            files.write_text_atomically(path, "x")
        assert str(refusal.value).startswith(f"{path}: ")
