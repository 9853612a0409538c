"""C code compiled into a shared library and kept: where a compiler is found, slow loops run in it.

The cache is written atomically, so that processes that start together do not meet half a file, and pruned
(`library_cache`); where the home is read-only a temporary folder of the same person serves. Nothing is compiled when a
module is imported.
"""

from __future__ import annotations

import ctypes
import getpass
import hashlib
import os
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

from feeddrive.library_cache import prune_once, used

FLAGS = ("-O3", "-ffp-contract=off", "-fPIC", "-shared")
"""No fused or reordered arithmetic: the same numbers on every computer."""


@lru_cache(maxsize=1)
def find_compiler() -> str | None:
    """The C compiler: $CC, cc, gcc or clang; None if there is none or FEEDDRIVE_COMPILER is "none"."""
    if os.environ.get("FEEDDRIVE_COMPILER") == "none":
        return None
    for name in (os.environ.get("CC"), "cc", "gcc", "clang"):
        if name and (found := shutil.which(name)):
            return found
    return None


def compiled_library(source: str, flags: tuple[str, ...] = FLAGS, made_for: str = "") -> ctypes.CDLL | None:
    """The shared library of a C source, from the cache or made now.

    Args:
        source: whole text of the C file.
        flags: of the compiler; `-lm` is added.
        made_for: what the library serves alone, such as a processor; another one gets a library of its own.

    Returns:
        None where there is no compiler, it fails, or no folder can hold what it makes; the caller then has its own way.
    """
    compiler = find_compiler()
    if compiler is None:
        return None
    key = hashlib.sha256("\0".join((source, compiler, *flags, made_for)).encode()).hexdigest()[:24]
    for folder in cache_folders():
        library = folder / f"{key}.so"
        try:
            _make_private(folder)
            return _loaded(source, compiler, flags, library)
        except (OSError, subprocess.CalledProcessError):
            continue
    return None


def _loaded(source: str, compiler: str, flags: tuple[str, ...], library: Path) -> ctypes.CDLL:
    """The library of that path, compiled where it is not there."""
    if used(library):
        try:
            return ctypes.CDLL(str(library))
        except OSError:
            if library.exists():
                raise
            # another process has pruned it since
    _compile(source, compiler, flags, library)
    prune_once(library.parent)
    return ctypes.CDLL(str(library))


def cache_folders() -> list[Path]:
    """Folders that may hold compiled libraries, the preferred one first."""
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return [Path(base) / "feeddrive", Path(tempfile.gettempdir()) / f"feeddrive-{getpass.getuser()}"]


def _make_private(folder: Path) -> None:
    """Make the folder, and refuse one that somebody else could have filled.

    Raises:
        OSError: it cannot be made, or is another's.
    """
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    if hasattr(os, "getuid") and folder.stat().st_uid != os.getuid():
        raise PermissionError(f"{folder} belongs to another user")


def _compile(source: str, compiler: str, flags: tuple[str, ...], library: Path) -> None:
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        text, made = Path(folder) / "source.c", Path(folder) / "made.so"
        text.write_text(source, encoding="utf-8")
        subprocess.run([compiler, *flags, "-o", str(made), str(text), "-lm"], check=True, capture_output=True)
        made.replace(library)
