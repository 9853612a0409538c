"""Linear algebra has one thread where results depend on its sums, and as many as before afterwards."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest

from feeddrive import blas_threads
from feeddrive.blas_threads import one_thread

COUNTS = """
import numpy, scipy.linalg
from feeddrive.blas_threads import _libraries, one_thread
counts = lambda: [get() for get, _ in _libraries()]
before = counts()
with one_thread():
    within = counts()
print(before, within, counts())
"""

CALLED = """
import sys
from feeddrive.cli.main import main
assert "numpy" not in sys.modules
main(["list"])
import numpy
from feeddrive.blas_threads import _libraries
print([get() for get, _ in _libraries()])
"""


def threads(program: str) -> str:
    """Last line of a program started with two threads for linear algebra."""
    environment = {**os.environ, **dict.fromkeys(blas_threads.VARIABLES, "2")}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True, timeout=120
    )
    return done.stdout.splitlines()[-1]


@pytest.fixture(autouse=True)
def _bundled() -> None:
    if len(blas_threads._libraries()) < 2:
        pytest.skip("numpy or scipy come without an OpenBLAS of their own here")
    if (os.cpu_count() or 1) < 2:
        pytest.skip("one processor: there is never more than one thread")


def test_one_thread_within_and_as_many_as_before_after() -> None:
    assert threads(COUNTS) == "[2, 2] [1, 1] [2, 2]"


def test_the_command_line_has_one_thread_whatever_the_environment_says() -> None:
    assert threads(CALLED) == "[1, 1]"


def test_the_last_of_two_at_once_gives_the_threads_back() -> None:
    """Whoever ends first must not give the other several threads again."""
    libraries = blas_threads._libraries()
    before = [get() for get, _ in libraries]
    both_in, one_out = Barrier(2), Barrier(2)

    def work(first: bool) -> list[int]:
        with one_thread():
            both_in.wait(10.0)
            if not first:
                one_out.wait(10.0)
                return [get() for get, _ in libraries]
        one_out.wait(10.0)
        return []

    try:
        for _, put in libraries:
            put(2)
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(work, (True, False)))
        assert found == [[], [1, 1]]
        assert [get() for get, _ in libraries] == [2, 2]
    finally:
        for (_, put), count in zip(libraries, before, strict=True):
            put(count)
