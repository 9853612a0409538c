"""The list of claims: what it names exists, what is printed is what it says, a claim outside its bound is an error."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.claims import __main__ as command
from tests.claims import run
from tests.claims.book import CLAIMS, MEASURED, Claim, read_claims
from tests.claims.run import Outcome, targets_of
from tests.claims.table import INSIDE, OUTSIDE, SKIPPED, judged, page, table
from tests.state import ROOT


def test_page_is_written_from_the_list() -> None:
    # After a change of the list: python -m tests.claims page
    assert (ROOT / "docs" / "claims.md").read_text(encoding="utf-8") == page()


@pytest.mark.parametrize("target", targets_of(list(CLAIMS.values())))
def test_what_measures_a_claim_exists(target: str) -> None:
    path, _, name = target.partition("::")
    assert (ROOT / path).exists()
    if name:
        assert f"def {name.partition('[')[0]}(" in (ROOT / path).read_text(encoding="utf-8")


@pytest.mark.parametrize("claim", [claim for claim in CLAIMS.values() if claim.numeric], ids=lambda claim: claim.key)
def test_a_number_is_measured_where_it_is_said(claim: Claim) -> None:
    files = [ROOT / target.partition("::")[0] for target in claim.by]
    assert any(f'"{claim.key}"' in file.read_text(encoding="utf-8") for file in files), claim.key


@pytest.mark.parametrize("claim", [claim for claim in CLAIMS.values() if claim.printed], ids=lambda claim: claim.key)
def test_what_is_printed_is_the_bound(claim: Claim) -> None:
    for file, words in claim.printed:
        assert words in (ROOT / file).read_text(encoding="utf-8"), f"{file}: {words}"
        said = [float(number) for number in re.findall(r"\d+(?:\.\d+)?", words)]
        if claim.numeric and claim.key != "known.null":  # "nothing", in words
            bound = claim.at_most or claim.at_least or claim.value
            assert bound in said, f"{file}: {words}, and the bound is {claim.bound()}"


CLAIM = Claim("a", "a length", ("tests/x.py",), at_most=2.0, unit="m")


@pytest.mark.parametrize(
    ("claim", "inside", "outside", "words"),
    [
        (CLAIM, (2.0, -1.0), (2.0001, float("nan"), float("inf")), "at most 2 m"),
        (Claim("a", "", (), at_least=2.0), (2.0, 3.0), (1.9999, float("nan")), "at least 2"),
        (Claim("a", "", (), value=7.5, within=0.01, unit="µm"), (7.49, 7.51), (7.48, 7.52), "7.5 ± 0.01 µm"),
        (Claim("a", "", (), value=266.0, within=0.0), (266.0,), (265.0, 267.0), "266"),
        (Claim("a", "", ()), (), (), "holds"),
    ],
)
def test_bounds(claim: Claim, inside: tuple[float, ...], outside: tuple[float, ...], words: str) -> None:
    assert all(map(claim.inside, inside))
    assert not any(map(claim.inside, outside))
    assert claim.bound() == words


def outcome(ended: str = "passed", why: str = "", **measured: list[float]) -> dict[str, Outcome]:
    """What became of the test of `CLAIM`."""
    return {"tests/x.py": Outcome("tests/x.py", "s", ended, why, 1.0, measured)}


@pytest.mark.parametrize(
    ("found", "verdict", "why"),
    [
        (outcome(a=[1.0, 1.5]), INSIDE, ""),
        (outcome(a=[1.0, 2.5]), OUTSIDE, "outside"),
        (outcome(), OUTSIDE, "measures nothing"),
        (outcome("failed", "assert 3 < 2", a=[1.0]), OUTSIDE, "assert 3 < 2"),
        (outcome("skipped", "no data"), SKIPPED, "no data"),
    ],
)
def test_verdicts(found: dict[str, Outcome], verdict: str, why: str) -> None:
    assert judged(CLAIM, found)[1] == verdict
    assert why in judged(CLAIM, found)[2]
    text, outside = table([CLAIM], found)
    assert outside == (verdict == OUTSIDE)
    assert "at most 2 m" in text and verdict in text


def test_a_claim_without_a_number_holds_where_its_tests_pass() -> None:
    claim = Claim("b", "it runs", ("tests/x.py",))
    assert judged(claim, outcome())[:2] == ("passes", INSIDE)
    assert judged(claim, outcome("failed", "no"))[1] == OUTSIDE


def test_measured_values_are_kept_and_a_bound_missed_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "measured"
    monkeypatch.setenv(MEASURED, str(file))
    CLAIM.check(1.5)
    with pytest.raises(AssertionError, match=r"a: 2\.5 m, claimed is at most 2 m"):
        CLAIM.check(2.5)
    assert [json.loads(line)["measured"] for line in file.read_text().splitlines()] == [1.5, 2.5]


TESTS = {
    "test_good.py": 'from tests.claims.book import keep\ndef test_a() -> None:\n    keep("a", 1.5)\n',
    "test_bad.py": 'from tests.claims.book import keep\ndef test_a() -> None:\n    keep("a", 2.5)\n',
    "test_red.py": "def test_a() -> None:\n    assert 1 == 2\n",
    "test_not.py": 'import pytest\ndef test_a() -> None:\n    pytest.skip("no data here")\n',
}


@pytest.mark.parametrize(
    ("name", "status", "words"),
    [("test_good.py", 0, "1.5 m"), ("test_bad.py", 2, OUTSIDE), ("test_red.py", 2, "test_red.py::test_a"),
     ("test_not.py", 0, "no data here")],
)  # fmt: skip
def test_the_command_runs_the_tests_and_says_what_it_found(
    name: str, status: int, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    path = tmp_path / name
    path.write_text(TESTS[name], encoding="utf-8")
    claim = Claim("a", "a length", (str(path),), at_most=2.0, unit="m")
    monkeypatch.setattr(command, "CLAIMS", {"a": claim})
    monkeypatch.setattr(run, "state_of_the_tree", lambda: "s")
    for again in (False, True):
        assert command.main(["check", "--records", str(tmp_path / "kept"), "--workers", "1"]) == status
        said = capsys.readouterr().out
        assert words in said
        # What failed is run again, the rest is not.
        assert ("0 to be run" in said) == (again and name != "test_red.py")


@pytest.mark.parametrize(
    "text",
    [
        '[[claim]]\nkey = "a"\nsays = "x"\nby = []\nis = 1\n',
        '[[claim]]\nkey = "a"\nsays = "x"\nby = []\nis = 1\nwithin = 0\nat_most = 2\n',
        '[[claim]]\nkey = "a"\nsays = "x"\nby = []\nbound = 1\n',
        2 * '[[claim]]\nkey = "a"\nsays = "x"\nby = []\nat_most = 1\n',
    ],
)
def test_a_list_that_makes_no_sense_is_refused(text: str, tmp_path: Path) -> None:
    file = tmp_path / "claims.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match="a"):
        read_claims(file)
