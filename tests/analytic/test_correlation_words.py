"""What is said of two values that are known only together."""

from __future__ import annotations

import numpy as np

from feeddrive.diagnosis.certainty.correlation import _remarks


def test_values_of_unlike_units_have_no_difference() -> None:
    """A stiffness [N/m] less a position [m] is nothing: what a correlation tells is which way both may move."""
    names = ("position_spring.stiffness", "position_spring.zero")
    for rho, way in ((0.965, "rise together"), (-0.965, "rise and fall against each other")):
        (said,) = _remarks(names, np.array([[1.0, rho], [rho, 1.0]]))
        assert way in said and f"{rho:+.3f}" in said
        assert "difference" not in said and "sum" not in said
