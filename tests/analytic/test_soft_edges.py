"""Soft edges of a free play are drawn only where the nearest spring of two lines hardly carries within."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from feeddrive.diagnosis.likelihood.coordinates import LEAST
from tests.generator.axis import BENCH
from tests.generator.constants import Constants, declared_constants
from tests.generator.drawn_effects import SOFT_EDGES
from tests.generator.transmission import spring

STRETCHES = np.linspace(0.0, 2.0, 2001)
"""In widths: beyond one the two springs differ by less than a hundredth of the force there."""


def soft(constants: Constants, share: float) -> np.ndarray:
    """Return the generator's force over k w, width one, edges of a share of it."""
    c = constants._replace(gap=1.0, gap_softness=share)
    return np.array([spring(float(e), 0.0, c)[0] for e in STRETCHES]) / c.axial_stiffness


def nearest_ratio(force: np.ndarray) -> float:
    """Return the slope inside of the spring of two lines, of the same lost motion, that is nearest in force."""

    def missed(ratio: float) -> float:
        lines = np.maximum(ratio * STRETCHES, STRETCHES - 0.5)
        return float(np.sum((force - lines) ** 2))

    return float(minimize_scalar(missed, bounds=(0.0, 0.6), method="bounded").x)


def test_soft_edges_end_where_lost_preload_begins() -> None:
    """At the longest edges that are drawn the nearest ratio is the one at which the method ends free play."""
    c = declared_constants(BENCH)
    assert nearest_ratio(soft(c, SOFT_EDGES[1])) == pytest.approx(LEAST["preload_loss", "ratio"], abs=0.005)
    assert nearest_ratio(soft(c, SOFT_EDGES[0])) < 0.03


@pytest.mark.parametrize("share", [0.05, 0.14, 0.25, 0.4])
def test_what_the_middle_carries(share: float) -> None:
    """The slope at no force is 1 - 1 / hypot(1, 2 s)."""
    c = declared_constants(BENCH)._replace(gap=1.0, gap_softness=share)
    slope = spring(1e-6, 0.0, c)[0] / 1e-6 / c.axial_stiffness
    assert slope == pytest.approx(1 - 1 / np.hypot(1.0, 2 * share), rel=1e-6)
