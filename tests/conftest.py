"""What all tests share: one thread for linear algebra, fixed seeds, figures without a screen, the development data."""

from __future__ import annotations

import os

# Before numpy is imported: the linear algebra library reads them once. Inherited by the programs that tests start.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"
os.environ["MPLBACKEND"] = "Agg"
# What runs tests side by side names the width of its own terminal; tables are looked at as a pipe has them.
os.environ.pop("COLUMNS", None)

import random
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from feeddrive.compiler import find_compiler
from feeddrive.plant.structure import forget_machines

SEED = 20240131
"""Any number will do; it is fixed so that a failure comes again."""

# The same examples in every run, and no time limit for one: the cores are shared with other test processes.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")


@pytest.fixture(autouse=True)
def _fixed_seed() -> None:
    """Start the global generators at the same state in every test, in whatever order they run."""
    random.seed(SEED)
    np.random.seed(SEED)


@pytest.fixture
def generator() -> np.random.Generator:
    """Random numbers that are the same in every run."""
    return np.random.default_rng(SEED)


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the development data, which is not part of the project; skips the test where it is absent."""
    named = os.environ.get("FEEDDRIVE_DATA")
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(named) if named else beside
    if not folder.is_dir():
        place = f"FEEDDRIVE_DATA ({named})" if named else "../shared/data beside the checkout, nor FEEDDRIVE_DATA set"
        pytest.skip(f"no development data: no folder at {place}")
    return folder


@pytest.fixture
def without_compiler(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[], None]]:
    """A function from whose call on runs are interpreted; they are compiled again after the test."""

    def switch() -> None:
        monkeypatch.setenv("FEEDDRIVE_COMPILER", "none")
        find_compiler.cache_clear()
        forget_machines()

    yield switch
    monkeypatch.undo()
    find_compiler.cache_clear()
    forget_machines()
