"""Files: where the shipped plants and scenarios are, and writing that leaves no half-written file."""

from __future__ import annotations

import os
import secrets
from difflib import get_close_matches
from pathlib import Path

from feeddrive.errors import InputError

_PACKAGE = Path(__file__).resolve().parent
_SUFFIX = ".toml"
_MAPPING = "_map.toml"
DIAGNOSED = "plant_after.toml"
"""The plant as diagnosed, in the folder that a diagnosis writes."""


def plants_folder() -> Path:
    """Folder of the shipped plants, installed inside the package or beside it in a checkout.

    Raises:
        InputError: the installation holds no plants.
    """
    return _library_folder("plants")


def scenarios_folder() -> Path:
    """Folder of the shipped scenarios, installed inside the package or beside it in a checkout.

    Raises:
        InputError: the installation holds no scenarios.
    """
    return _library_folder("scenarios")


def shipped_plants() -> list[Path]:
    """Plant files that come with feeddrive, in the order of their names; mappings (`*_map.toml`) lie beside them.

    Raises:
        InputError: the installation holds no plants.
    """
    found = sorted(plants_folder().glob(f"*{_SUFFIX}"))
    return [path for path in found if not path.name.endswith(_MAPPING)]


def shipped_scenarios() -> list[Path]:
    """Scenario files that come with feeddrive, in the order of their names.

    Raises:
        InputError: the installation holds no scenarios.
    """
    return sorted(scenarios_folder().glob(f"*{_SUFFIX}"))


def find_plant(name_or_path: str) -> Path:
    """Find a plant file.

    Args:
        name_or_path: path of a file, or of the folder of a diagnosis, whose `plant_after.toml` is meant, or the name
            of a shipped plant with or without `.toml`. A file wins over a name, and a name over a folder: `emps` is the
            shipped plant and `./emps` the folder of a diagnosis.

    Raises:
        InputError: neither a file nor a shipped plant; names the nearest shipped plants.
    """
    path = Path(name_or_path)
    # Not Path.is_file: it raises where a name is too long for the file system.
    if os.path.isfile(path):
        return path
    by_name = {plant.stem: plant for plant in shipped_plants()}
    name = name_or_path.removesuffix(_SUFFIX)
    if name in by_name:
        return by_name[name]
    if os.path.isfile(path / DIAGNOSED):
        return path / DIAGNOSED
    what = "is a folder, not a plant file" if os.path.isdir(path) else "neither a file nor the name of a shipped plant"
    raise InputError(what, where=name_or_path, mend=_nearest(path.stem, list(by_name)))


def find_scenario(name: str) -> Path:
    """Find a scenario file by its path, or a shipped one by its name with or without `.toml`; a file wins over a name.

    The InputError names the nearest.
    """
    return _find_toml(name, shipped_scenarios(), "a scenario file", "a shipped scenario")


def find_scenario_or_controller(name: str) -> Path:
    """Find a scenario or controller file by its path, or a shipped scenario by its name.

    Raises:
        InputError: neither; names the nearest shipped scenario.
    """
    return _find_toml(name, shipped_scenarios(), "a scenario or controller file", "a shipped scenario")


def _find_toml(name: str, shipped: list[Path], kind: str, shipped_kind: str) -> Path:
    path = Path(name)
    # Not Path.is_file: it raises where a name is too long for the file system.
    if os.path.isfile(path):
        return path
    by_name = {one.stem: one for one in shipped}
    stem = name.removesuffix(_SUFFIX)
    if stem in by_name:
        return by_name[stem]
    what = f"is a folder, not {kind}" if os.path.isdir(path) else f"neither a file nor the name of {shipped_kind}"
    near = get_close_matches(path.stem, by_name, n=1, cutoff=0.5)
    raise InputError(what, where=name, mend=f'did you mean "{near[0]}"?' if near else f"known are {', '.join(by_name)}")


def find_scenario_file(relative: str) -> Path:
    """Find a file that comes with the shipped scenarios, such as `demo/measured.csv.gz`."""
    folder = scenarios_folder()
    path = folder / relative
    if os.path.isfile(path) and path.resolve().is_relative_to(folder):
        return path
    raise InputError("no such file among the shipped scenarios", where=relative, mend=f"look in {folder}")


def write_text_atomically(path: Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all; see `write_bytes_atomically`.

    Raises:
        InputError: the file cannot be written there.
    """
    # A file name that is no UTF-8 comes as halves of letters, which UTF-8 cannot hold.
    write_bytes_atomically(path, text.encode("utf-8", "backslashreplace"))


def write_bytes_atomically(path: Path, data: bytes) -> None:
    """Write a file whole or not at all: a reader sees the old content or the new, also after a crash or Ctrl-C.

    Missing folders are made. A failure leaves the old file as it was and nothing beside it.

    Raises:
        InputError: the file cannot be written there.
    """
    # In the same folder, since a file can be renamed only within one file system.
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _write_and_rename(temporary, path, data)
    except OSError as error:
        mend = "name another place for the output"
        raise InputError(f"cannot be written ({error.strerror})", where=str(path), mend=mend) from error


def _write_and_rename(temporary: Path, path: Path, data: bytes) -> None:
    try:
        temporary.write_bytes(data)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _library_folder(name: str) -> Path:
    for folder in (_PACKAGE / "library" / name, _PACKAGE.parent / name):
        if folder.is_dir():
            return folder
    raise InputError(f"this installation of feeddrive holds no {name}", mend="install it again")


def _nearest(name: str, known: list[str]) -> str:
    near = get_close_matches(name, known, n=3, cutoff=0.5)
    if near:
        return f"the nearest shipped plants: {', '.join(near)}"
    return "`feeddrive list` names the shipped plants"
