"""Errors: one line, printable and short, whatever a file holds."""

from __future__ import annotations

import pickle
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.errors import LONGEST_PART, LONGEST_QUOTE, InputError, printable, quoted


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("motor torque", "motor torque"),
        ("\x1b[31mred\x1b[0m", "\\x1b[31mred\\x1b[0m"),
        ("a\u202eb", "a\\u202eb"),
        ("\u2066x\u2069", "\\u2066x\\u2069"),
        ("zero\u200bwidth\ufeff", "zero\\u200bwidth\\ufeff"),
        ("\ud800", "\\ud800"),
        ("\U000e0041", "\\U000e0041"),
        ("\x9b31m", "\\x9b31m"),
        ("two\nlines", "two lines"),
        ("Vorschub µm °", "Vorschub µm °"),
    ],
)
def test_hidden_letters_are_shown(text: str, shown: str) -> None:
    assert printable(text) == shown
    assert quoted(text) == shown


@given(st.text(alphabet=st.characters(), max_size=900))
def test_any_text_becomes_one_short_printable_line(text: str) -> None:
    error = InputError(f'"{text}" is not a number', f"a.csv, row 3, {text}", text)
    for line in (str(error), quoted(text)):
        assert not {"Cc", "Cf", "Cs", "Zl", "Zp"} & {unicodedata.category(letter) for letter in line}
        line.encode("utf-8")
    assert len(quoted(text)) <= LONGEST_QUOTE
    assert len(str(error)) <= 3 * LONGEST_PART + 4


def test_long_quotes_are_cut_and_the_words_around_them_stay() -> None:
    error = InputError(f'"{"9" * 300_000}" is not a number', f"{'f' * 900}.csv, row 12", f'did you mean "{"m" * 900}"?')
    assert error.what.endswith('" is not a number')
    assert error.where.endswith(", row 12")
    assert error.mend.startswith('did you mean "m')
    assert len(str(error)) < 700


def test_short_errors_are_left_as_they_are() -> None:
    line = str(InputError('"1,5 mm" has a decimal comma', 'a.toml, "lead"', 'write a decimal point, e.g. "2.5 mm"'))
    assert line == 'a.toml, "lead": "1,5 mm" has a decimal comma; write a decimal point, e.g. "2.5 mm"'


@pytest.mark.parametrize(
    ("value", "shown"),
    [(3, "3"), (None, "None"), ([1, 2], "[1, 2]"), (16**9999, "too long")],
    ids=["3", "None", "list", "huge"],
)
def test_values_that_are_no_text(value: object, shown: str) -> None:
    assert shown in quoted(value)


def test_deep_nesting_is_not_followed() -> None:
    deep: list[object] = []
    for _ in range(100_000):
        deep = [deep]
    assert len(quoted(deep)) <= LONGEST_QUOTE


def test_an_error_survives_another_process() -> None:
    error = InputError("what\x1b", "where", "mend")
    assert str(pickle.loads(pickle.dumps(error))) == str(error) == "where: what\\x1b; mend"
