"""The digest of everything that can change a result of the fleet."""

from __future__ import annotations

from pathlib import Path

from tests.state import ROOT, digest_of

FOLDERS = ("feeddrive", "plants", "tests/generator", "tests/recovery/fleet")
FILES = ("tests/recovery/corruptions.py", "tests/state.py")
SUFFIXES = (".py", ".c", ".h", ".toml", ".json", ".csv")
LIBRARIES = ("numpy", "scipy", "casadi", "numba")


def fleet_state() -> str:
    """Return twelve letters; records of another state are not taken."""
    return digest_of(state_files(), LIBRARIES, ROOT)


def state_files() -> list[Path]:
    """Return the files, in order: the whole package, plants, generator and fleet."""
    inside = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in SUFFIXES]
    return sorted({*inside, *(ROOT / name for name in FILES)})
