"""The command line before any command runs: help, version, the border at which errors become one line."""

from __future__ import annotations

import os
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path

import pytest

import feeddrive
from feeddrive.cli import main as entry
from feeddrive.errors import InputError

HEAVY = ("numpy", "scipy", "casadi", "control", "matplotlib", "pint", "pydantic")
"""Each takes from tenths of a second to seconds to import: none may be needed to answer `--help`."""

Command = Callable[[], None]


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch) -> Callable[[Command], None]:
    """Puts a function in the place of the command `show`."""

    def install(function: Command) -> None:
        module = types.ModuleType("feeddrive.cli.show")
        module.command = function  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, "feeddrive.cli.show", module)

    return install


def _run(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    root = str(Path(feeddrive.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": root}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, timeout=60
    )


def test_help_imports_nothing_heavy(tmp_path: Path) -> None:
    program = (
        "import sys; from feeddrive.cli.main import main; status = main(['--help']);"
        f"print('heavy:', [name for name in {HEAVY!r} if name in sys.modules]); sys.exit(status)"
    )
    run = _run("-c", program, folder=tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stdout.splitlines()[-1] == "heavy: []"


def test_python_dash_m_from_another_folder(tmp_path: Path) -> None:
    run = _run("-m", "feeddrive", "--version", folder=tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (0, f"feeddrive {feeddrive.__version__}\n", "")


@pytest.mark.parametrize("option", ["--help", "-h"])
def test_help_lists_every_command_with_its_whole_summary(option: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.main([option]) == 0
    shown = capsys.readouterr().out
    for name, line in entry.COMMANDS.items():
        assert any(text.split(maxsplit=1) == [name, line.summary] for text in shown.splitlines()), name


def test_nothing_typed_shows_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.main([]) == 2
    assert "Commands:" in "".join(capsys.readouterr())


@pytest.mark.parametrize("typed", [["--nonsense"], ["nonsense"], ["show", "--nonsense"]])
def test_unknown_option_or_command_ends_with_two(
    typed: list[str], command: Callable[[Command], None], capsys: pytest.CaptureFixture[str]
) -> None:
    command(lambda: None)
    assert entry.main(typed) == 2
    assert "--nonsense" in (shown := capsys.readouterr().err) or "'nonsense'" in shown


def test_misspelt_command_names_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert entry.main(["diagnos"]) == 2
    assert "'diagnose'" in capsys.readouterr().err


def test_command_that_finishes_ends_with_zero(command: Callable[[Command], None]) -> None:
    ran: list[bool] = []
    command(lambda: ran.append(True))
    assert entry.main(["show"]) == 0
    assert ran == [True]


def test_only_the_invoked_command_is_imported(
    command: Callable[[Command], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    command(lambda: None)
    imported: list[str] = []

    def import_module(name: str) -> types.ModuleType:
        imported.append(name)
        return sys.modules[name]

    monkeypatch.setattr(entry, "import_module", import_module)
    assert entry.main(["show"]) == 0
    assert imported == ["feeddrive.cli.show"]


FAILURES = [
    (InputError("no column 'time'", "run.csv, row 1", "name it 'time [s]'"), 2, "error: run.csv, row 1: no column"),
    (PermissionError(13, "Permission denied", "out/report.html"), 2, "error: out/report.html: Permission denied"),
    (ZeroDivisionError("division\nby zero"), 1, "internal error: ZeroDivisionError: division by zero; please report"),
    (OSError("no file behind it"), 1, "internal error: OSError: no file behind it; please report"),
]


@pytest.mark.parametrize(("failure", "status", "line"), FAILURES, ids=lambda value: type(value).__name__)
def test_error_becomes_one_line(
    failure: Exception,
    status: int,
    line: str,
    command: Callable[[Command], None],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("FEEDDRIVE_TRACEBACK", raising=False)
    command(_raising(failure))
    assert entry.main(["show"]) == status
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith(line)
    assert shown.err.count("\n") == 1


def test_traceback_of_an_internal_error_on_request(
    command: Callable[[Command], None], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FEEDDRIVE_TRACEBACK", "1")
    command(_raising(ZeroDivisionError("division by zero")))
    assert entry.main(["show"]) == 1
    assert "Traceback (most recent call last)" in capsys.readouterr().err


def test_interrupt_ends_as_in_a_shell(command: Callable[[Command], None]) -> None:
    command(_raising(KeyboardInterrupt()))
    assert entry.main(["show"]) == 130


def _raising(failure: BaseException) -> Command:
    def run() -> None:
        raise failure

    return run
