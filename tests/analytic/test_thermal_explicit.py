"""The compiled steps of the explicit scheme against sparse products; the bands that they read."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse

from feeddrive.compiler import compiled_library, find_compiler
from tests.heat_oracle.marching import (
    March,
    Progressing,
    Step,
    bands_of,
    compiled_march,
    interpreted_march,
    march_of,
)

RNG = np.random.default_rng(20240611)
NODES = 730
"""Not a multiple of the C's blocks."""


def _step() -> Step:
    """A step like those of the scheme: two bodies of different width, and a contact between them."""
    wide, narrow = np.ones(500), np.ones(230)
    body = [sparse.diags_array([v[1:], v[1:], v[40:], v[40:]], offsets=[1, -1, 40, -40]) for v in (wide, narrow)]
    inner = sparse.block_diag(body).tolil()
    inner[510:530, 200:220] = sparse.eye_array(20)
    inner = inner.tocsr()
    inner.data = RNG.uniform(0.05, 0.2, inner.nnz)
    inner = inner / np.asarray(inner.sum(axis=1)).ravel()[:, None] * 0.5
    leak = np.where(np.arange(NODES) > 600, 0.01, 0.0)
    return Step((sparse.csr_array(inner) + 0.49 * sparse.eye_array(NODES)).tocsr(), RNG.uniform(0, 1, NODES), leak, 0.3)


def _marched(march: March, count: int) -> tuple[Progressing, np.ndarray]:
    at, total = Progressing(np.linspace(0, 1, NODES)), np.zeros(NODES)
    march(0, count, at, total)
    march(1, 3, at, None)
    return at, total


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler on this computer: sparse products are all there is")
@pytest.mark.parametrize("count", [100, 101])
def test_compiled_steps_are_the_sparse_products(count: int) -> None:
    steps = [_step(), _step()]
    compiled = compiled_march(steps)
    assert compiled is not None
    (quick, quick_sum), (slow, slow_sum) = _marched(compiled, count), _marched(interpreted_march(steps), count)
    # A sum of some terms in another order, over a hundred contracting steps: rounding of 1e-16 each.
    np.testing.assert_allclose(quick.rises, slow.rises, rtol=1e-13)
    np.testing.assert_allclose(quick_sum, slow_sum, rtol=1e-13)
    assert quick.lost == pytest.approx(slow.lost, rel=1e-12)


def test_bands_make_up_the_matrix() -> None:
    matrix = _step().inner
    again = np.zeros(matrix.shape)
    for offset, first, values in bands_of(matrix):
        rows = np.arange(first, first + len(values))
        again[rows, rows + offset] += values
    np.testing.assert_array_equal(again, matrix.toarray())


def test_without_a_compiler_the_sparse_products_serve(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.heat_oracle.marching._library", lambda: None)
    at, _ = _marched(march_of([_step(), _step()]), 5)
    assert np.isfinite(at.rises).all()
    assert at.lost != 0


def test_source_that_does_not_compile_is_answered_with_none(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert compiled_library("this is no C") is None
