"""Folders of results: whole or not at all, whoever is killed where; other files stay; commands take turns."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

import feeddrive
from feeddrive import output_folder as module
from feeddrive.errors import InputError
from feeddrive.output_folder import finish_interrupted, output_folder, refuse_unusable

NAMES = ("diagnosis.json", "figure.png", "report.html")

KILLED = """
import os, pathlib, shutil, sys
from feeddrive.output_folder import output_folder
folder, count = pathlib.Path(sys.argv[1]), int(sys.argv[2])
def counted(function):
    def call(*arguments, **named):
        global count
        if count == 0:
            os._exit(9)
        count -= 1
        return function(*arguments, **named)
    return call
for holder, names in ((os, ("replace", "rename", "unlink", "rmdir", "mkdir", "open")), (shutil, ("rmtree",))):
    for name in names:
        setattr(holder, name, counted(getattr(holder, name)))
with output_folder(folder) as inside:
    for name in ("diagnosis.json", "figure.png", "report.html"):
        (inside / name).write_text("new")
        if count == 0:
            os._exit(9)
        count -= 1
os._exit(0)
"""
"""Replaces the files, and dies before its n-th touch of the file system."""


def _write(folder: Path, text: str, names: tuple[str, ...] = NAMES) -> None:
    with output_folder(folder) as inside:
        for name in names:
            (inside / name).write_text(text)


def _ours(folder: Path) -> list[str]:
    return [(folder / name).read_text() for name in NAMES if (folder / name).exists()]


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(Path(feeddrive.__file__).parents[1])}


def test_killed_at_every_step_old_and_new_are_never_side_by_side(tmp_path: Path) -> None:
    statuses = set()
    for count in range(40):
        folder = tmp_path / str(count)
        _write(folder, "old")
        (folder / "notes.txt").write_text("mine")
        (folder / "photos").mkdir()
        run = subprocess.run([sys.executable, "-c", KILLED, str(folder), str(count)], env=_environment(), timeout=60)
        statuses.add(run.returncode)
        seen = _ours(folder)
        assert len(set(seen)) <= 1, (count, seen)
        # What was killed before it was whole has not happened; what was whole is finished by the next command.
        whole = bool(list(folder.glob(".feeddrive-*.whole"))) or seen == ["new"] * 3
        with output_folder(folder):
            assert _ours(folder) == ["new" if whole else "old"] * 3, count
        assert sorted(path.name for path in folder.iterdir()) == sorted([*NAMES, "notes.txt", "photos"])
        assert (folder / "notes.txt").read_text() == "mine"
        if run.returncode == 0:
            break
    assert statuses == {0, 9}  # it was killed, and at last it was not: every step has had its turn


def test_exception_leaves_the_folder_as_it_was(tmp_path: Path) -> None:
    _write(tmp_path / "out", "old")
    with pytest.raises(ZeroDivisionError), output_folder(tmp_path / "out") as inside:
        (inside / "report.html").write_text("new")
        raise ZeroDivisionError
    assert _ours(tmp_path / "out") == ["old"] * 3
    assert len(list((tmp_path / "out").iterdir())) == 3


def test_folder_that_was_made_for_nothing_is_removed(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), output_folder(tmp_path / "out"):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_files_of_other_names_and_the_folder_itself_stay(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    number = folder.stat().st_ino
    (folder / "notes.txt").write_text("mine")
    _write(folder, "new")
    # A shell that stands in it, or a container that has it mounted, still sees it.
    assert folder.stat().st_ino == number
    assert (folder / "notes.txt").read_text() == "mine"


def test_link_to_a_folder(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "out").symlink_to(tmp_path / "there")
    _write(tmp_path / "out", "new")
    assert (tmp_path / "out").is_symlink()
    assert _ours(tmp_path / "there") == ["new"] * 3


def test_folder_in_the_place_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "out" / "report.html").mkdir(parents=True)
    with pytest.raises(InputError, match=r"report\.html: is a folder"):
        _write(tmp_path / "out", "new")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["report.html"]


def test_full_disk_names_the_file_as_it_was_to_be_called(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from feeddrive.files import write_text_atomically

    def full(self: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    folder = tmp_path / "my.parts"  # a name that holds the mark of what is begun
    with pytest.raises(InputError) as raised, output_folder(folder) as inside:
        write_text_atomically(inside / "report.html", "new")
    assert raised.value.where == str(folder / "report.html")
    assert "No space left" in raised.value.what


@pytest.mark.parametrize("name", ["file", "file/below", "a\0b", "x" * 5000])
def test_unusable_folders_are_refused_before_anything_is_computed(name: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="name another folder"):
        refuse_unusable(tmp_path / name)


def test_two_writers_take_turns(tmp_path: Path) -> None:
    """Each adds its number to a list that it has read inside; without turns one of them is lost."""
    program = (
        "import json, pathlib, sys, time\nfrom feeddrive.output_folder import output_folder\n"
        "folder = pathlib.Path(sys.argv[1])\nwith output_folder(folder) as inside:\n"
        "    path = folder / 'list.json'\n    known = json.loads(path.read_text()) if path.exists() else []\n"
        "    time.sleep(0.3)\n    (inside / 'list.json').write_text(json.dumps([*known, int(sys.argv[2])]))\n"
    )
    started = [
        subprocess.Popen([sys.executable, "-c", program, str(tmp_path / "out"), str(n)], env=_environment())
        for n in range(4)
    ]
    assert [one.wait(timeout=60) for one in started] == [0] * 4
    assert sorted(json.loads((tmp_path / "out" / "list.json").read_text())) == [0, 1, 2, 3]


def test_writer_that_takes_too_long_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fcntl", reason="this system knows no locks of folders")
    monkeypatch.setattr(module, "LONGEST_WAIT", 0.2)
    program = (
        "import pathlib, sys, time\nfrom feeddrive.output_folder import output_folder\n"
        "with output_folder(pathlib.Path(sys.argv[1])):\n    print('in', flush=True)\n    time.sleep(60)\n"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "out")]
    with subprocess.Popen(command, env=_environment(), stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        other.stdout.readline()
        begun = time.monotonic()
        with pytest.raises(InputError, match="another feeddrive has been writing"):
            _write(tmp_path / "out", "new")
        assert time.monotonic() - begun < 30  # it waits for LONGEST_WAIT, not for the other to end
        other.kill()
    _write(tmp_path / "out", "new")  # the dead hold nothing
    assert _ours(tmp_path / "out") == ["new"] * 3


def test_what_was_left_whole_is_moved_in_before_it_is_read(tmp_path: Path) -> None:
    _write(tmp_path, "old")
    whole, begun = tmp_path / ".feeddrive-0.whole", tmp_path / ".feeddrive-1.part"
    for left, text in ((whole, "new"), (begun, "half")):
        left.mkdir()
        for name in NAMES:
            (left / name).write_text(text)
    finish_interrupted(tmp_path)
    assert _ours(tmp_path) == ["new"] * 3
    assert len(list(tmp_path.iterdir())) == 3
    finish_interrupted(tmp_path / "nowhere")
