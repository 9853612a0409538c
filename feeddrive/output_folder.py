"""Folders of results: the files of a command come in together or not at all, and commands take turns.

The new files are written into a hidden folder inside the folder itself. It is renamed once it is whole: from then on
they count. The old files of these names are then taken away and the new ones moved in, which takes a moment; whoever is
killed in it leaves old files alone or new files alone, and the next command finishes the moving.

The folder itself is never renamed: it may be a mount point, a shell may stand in it, and it may hold what is not ours.
"""

from __future__ import annotations

import os
import secrets
import shutil
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from feeddrive.errors import InputError

LONGEST_WAIT = 60.0
"""Seconds that a command waits for another one that writes to the folder; drawing and writing take some."""

_MARK, _BEGUN, _WHOLE, _GONE = ".feeddrive-", ".part", ".whole", ".gone"
_MEND = "name another folder for --out"


def refuse_unusable(folder: Path | None) -> None:
    """Refuse a folder that cannot be written, before anything is computed.

    Args:
        folder: of --out; None is none.

    Raises:
        InputError: it is a file, or lies below one, or nothing can be made there.
    """
    if folder is None:
        return
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            folder.lstat()  # `lexists` does not tell a name that is not there from one that cannot be
        there = next(path for path in (folder, *folder.absolute().parents) if os.path.lexists(path))
        usable, writable = there.is_dir(), os.access(there, os.W_OK | os.X_OK)
    except (OSError, ValueError, StopIteration):
        raise InputError("is no possible name of a folder", str(folder), _MEND) from None
    if not usable:
        raise InputError("is a file, not a folder" if there == folder else f"{there} is a file", str(folder), _MEND)
    if not writable:
        raise InputError(f"nothing can be written to {there}", str(folder), _MEND)


@contextmanager
def output_folder(folder: Path) -> Iterator[Path]:
    """A folder to write files into; at the end they replace those of the same names in `folder`, all together.

    Other files in `folder` stay as they are. An exception leaves `folder` as it was. Another command that writes to
    `folder` is waited for, so what is read from `folder` inside stays true until the end.

    Args:
        folder: made where it is not there.

    Yields:
        The folder to write into; see `take_away` for files of an earlier time that are not written anew.

    Raises:
        InputError: it cannot be written, or another command writes to it for longer than `LONGEST_WAIT`.
    """
    refuse_unusable(folder)
    made = not folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _turn(folder):
            _finish(folder)
            begun = folder / f"{_MARK}{secrets.token_hex(4)}{_BEGUN}"
            begun.mkdir()
            try:
                yield begun
                _refuse_folders_in_the_way(begun, folder)
                whole = begun.rename(begun.with_suffix(_WHOLE))
            except BaseException:  # also Ctrl-C
                shutil.rmtree(begun, ignore_errors=True)
                raise
            _move_in(whole, folder)
    except InputError as error:
        raise InputError(error.what, _shown(error.where, folder), error.mend) from None
    except OSError as error:
        mend = "name another place for the output"
        raise InputError(f"cannot be written ({error.strerror})", str(folder), mend) from None
    finally:
        if made:
            with suppress(OSError):
                folder.rmdir()  # where nothing came of it


def take_away(inside: Path, names: Iterable[str]) -> None:
    """Have files of an earlier time removed with those that are replaced, so that none of them stays beside the new.

    Args:
        inside: what `output_folder` gave.
        names: of files; a name that leads out of the folder is passed over.
    """
    (inside / _GONE).write_text("\n".join(name for name in names if Path(name).name == name), encoding="utf-8")


def finish_interrupted(folder: Path) -> None:
    """Move in what a command that was killed has left whole, and remove what it has only begun.

    Args:
        folder: that is about to be read; nothing happens where it is none.

    Raises:
        InputError: a file cannot be moved or removed, or another command is writing.
    """
    if not folder.is_dir():
        return
    try:
        with _turn(folder):
            _finish(folder)
    except OSError as error:
        mend = "make it writable for a moment"
        raise InputError(f"an interrupted run cannot be finished ({error.strerror})", str(folder), mend) from None


def _finish(folder: Path) -> None:
    for left in sorted(folder.glob(f"{_MARK}*")):
        if left.suffix == _WHOLE:
            _move_in(left, folder)
        elif left.suffix == _BEGUN:
            shutil.rmtree(left, ignore_errors=True)


def _move_in(whole: Path, folder: Path) -> None:
    """Take the old files away, then move the new ones in, so that old and new are never side by side."""
    names = sorted(path.name for path in whole.iterdir() if path.name != _GONE)
    gone = (whole / _GONE).read_text(encoding="utf-8").splitlines() if (whole / _GONE).exists() else []
    for name in (*gone, *names):
        if not (folder / name).is_dir():
            (folder / name).unlink(missing_ok=True)
    for name in names:
        os.replace(whole / name, folder / name)
    (whole / _GONE).unlink(missing_ok=True)
    whole.rmdir()


def _refuse_folders_in_the_way(begun: Path, folder: Path) -> None:
    for path in begun.iterdir():
        if (folder / path.name).is_dir() and not (folder / path.name).is_symlink():
            raise InputError("is a folder, and a file of this name is to be written", str(folder / path.name), _MEND)


def _shown(where: str, folder: Path) -> str:
    """A place in the hidden folder by the name that it was to have."""
    start = f"{folder}{os.sep}{_MARK}"
    return str(folder / where.removeprefix(start).partition(os.sep)[2]) if where.startswith(start) else where


@contextmanager
def _turn(folder: Path) -> Iterator[None]:
    """Hold the folder alone; where the system or the file system knows no locks, nothing is held."""
    try:
        import fcntl

        held = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        due = time.monotonic() + LONGEST_WAIT
        while not _locked(fcntl, held):
            if time.monotonic() > due:
                what = f"another feeddrive has been writing to it for {LONGEST_WAIT:g} s"
                raise InputError(what, str(folder), f"wait for it, or {_MEND}")
            time.sleep(0.05)
        yield
    finally:
        os.close(held)  # which gives the lock back


def _locked(fcntl: Any, held: int) -> bool:
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True  # no locks on this file system
    return True
