"""Memory that is left is there again without being cleared, where the C library is GNU's."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

FAULTS = """
import resource, sys
import numpy as np
from feeddrive.kept_memory import keep_freed_memory
if len(sys.argv) > 1:
    keep_freed_memory()
def filled():
    return [np.ones(100_000) for _ in range(5)]
filled()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(20):
    filled()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(
    not (sys.platform == "linux" and hasattr(ctypes.CDLL(None), "gnu_get_libc_version")), reason="not GNU's C library"
)
def test_pages_are_not_asked_for_again() -> None:
    kept = subprocess.run(
        [sys.executable, "-c", FAULTS, "kept"], capture_output=True, text=True, check=True, timeout=120
    )
    assert int(kept.stdout) < 1000  # 100 arrays of 200 pages each
