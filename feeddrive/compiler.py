"""C code compiled into a shared library and kept: where a compiler is found, slow loops run in it.

The cache is written atomically, so that processes that start together do not meet half a file, and pruned
(`compiled_cache`); where the home is read-only a temporary folder of the same person serves. Nothing is compiled when a
module is imported.
"""

from __future__ import annotations

import contextlib
import ctypes
import getpass
import hashlib
import os
import shutil
import signal
import subprocess
import tempfile
import warnings
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from feeddrive.compiled_cache import prune_once, used
from feeddrive.errors import ValidityWarning

FLAGS = ("-O3", "-ffp-contract=off", "-fPIC", "-shared")
"""No fused or reordered arithmetic: the same numbers on every computer."""

COMPILE_TIME = 300.0
"""Seconds after which a compiler is taken to hang: some thirty times what the largest machine takes on a slow core."""


class CompilerError(Exception):
    """The compiler ended with an error, or hung; the text says which in a line."""


_hung: set[str] = set()
"""Compilers that did not end; they are not waited for again."""


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

    Warns:
        ValidityWarning: the compiler hangs; what follows is slower.
    """
    compiler = find_compiler()
    if compiler is None or compiler in _hung:
        return None
    key = hashlib.sha256("\0".join((source, compiler, *flags, made_for)).encode()).hexdigest()[:24]
    for folder in cache_folders():
        library = folder / f"{key}.so"
        try:
            _make_private(folder)
            return _loaded(source, compiler, flags, library)
        except CompilerError as failure:
            if compiler in _hung:
                mend = "it is done without, which is slower; FEEDDRIVE_COMPILER=none does not wait"
                warnings.warn(f"{compiler}: {failure}; {mend}", ValidityWarning, stacklevel=2)
                return None
        except OSError:
            continue
    return None


def run_compiler(command: Sequence[str], folder: Path) -> None:
    """Run the compiler and wait for it, no longer than `COMPILE_TIME`.

    Args:
        command: the compiler and its arguments.
        folder: in which it runs.

    Raises:
        CompilerError: it ended with an error or did not end.
        OSError: it cannot be started.
    """
    # A session of its own: what the compiler has started itself is ended with it.
    started = subprocess.Popen(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        _, output = started.communicate(timeout=COMPILE_TIME)
    except BaseException as error:
        _end(started)
        if not isinstance(error, subprocess.TimeoutExpired):
            raise
        _hung.add(command[0])
        raise CompilerError(f"the C compiler did not end within {COMPILE_TIME:g} s") from None
    if started.returncode != 0:
        raise CompilerError(next(iter(output.strip().splitlines()), f"status {started.returncode}"))


def _end(started: subprocess.Popen[str]) -> None:
    """End a program, and where sessions are known all that it has started."""
    with contextlib.suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(started.pid, signal.SIGKILL)
    started.kill()
    started.wait()
    if started.stderr is not None:
        started.stderr.close()


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
    named = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    # Without a home, "~" stays as it is; a folder of that name in the working folder is not meant.
    homes = [Path(named) / "feeddrive"] if os.path.isabs(named) else []
    return [*homes, Path(tempfile.gettempdir()) / f"feeddrive-{_person()}"]


def _person() -> str:
    """The person's name, or number where the computer knows no name for it, as in many containers."""
    try:
        return getpass.getuser()
    except (KeyError, OSError, ImportError):
        return str(os.getuid()) if hasattr(os, "getuid") else "somebody"


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
        run_compiler([compiler, *flags, "-o", str(made), str(text), "-lm"], library.parent)
        made.replace(library)
