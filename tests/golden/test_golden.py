"""What the program prints, beside what it printed when a person last looked: JSON that is reviewed as a difference.

It shows that something changed, not that it is right. After a change that is meant, regenerate and review each number:

    python -m tests.golden.regenerate
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from tests.claims.book import CLAIMS
from tests.golden.regenerate import OUTPUTS, shown

HERE = Path(__file__).resolve().parent

SAME = 1e-6
"""Relative difference that another machine's mathematical functions may make; files hold seven digits."""


@pytest.mark.parametrize("name", OUTPUTS)
def test_output_is_what_it_was(name: str) -> None:
    kept = json.loads((HERE / f"{name}.json").read_text(encoding="utf-8"))
    assert differences(kept, shown(name)) == []


def test_a_change_is_seen() -> None:
    assert differences({"a": [1.0, 2.0]}, {"a": [1.0, 2.0 + 1e-5]}) == ["a.1: 2.0 -> 2.00001"]
    assert differences({"a": "x"}, {"a": "y", "b": 1}) == ["a: 'x' -> 'y'", "b: None -> 1"]
    assert differences([1], [1, 2]) == ["1: None -> 2"]
    assert differences({"a": 1.0}, {"a": 1.0 + 1e-9}) == []


def test_counts_of_the_papers_are_those_that_are_claimed() -> None:
    summary = shown("reproduce")["summary"]
    CLAIMS["papers.rows"].check(sum(summary.values()))
    CLAIMS["papers.reproduced"].check(summary["reproduced"])


def differences(kept: Any, found: Any, place: str = "", near: float = 1e-12) -> list[str]:
    """Where two outputs differ, in words; `near` is what a number may differ by that is zero but for rounding."""
    if isinstance(kept, dict) and isinstance(found, dict):
        keys = dict.fromkeys((*kept, *found))
        return [
            line for key in keys for line in differences(kept.get(key), found.get(key), f"{place}.{key}".strip("."))
        ]
    if isinstance(kept, list) and isinstance(found, list):
        count = max(len(kept), len(found))
        # a component of an eigenvector that is none is rounding of its largest, times the spread of the eigenvalues
        near = 1e-9 * max((abs(one) for one in kept if isinstance(one, float)), default=0.0) + 1e-12
        pairs = ((kept[i] if i < len(kept) else None, found[i] if i < len(found) else None) for i in range(count))
        return [line for i, (a, b) in enumerate(pairs) for line in differences(a, b, f"{place}.{i}".strip("."), near)]
    if isinstance(kept, float) and isinstance(found, (int, float)):
        same = math.isclose(kept, found, rel_tol=SAME, abs_tol=near)
    else:
        same = kept == found
    return [] if same else [f"{place}: {kept!r} -> {found!r}"]
