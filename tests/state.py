"""Digest of files and libraries: what a kept result was made by, so that it is never shown for another state."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def digest_of(paths: Iterable[Path], libraries: Iterable[str], root: Path = ROOT) -> str:
    """Twelve letters of the names and contents of files below `root`, and of the versions of Python and libraries."""
    digest = hashlib.sha256(f"Python {sys.version_info.major}.{sys.version_info.minor}\n".encode())
    for library in libraries:
        digest.update(f"{library} {version_of(library)}\n".encode())
    for path in sorted(paths):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


def version_of(library: str) -> str:
    """Version of an installed library, or that it is not there."""
    try:
        return version(library)
    except PackageNotFoundError:
        return "is not there"
