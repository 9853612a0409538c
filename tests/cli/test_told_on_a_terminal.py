"""What a person sees beside the answer: where files went, what is going on, titles and names in full."""

from __future__ import annotations

import io
import re
import shlex
from pathlib import Path

import pytest
from rich.console import Console

from feeddrive.cli import output
from feeddrive.cli.main import main
from feeddrive.effects.catalogue import EFFECTS
from feeddrive.files import find_plant, shipped_scenarios
from feeddrive.interface.measured import diagnosis_run
from feeddrive.interface.measured.diagnosis_run import Job, Source
from feeddrive.report.words.words import effect_words

QUICK_WITH_OUT = (
    "list --out {}/given.txt",
    "show bench_axis --out {}/given",
    "show thermal_bench --out {}/given.txt",
    "check bench_axis --out {}/given.txt",
    "modes bench_axis --out {}/given",
    "lump kimm_testbed --at 464mm --out {}/given.toml",
    "run step_velocity --out {}/given",
    "bode bench_axis --out {}/given",
    "export bench_axis --to json --out {}/given",
)


@pytest.mark.parametrize("typed", QUICK_WITH_OUT)
def test_out_is_told(typed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(shlex.split(typed.format(tmp_path))) == 0
    told = re.sub(r"[│\s]", "", capsys.readouterr().out)  # a table may break a long path
    assert f"{tmp_path}/given" in told


def test_list_says_what_things_are(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "_WIDTH", 300)  # one line for each row
    monkeypatch.delenv("COLUMNS", raising=False)
    assert main(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = {
        cells[0]: cells[1] for line in lines if len(cells := [one.strip() for one in line.strip("│").split("│")]) > 1
    }
    assert all(len(rows[path.stem]) > 20 for path in shipped_scenarios())
    assert all(rows[name] == effect_words(name) for name in EFFECTS)


@pytest.mark.parametrize("width", [80, 100])
def test_width_of_a_pipe_is_that_of_its_reader(
    width: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    assert main(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    framed = [line for line in lines if line[:1] in ("┏", "┃", "┡", "│", "└")]
    assert framed and max(map(len, framed)) <= width
    assert all(line[-1] in "┓┃┩│┘" for line in framed)  # nothing is cut off
    assert all(name in "\n".join(lines) for name in EFFECTS)  # no name is broken


def test_report_tells_the_command_that_makes_it_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Typed again, it is the job that it was made from."""
    typed = ["a b.csv", "--validate", "c.csv", "--map", "m.toml", "--decimal", ",", "--simulate", "--out", "report"]
    files = tuple(Source(Path(one), Path("m.toml"), ",") for one in ("a b.csv", "c.csv"))
    job = Job(find_plant("bench_axis"), files[:1], files[1:], Path("report"), simulate=True)
    assert shlex.split(diagnosis_run._command(job)) == ["feeddrive", "diagnose", "bench_axis", *typed]
    alone = Job(Path("my.toml"), (Source(Path("a.csv")),), (), Path("report"), 0.6)
    assert diagnosis_run._command(alone) == "feeddrive diagnose my.toml a.csv --split 0.6 --out report"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert diagnosis_run._today() == "1970-01-02"
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    assert re.fullmatch(r"20\d\d-[01]\d-[0-3]\d", diagnosis_run._today())


def test_title_is_one_line_above_a_narrow_table() -> None:
    stream = io.StringIO()
    title = "a title of many words that is much wider than the table below it"
    output._print(Console(file=stream, width=120), [output.table(title, ("a",), [["1"]])])
    assert stream.getvalue().splitlines()[0] == title


def test_what_is_going_on_is_told_with_the_time_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    stream = Terminal()
    monkeypatch.setattr("sys.stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "80")
    with output.working("reading [1/2]") as said:
        said("fitting")
    told = stream.getvalue()
    assert "0:00:00" in told and "fitting" in told


def test_nothing_is_told_in_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr("sys.stderr", stream)
    with output.working("reading") as said:
        said("fitting")
    assert stream.getvalue() == ""
