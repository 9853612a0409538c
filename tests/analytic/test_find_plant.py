"""A plant is found by its name, its file, or the folder of a diagnosis."""

from pathlib import Path

import pytest

from feeddrive.files import find_plant


def test_a_shipped_name_wins_over_a_folder_of_that_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A diagnosis written with `--out emps` does not take the place of the machine that it was made of."""
    shipped = find_plant("emps")
    folder = tmp_path / "emps"
    folder.mkdir()
    (folder / "plant_after.toml").write_text(shipped.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert find_plant("emps") == shipped
    assert find_plant("./emps") == Path("emps/plant_after.toml")


def test_the_folder_of_a_diagnosis_is_its_corrected_plant(tmp_path: Path) -> None:
    """A path to the folder of a diagnosis means the corrected plant in it."""
    (tmp_path / "plant_after.toml").write_text("", encoding="utf-8")
    assert find_plant(str(tmp_path)) == tmp_path / "plant_after.toml"
