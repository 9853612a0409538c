"""A few dozen cases of every fuzz module; `python -m tests.fuzz --cases 2000 --seed N` runs many."""

from __future__ import annotations

import pytest

from tests.fuzz.harness import modules, run_cases, share_of

SEED, CASES = 7, 50  # with this seed sound input is among them


@pytest.mark.parametrize("name", [name for name in modules() if share_of(name) == 1.0])
def test_input_of_any_kind_ends_with_status_0_or_2(name: str) -> None:
    outcomes = list(run_cases(name, SEED, range(CASES)))
    assert [(one.number, one.what, one.fault, one.line[:300]) for one in outcomes if one.fault] == []
    # A module whose every input is refused at its first line, or taken whole, tries nothing.
    assert {one.status for one in outcomes} == {0, 2}


@pytest.mark.parametrize(("name", "seed", "number"), [("plants", 20261122, 1606)])
def test_cases_that_once_broke_the_promise_keep_it(name: str, seed: int, number: int) -> None:
    """Steps that are tried many at a time ran away, and their place on the screw was no number."""
    (outcome,) = run_cases(name, seed, [number])
    assert outcome.fault == ""
