"""Functions that the compiled loop has in the place of the C library's: the same numbers, to rounding."""

from __future__ import annotations

import ctypes
import math
from pathlib import Path

import numpy as np
import pytest

from feeddrive.compiler import compiled_library, find_compiler
from feeddrive.engine import compiled

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="no C compiler here")

UNIT = 2.0**-52


def function(name: str) -> ctypes._NamedFuncPointer:
    text = (Path(compiled.__file__).parent / "driver_math.c").read_text(encoding="utf-8")
    library = compiled_library(text + f"\ndouble asked(double x) {{ return {name}(x); }}\n", compiled.FLAGS)
    assert library is not None
    library.asked.argtypes, library.asked.restype = [ctypes.c_double], ctypes.c_double
    return library.asked


def test_tanh_is_that_of_the_c_library_within_its_digits():
    sizes = np.concatenate([np.geomspace(1e-12, 700.0, 5000), np.linspace(0.1249, 0.1251, 200), [20.0, 20.0 + 1e-12]])
    asked = function("tanh")
    for sign in (1.0, -1.0):
        found = np.array([asked(sign * x) for x in sizes])
        # four units in the last place: exp, a sum, a difference and a quotient round once each
        assert np.max(np.abs(found / np.tanh(sign * sizes) - 1.0)) <= 4 * UNIT


def test_tanh_at_its_ends_and_of_no_number():
    asked = function("tanh")
    assert (asked(0.0), asked(np.inf), asked(-np.inf)) == (0.0, 1.0, -1.0)
    assert np.isnan(asked(np.nan))


def test_exp_of_what_is_too_small_is_zero_and_all_else_is_the_c_library():
    asked = function("exp")
    assert asked(-746.5) == 0.0
    assert [asked(x) for x in (-745.0, -1.0, 0.5, 700.0)] == [math.exp(x) for x in (-745.0, -1.0, 0.5, 700.0)]
    assert np.isnan(asked(np.nan))
