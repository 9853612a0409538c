"""Units are names, products and small exponents; whatever else is written is refused at once."""

from __future__ import annotations

import time

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from feeddrive.errors import InputError
from feeddrive.units.grammar import LONGEST, GrammarError, check_unit
from feeddrive.units.quantity import parse, unit_conversion

UNITS = [
    "m", "mm^2", "mm**2", "m^-1", "m^(-1)", "1/s", "N m/(rad/s)^(2/3)", "N m/W^0.5", "(m/min)/mm", "W/(m^2 K)",
    "kg*m^2", "(((s)))", "%", "°", "µm/(m K)", "m^+2",
]  # fmt: skip

NO_UNITS = [
    "", " ",
    "9**9**9 s", "kg*2**2**2**2**2**2",
    "s^7", "s^-7", "s^(13/2)", "s^(1/0)", "s^s", "s^^2", "s**", "**s", "s*/m", "s//m",
    "()",
    "(s", "s)", "2 m", "1e3 m", "1e-3", "0", "s+m", "s-m", "s,m", "s;m", "s.m", "s[0]", "s=m", "s:m", "'s'", "s@m", 
    "s%%2 + 1",
    "m\x00",
    "m\x1b[0m", "m\u202e",
    "lambda: s", "s!", "s^2^2", "s^(2^2)", "((((((s))))))", "s^0x2", "s^1e9", "s^9999", "m_s.x",
]  # fmt: skip


@pytest.mark.parametrize("text", UNITS)
def test_units_in_use_are_units(text: str) -> None:
    check_unit(text)


@pytest.mark.parametrize("text", NO_UNITS)
def test_all_else_is_none(text: str) -> None:
    with pytest.raises(GrammarError):
        check_unit(text)
    with pytest.raises(InputError):
        unit_conversion(text, "s", "a.csv")


def test_arithmetic_in_a_unit_is_never_evaluated() -> None:
    # Evaluated, the first alone would take hours and all of the memory.
    started = time.process_time()
    for text in (
        "9**9**9 s",
        "1 kg*2**2**2**2**2**2",
        "s*9**9**9",
        "s^(9**9**9)",
        "(" * 40 + "9^9^9" + ")" * 40,
        "9" * 80,
    ):
        with pytest.raises(InputError):
            unit_conversion(text, "s", "a.csv")
        with pytest.raises(InputError):
            parse(f"1 {text}", "kg", "a.toml")
    assert time.process_time() - started < 1.0  # loading pint is a tenth of it


@given(st.text(alphabet="mskgNrad19(^*/)-+. 23°µ²⁻%", max_size=LONGEST + 5))
@example("m" * 300_000)
@example("((m^6)^6)^6/((m^6)^6)^6 s")
@example("(((pm^6)^6)^6)^6/(((m^6)^6)^6)^6 s")
@example("(((Gm^6)^6)^6)^6/(((m^6)^6)^6)^6 s")
def test_any_text_of_units_is_converted_or_refused_at_once(text: str) -> None:
    started = time.process_time()
    try:
        conversion = unit_conversion(text, "s", "a.csv")
    except InputError as error:
        assert len(str(error)) < 400
    else:
        assert 0.0 < conversion.factor < float("inf")
    assert time.process_time() - started < 1.0  # milliseconds; the bound is there for a machine that is busy


@given(st.text(max_size=60))
def test_any_text_at_all_is_converted_or_refused(text: str) -> None:
    with pytest.raises(InputError):
        unit_conversion(text + " 2**2", "s", "a.csv")


@pytest.mark.parametrize("text", [16**9999, 10**400, "1e308 km", "-1e308 km"], ids=["hex", "1e400", "km", "-km"])
def test_a_quantity_beyond_the_largest_number_is_refused(text: object) -> None:
    with pytest.raises(InputError):
        parse(text, "m", "a.toml")
