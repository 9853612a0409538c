"""`feeddrive reproduce` as a user types it: the numbers of the papers beside those of the program, with reasons."""

from __future__ import annotations

import csv
import importlib
import io
import json
import sys
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from feeddrive.cli.main import main
from feeddrive.cli.reproduce import Comparison, deviation_text
from feeddrive.parts.life.life_exponents import load_exponent
from feeddrive.reproduce.collection import FIELDS, as_csv, counts, record, rows_of
from feeddrive.reproduce.row import Paper, Row, Status, claim, not_possible, number


@pytest.fixture(scope="module")
def whole() -> list[Row]:
    """All rows."""
    return [row for paper in Paper for row in rows_of(paper)]


def _shown(rows: list[Row], width: int) -> str:
    console = Console(file=io.StringIO(), width=width, markup=False, highlight=False, emoji=False)
    console.print(Comparison(rows[0].paper, rows))
    text: str = console.file.getvalue()  # type: ignore[attr-defined]
    return text


def _words(text: str) -> str:
    return " ".join(text.split())


@pytest.mark.parametrize("paper", Paper, ids=lambda paper: paper.number)
def test_every_paper_has_rows_of_its_own(paper: Paper) -> None:
    rows = rows_of(paper)
    assert len(rows) >= 20
    assert {row.paper for row in rows} == {paper}


def test_there_are_enough_rows_and_every_other_one_has_a_reason(whole: list[Row]) -> None:
    assert len(whole) >= 90
    for row in whole:
        assert row.reason or row.status is Status.REPRODUCED, row
        assert row.computed or row.status is Status.NOT_POSSIBLE, row
        assert row.place and row.quantity, row


LAW = load_exponent
"""Any law of the package."""


@pytest.mark.parametrize(
    ("given", "status"),
    [
        ({"law": LAW}, Status.REPRODUCED),
        ({"law": LAW, "assumption": "a"}, Status.ASSUMPTION),
        ({"law": LAW, "fitted": "f"}, Status.FITTED),
        ({"law": LAW, "fitted": "f", "assumption": "a"}, Status.FITTED),
        ({"law": None}, Status.PAPER_ONLY),
        ({"law": None, "fitted": "f"}, Status.PAPER_ONLY),
    ],
)
def test_status_follows_from_what_the_row_holds(given: dict[str, Any], status: Status) -> None:
    agreeing = number(Paper.LIFE, "eq. 1", "p", "", "3", 3.04, **given)
    assert agreeing.status is status
    missed = number(Paper.LIFE, "eq. 1", "p", "", "3", 3.6, otherwise="why", **given)
    assert missed.status is (Status.CONTRADICTED if given["law"] else Status.PAPER_ONLY)
    assert missed.reason == "why"


def test_a_law_is_one_of_the_package() -> None:
    for other in (rows_of, json.loads):  # of this comparison itself, and of elsewhere
        with pytest.raises(ValueError, match="no law of the package"):
            number(Paper.LIFE, "eq. 1", "p", "", "3", 3.0, law=other)


@pytest.mark.parametrize("paper", Paper, ids=lambda paper: paper.number)
def test_the_named_laws_are_run(paper: Paper) -> None:
    """A row may name only a law that computing the rows of its paper calls."""
    module = importlib.import_module(f"feeddrive.reproduce.paper_{paper.number}")
    for name, other in list(sys.modules.items()):  # results that were kept from earlier
        if name.startswith("feeddrive.reproduce") or name.startswith("feeddrive.parts"):
            for kept in vars(other).values():
                if hasattr(kept, "cache_clear"):
                    kept.cache_clear()
    called: set[str] = set()

    def note(frame: Any, event: str, _: object) -> None:
        if event == "call":
            name = frame.f_globals.get("__name__", "")
            if name.startswith("feeddrive."):
                called.add(f"{name}.{frame.f_code.co_qualname}")

    sys.setprofile(note)
    try:
        found = module.rows()
    finally:
        sys.setprofile(None)
    laws = {row.law for row in found if row.law}
    # A class is called as its methods are.
    assert {law for law in laws if not any(one == law or one.startswith(f"{law}.") for one in called)} == set()


