"""The cache of compiled libraries: what is old or too much goes, what is in use stays, whatever others do meanwhile."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

from feeddrive import compiled_cache, compiler
from feeddrive.compiled_cache import DAY, IN_USE, LONGEST_UNUSED, prune, used
from feeddrive.compiler import cache_folders, compiled_library, find_compiler

NOW = 2e9
SOURCE = "int answer(void) { return 42; }"


def library(folder: Path, name: str, unused: float, size: int = 10) -> Path:
    path = folder / f"{name}.so"
    path.write_bytes(b"x" * size)
    os.utime(path, (NOW - unused, NOW - unused))
    return path


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, empty."""
    if find_compiler() is None:
        pytest.skip("no C compiler here")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    compiled_cache.prune_once.cache_clear()
    return cache_folders()[0]


def test_what_nobody_has_used_for_long_goes(tmp_path: Path) -> None:
    library(tmp_path, "old", LONGEST_UNUSED + 1)
    library(tmp_path, "young", LONGEST_UNUSED - 1)
    (tmp_path / "somebody's.txt").write_text("kept")
    prune(tmp_path, NOW)
    assert names(tmp_path) == {"young.so", "somebody's.txt"}


def test_what_is_too_much_goes_the_longest_unused_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled_cache, "MOST_BYTES", 25)
    for days in (4, 2, 3, 5):
        library(tmp_path, f"days_{days}", days * DAY)
    prune(tmp_path, NOW)
    assert names(tmp_path) == {"days_2.so", "days_3.so"}


def test_what_is_in_use_stays_however_much_there_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled_cache, "MOST_BYTES", 0)
    library(tmp_path, "now", 0.0)
    library(tmp_path, "today", IN_USE - 1)
    library(tmp_path, "yesterday", IN_USE + 1)
    prune(tmp_path, NOW)
    assert names(tmp_path) == {"now.so", "today.so"}


def test_what_another_marks_while_it_is_pruned_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Between the list of old ones and the deletion another process finds the library and is about to load it."""
    old = library(tmp_path, "old", LONGEST_UNUSED + 1)
    library(tmp_path, "older", LONGEST_UNUSED + 2)
    listed = list(compiled_cache._libraries(tmp_path))
    monkeypatch.setattr(compiled_cache, "_libraries", lambda folder: listed)
    assert used(old)
    prune(tmp_path, NOW)
    assert names(tmp_path) == {"old.so"}


def test_what_ended_processes_left_goes(tmp_path: Path) -> None:
    for name, unused in (("tmpleft", IN_USE + 1), ("tmpnow", 0.0)):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "source.c").write_text("")
        os.utime(folder, (NOW - unused, NOW - unused))
    prune(tmp_path, NOW)
    assert names(tmp_path) == {"tmpnow"}


def test_a_library_that_is_used_is_marked(cache: Path) -> None:
    assert compiled_library(SOURCE) is not None
    (made,) = cache.glob("*.so")
    os.utime(made, (NOW - 1e8, NOW - 1e8))
    assert compiled_library(SOURCE) is not None
    assert made.stat().st_mtime != NOW - 1e8


def test_making_one_prunes_the_others(cache: Path) -> None:
    cache.mkdir(parents=True)
    old = library(cache, "old", 0.0)
    os.utime(old, (0.0, 0.0))
    assert compiled_library(SOURCE) is not None
    assert not old.exists() and len(list(cache.glob("*.so"))) == 1


def test_one_that_is_deleted_before_it_is_loaded_is_made_again(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert compiled_library(SOURCE) is not None
    (made,) = cache.glob("*.so")
    loads: list[str] = []

    loaded = ctypes.CDLL

    def deleted_first(path: str) -> ctypes.CDLL:
        loads.append(path)
        if len(loads) == 1:
            made.unlink()
            raise OSError("no such file")
        return loaded(path)

    monkeypatch.setattr(compiler.ctypes, "CDLL", deleted_first)
    found = compiled_library(SOURCE)
    assert found is not None and found.answer() == 42 and len(loads) == 2


PROGRAM = """
import sys, threading, time
from feeddrive import compiled_cache
from feeddrive.compiler import compiled_library, cache_folders
compiled_cache.LONGEST_UNUSED = 0.2
(folder, _), end, deleted = cache_folders(), time.time() + 4.0, 0
while time.time() < end:
    number = int(time.time() * 3) % 3  # each is used for a third of a second, then not for two of them
    before = len(list(folder.glob("*.so")))
    library = compiled_library(f"int answer(void) {{ return {number}; }}")
    assert library is not None and library.answer() == number, (number, library)
    compiled_cache.prune(folder, time.time())
    deleted += before > len(list(folder.glob("*.so")))
print(deleted)
"""


def test_processes_that_prune_everything_all_the_time_still_run(cache: Path) -> None:
    """Three processes delete what was not used for 0.2 s, all the time, and ask for it again: every load succeeds."""
    running = [
        subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    deleted = 0
    for process in running:
        told, error = process.communicate(timeout=120)
        assert process.returncode == 0, error
        deleted += int(told)
    assert deleted > 0
