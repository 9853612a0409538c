"""What goes wrong outside of the program ends with one line and status 2: deep files, full disks, damaged leftovers."""

from __future__ import annotations

import errno
import getpass
import json
import os
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import feeddrive
from feeddrive import compiler
from feeddrive.cli import main as entry
from feeddrive.cli.main import main
from feeddrive.compiler import cache_folders, compiled_library, find_compiler
from feeddrive.errors import ValidityWarning
from feeddrive.files import plants_folder

BENCH = (plants_folder() / "bench_axis.toml").read_text(encoding="utf-8")


def _refused(arguments: list[str], told: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith("error: ")
    assert shown.err.count("\n") == 1
    for words in told:
        assert words in shown.err


def _plant(folder: Path, text: str) -> str:
    path = folder / "machine.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("block", [
    "a" + ".a" * 3000 + " = 1",  # no brackets: the reader of TOML does not run out of levels
    "[" + "a." * 900 + "a]",
    "x = " + "{a = " * 90 + "1" + "}" * 90,
    "x = " + "[" * 90 + "]" * 90,
], ids=["dotted key", "dotted table", "tables", "lists"])  # fmt: skip
def test_tables_in_tables(block: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _refused(["show", _plant(tmp_path, f"{block}\n")], ["machine.toml", "more than 12 levels"], capsys)


DEEP = ["a" + ".a" * 3000 + "=1", "trajectory.at=" + "[" * 3000, "plant" + ".a" * 300 + "=1"]


@pytest.mark.parametrize("setting", DEEP, ids=["scenario", "value", "plant"])
def test_tables_in_tables_by_set(setting: str, capsys: pytest.CaptureFixture[str]) -> None:
    _refused(["run", "step_position", "--set", setting], [], capsys)


@pytest.mark.parametrize("repeat", ["1e9", "1000000000", "9" * 5000])
def test_motion_repeated_too_often(repeat: str, capsys: pytest.CaptureFixture[str]) -> None:
    told = ["trajectory.repeat"]
    _refused(["run", "s_curve_positioning", "--set", f"trajectory.repeat={repeat}"], told, capsys)


def test_circle_that_is_never_begun(capsys: pytest.CaptureFixture[str]) -> None:
    settings = ["--set", "run.duration=0.02 s", "--set", "trajectory.dwell=1 s"]
    _refused(["run", "circular_test", *settings], ["the run ends before the circle begins"], capsys)


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "cut": lambda data: data[: len(data) // 2],
    "empty": lambda data: b"",
    "no archive": lambda data: b"x" * 100,
    "an array": lambda data: b"\x93NUMPY" + data[6:],
    "a bit": lambda data: data[: len(data) // 2] + bytes([data[len(data) // 2] ^ 1]) + data[len(data) // 2 + 1 :],
    "the middle": lambda data: data[: len(data) // 2] + b"\0" * 400 + data[len(data) // 2 + 400 :],
}


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The checkpoint of a run that was stopped after its first stretch."""
    from feeddrive.files import find_scenario
    from feeddrive.simulate.scenario import scenario_run
    from feeddrive.simulate.scenario.scenario_file import read_scenario

    path = tmp_path_factory.mktemp("stopped") / "checkpoint.npz"
    scenario = read_scenario(find_scenario("step_position"), {"record.rate": "2 kHz"})
    done = scenario_run._further(scenario, scenario_run._start(scenario), 400)
    scenario_run.write_checkpoint(scenario, done, path)
    return path.read_bytes()


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_damaged_checkpoint(
    damage: Callable[[bytes], bytes], checkpoint: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "checkpoint.npz").write_bytes(damage(checkpoint))
    arguments = ["run", "step_position", "--set", "record.rate=2 kHz", "--out", str(tmp_path)]
    _refused(arguments, ["checkpoint.npz", "remove it to start anew"], capsys)


def test_checkpoint_with_other_arrays(checkpoint: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "checkpoint.npz"
    path.write_bytes(checkpoint)
    with np.load(path) as file:
        arrays = dict(file)
    for name in ("state", "torque", "rows"):
        np.savez(path, **{**arrays, name: arrays[name][:-1] if name != "rows" else arrays[name][:, :-1]})
        arguments = ["run", "step_position", "--set", "record.rate=2 kHz", "--out", str(tmp_path)]
        _refused(arguments, ["checkpoint.npz", "changed or damaged"], capsys)


def test_whole_checkpoint_is_gone_on_with(checkpoint: bytes, tmp_path: Path) -> None:
    """So that the tests above refuse for the damage, and not anything that lies there."""
    arguments = ["run", "step_position", "--set", "record.rate=2 kHz", "--out"]
    assert main([*arguments, str(tmp_path / "anew")]) == 0
    (tmp_path / "resumed").mkdir()
    (tmp_path / "resumed" / "checkpoint.npz").write_bytes(checkpoint)
    assert main([*arguments, str(tmp_path / "resumed")]) == 0
    assert not (tmp_path / "resumed" / "checkpoint.npz").exists()
    first, second = ((tmp_path / name / "recording.csv").read_bytes() for name in ("anew", "resumed"))
    assert first == second


UNITS = {
    "no run": lambda runs: [5],
    "no list": lambda runs: {"run": 0},
    "no metrics": lambda runs: [{key: value for key, value in runs[0].items() if key != "metrics"}],
    "metrics of another kind": lambda runs: [{**runs[0], "metrics": {"a": 5}}],
    "a number as reason": lambda runs: [{**runs[0], "reason": 5}],
    "neither reason nor metrics": lambda runs: [{**runs[0], "metrics": {}}],
}


@pytest.mark.parametrize("name", UNITS)
def test_damaged_unit_of_a_sweep(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["sweep", "step_position", "--set", "run.duration=0.2 s", "--workers", "1", "--out", str(tmp_path)]
    arguments += ["--vary", "controller.position_gain=40,80 1/s"]
    assert main(arguments) == 0
    capsys.readouterr()
    path = tmp_path / "units" / "0000.json"
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "runs": UNITS[name](content["runs"])}))
    _refused(arguments, ["0000.json", "remove it"], capsys)
    path.write_text("[" * 100_000)
    _refused(arguments, ["0000.json", "remove it"], capsys)
    (tmp_path / "sweep.json").write_text('{"runs": "2", "unit_size": 1.5}')
    _refused(arguments, ["sweep.json", "is not the beginning of a sweep"], capsys)


@pytest.mark.parametrize("content", ["[" * 100_000, '{"format": "feeddrive-ledger/1", "runs": [5]}', "\udcff"])
def test_damaged_ledger(content: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "ledger.json").write_bytes(content.encode("utf-8", "surrogateescape"))
    _refused(["diagnose", "run.csv", "--continue", str(tmp_path)], ["ledger"], capsys)


@pytest.mark.parametrize("run", [
    "{}", '{"plant": 5}', '{"plant": {"path": "x", "sha256": 5}, "fit": 5}',
    '{"plant": {"path": "PLANT", "sha256": "SHA"}, "fit": [], "validate": [], "values": [[]], "effects": []}',
])  # fmt: skip
def test_ledger_that_lacks_entries(run: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from feeddrive.diagnosis.ledger.ledger import checksum

    plant = plants_folder() / "bench_axis.toml"
    run = run.replace("PLANT", str(plant)).replace("SHA", checksum(plant))
    (tmp_path / "ledger.json").write_text(f'{{"format": "feeddrive-ledger/1", "runs": [{run}]}}')
    _refused(["diagnose", "run.csv", "--continue", str(tmp_path)], [], capsys)


def _nobody() -> str:
    raise KeyError("getpwuid(): uid not found: 4711")


def test_person_without_a_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a container that runs under a bare number."""
    monkeypatch.setattr(getpass, "getuser", _nobody)
    monkeypatch.setenv("XDG_CACHE_HOME", "~/.cache")  # what expanduser leaves where there is no home
    folders = cache_folders()
    assert [folder.name for folder in folders] == [f"feeddrive-{os.getuid()}"]
    assert all(folder.is_absolute() for folder in folders)


@pytest.fixture
def hanging(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A compiler that starts a program which does not end, and waits for it."""
    path = tmp_path / "hanging-cc"
    path.write_text("#!/bin/sh\nsleep 300\n")
    path.chmod(0o755)
    monkeypatch.setenv("CC", str(path))
    monkeypatch.delenv("FEEDDRIVE_COMPILER", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(compiler, "COMPILE_TIME", 0.5)
    monkeypatch.setattr(compiler, "_hung", set())
    find_compiler.cache_clear()
    yield path
    find_compiler.cache_clear()


def test_compiler_that_hangs_is_done_without(hanging: Path) -> None:
    with pytest.warns(ValidityWarning, match=r"the C compiler did not end within 0\.5 s; it is done"):
        assert compiled_library("int f(void) { return 1; }") is None
    assert compiled_library("int f(void) { return 2; }") is None  # without waiting, and without a word
    running = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
    assert str(hanging) not in running
    assert not [line for line in running.splitlines() if line == "sleep 300"]


def test_compiler_that_hangs_at_an_fmu(hanging: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["export", "bench_axis", "--to", "fmu", "--out", str(tmp_path / "out")]
    _refused(arguments, [str(hanging), "did not end", "FEEDDRIVE_COMPILER=none"], capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("form", ["fmu", "casadi"])
def test_full_temporary_disk_at_an_export(
    form: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if find_compiler() is None:
        pytest.skip("no C compiler: nothing is written to the temporary folder")

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("tempfile.mkdtemp", full)
    _refused(
        ["export", "bench_axis", "--to", form, "--out", str(tmp_path / "out")], ["temporary folder", "TMPDIR"], capsys
    )


def _run(arguments: list[str], **options: object) -> subprocess.CompletedProcess[bytes]:
    environment = {**os.environ, "PYTHONPATH": str(Path(feeddrive.__file__).parents[1])}
    command = [sys.executable, "-m", "feeddrive", *arguments]
    return subprocess.run(command, env=environment, stderr=subprocess.PIPE, timeout=120, **options)  # type: ignore[call-overload, no-any-return]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no file that is always full")
def test_full_disk_behind_standard_output() -> None:
    with open("/dev/full", "wb") as full:
        run = _run(["list"], stdout=full)
    assert run.returncode == 2
    assert run.stderr.count(b"\n") == 1
    assert b"No space left on device" in run.stderr


def test_reader_of_a_pipe_that_leaves() -> None:
    read, write = os.pipe()
    os.close(read)
    run = _run(["list"], stdout=write)
    os.close(write)
    assert (run.returncode, run.stderr) == (0, b"")


FAILURES = [
    (OverflowError("math range error"), 2, "beyond what can be computed"),
    (FloatingPointError("underflow"), 2, "beyond what can be computed"),
    (np.linalg.LinAlgError("Singular matrix"), 2, "beyond what can be computed"),
    (MemoryError(), 2, "more memory"),
    (OSError(errno.ENOSPC, "No space left on device"), 2, "No space left on device"),
    # Mistakes of ours stay mistakes of ours.
    (ZeroDivisionError("division by zero"), 1, "internal error: ZeroDivisionError"),
    (RecursionError("maximum recursion depth exceeded"), 1, "internal error: RecursionError"),
    (KeyError("x"), 1, "internal error: KeyError"),
    (ValueError("x"), 1, "internal error: ValueError"),
    (AssertionError(), 1, "internal error: AssertionError"),
]


@pytest.mark.parametrize(("failure", "status", "told"), FAILURES, ids=lambda value: type(value).__name__)
def test_what_is_the_input_and_what_is_ours(
    failure: Exception, status: int, told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def command() -> None:
        raise failure

    module = types.ModuleType("feeddrive.cli.show")
    module.command = command  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "feeddrive.cli.show", module)
    monkeypatch.delenv("FEEDDRIVE_TRACEBACK", raising=False)
    assert entry.main(["show"]) == status
    shown = capsys.readouterr().err
    assert told in shown
    assert shown.count("\n") == 1


USAGE = [
    (["show", "bench_axis", "--nonsense"], "feeddrive show: no such option: --nonsense"),
    (["nonsense"], "feeddrive: no such command 'nonsense'"),
    (["tune", "bench_axis", "--payload"], "feeddrive tune: option '--payload' requires an argument"),
    (
        ["export", "bench_axis", "--to", "x", "--out", "y"],
        "feeddrive export: invalid value for '--to': 'x' is not one of",
    ),
    (["export", "bench_axis"], "feeddrive export: missing option '--to'"),
    (["sweep", "x", "--seed", "-1"], "feeddrive sweep: invalid value for '--seed'"),
    (["show", "--\x1b[31m" + "x" * 300_000], "feeddrive show: no such option: --"),
]


@pytest.mark.parametrize(("typed", "told"), USAGE, ids=[told for _, told in USAGE])
def test_usage_error_is_one_line(typed: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    _refused(typed, [f"error: {told}", "--help lists what is possible"], capsys)


def test_usage_error_is_short_and_printable(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "--\x1b[31m" + "x" * 300_000]) == 2
    shown = capsys.readouterr().err
    assert len(shown) < 1000
    assert shown.rstrip("\n").isprintable()


def test_warning_of_a_library_is_one_line_without_a_place(capfd: pytest.CaptureFixture[str]) -> None:
    program = (
        "import sys, types, warnings\nmodule = types.ModuleType('feeddrive.cli.show')\n"
        "module.command = lambda: warnings.warn('overflow', RuntimeWarning)\n"
        "sys.modules['feeddrive.cli.show'] = module\nfrom feeddrive.cli.main import main\nsys.exit(main(['show']))\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(feeddrive.__file__).parents[1]), "PYTHONWARNINGS": "default"}
    run = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, timeout=60)
    assert (run.returncode, run.stderr) == (0, "warning: overflow\n")


@pytest.mark.parametrize("count", ["0", "-1", "100000"])
def test_workers_that_no_computer_holds(count: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["sweep", "step_position", "--vary", "controller.position_gain=40,80 1/s", "--workers", count]
    _refused(arguments, ["--workers", "write 1 to"], capsys)


@pytest.mark.parametrize("option", [
    ["--set", "evaluate." + "9" * 5000 + ".at=1 s"], ["--vary", "controller.position_gain=1:2:" + "9" * 5000],
], ids=["set", "vary"])  # fmt: skip
def test_whole_numbers_of_thousands_of_digits(option: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """More digits than Python reads as a number."""
    more = [] if option[0] == "--vary" else ["--vary", "controller.position_gain=40,80 1/s"]
    _refused(["sweep", "step_position", "--workers", "1", *option, *more], [], capsys)