def test_no_row_stands_twice(whole: list[Row]) -> None:
    # A printed number may be computed by two models: then the reasons tell them apart.
    keys = [(row.paper, row.place, row.quantity, row.printed, row.reason) for row in whole]
    assert len(set(keys)) == len(keys)


def test_json_holds_what_the_table_shows(capsys: pytest.CaptureFixture[str], whole: list[Row]) -> None:
    assert main(["reproduce", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["rows"] == [record(row) for row in whole]
    assert main(["reproduce"]) == 0
    table = _words(capsys.readouterr().out)
    for row in content["rows"]:
        # Cells wrap in columns, the reason does not share its lines with others.
        assert _words(row["reason"]) in table
    total = [str(count) for count in content["summary"].values()]
    assert " │ ".join(["all", *total, str(len(whole))]) in table


def test_summary_counts_every_row_once(whole: list[Row]) -> None:
    assert sum(counts(whole).values()) == len(whole)


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("paper", Paper, ids=lambda paper: paper.number)
def test_tables_fit_the_terminal(paper: Paper, width: int) -> None:
    text = _shown(list(rows_of(paper)), width)
    assert max(len(line) for line in text.splitlines()) <= width


def test_no_word_is_cut_at_80_columns(whole: list[Row]) -> None:
    for row in whole:
        shown = _shown([row], 80).split()
        for word in row.quantity.split():
            assert word in shown


def test_one_paper_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "--paper", "004", "--json"]) == 0
    padded = capsys.readouterr().out
    assert {row["paper"] for row in json.loads(padded)["rows"]} == {"004"}
    assert main(["reproduce", "--paper", "4", "--json"]) == 0
    assert capsys.readouterr().out == padded


def test_the_combined_stiffness_is_in_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "--paper", "004"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any("k_XS" in line and "244.7 N/µm" in line for line in lines)


@pytest.mark.parametrize("number_text", ["005", "x", ""])
def test_unknown_papers_are_refused(number_text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "--paper", number_text]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "000, 001, 002, 003, 004" in error


def test_files_hold_the_same_rows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "deep" / "out"
    assert main(["reproduce", "--paper", "001", "--json", "--out", str(folder)]) == 0
    shown = capsys.readouterr()
    assert (folder / "reproduce.json").read_text(encoding="utf-8") == shown.out
    rows: list[dict[str, Any]] = json.loads(shown.out)["rows"]
    with (folder / "reproduce.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(file))
    assert tuple(lines[0]) == FIELDS
    assert len(lines) == len(rows)
    for line, row in zip(lines, rows, strict=True):
        assert line == {key: "" if value is None else str(value) for key, value in row.items()}


def test_commas_and_quotes_survive_the_csv() -> None:
    row = claim(Paper.HEAT, 'eq. "1", (2)', "a, b", "x", "y", False, law=None, otherwise='because "it" is, so')
    assert next(iter(csv.DictReader(io.StringIO(as_csv([row])))))["reason"] == 'because "it" is, so'


def test_texts_of_a_row() -> None:
    row = number(Paper.LIFE, "table 1", "load", "kN", "13.5", 13.24, law=None, otherwise="2 % off")
    text = _words(_shown([row], 80))
    assert "printed 13.5 kN; computed 13.24 kN; deviation -1.9 %" in text
    # A unit stands with numbers alone.
    assert "curves" in _shown([not_possible(Paper.LIFE, "Fig. 1", "life", "rev", "curves", "none")], 120)
    assert "curves rev" not in _shown([not_possible(Paper.LIFE, "Fig. 1", "life", "rev", "curves", "none")], 120)


@pytest.mark.parametrize(
    ("deviation", "text"),
    [(None, ""), (0.0, "0 %"), (-1e-16, "0 %"), (-1e-4, "-0.01 %"), (0.0123, "+1.2 %"), (-0.5, "-50.0 %")],
)
def test_deviations_as_people_read_them(deviation: float | None, text: str) -> None:
    assert deviation_text(deviation) == text
