"""Hertz's numbers as tabulated: Harris, Rolling Bearing Analysis (2001), table 6.1 (values quoted from memory)."""

from __future__ import annotations

import pytest

from feeddrive.parts.contact import ellipse_numbers

# F(rho), a*, b*, delta*
TABLE = [
    (0.1075, 1.0760, 0.9318, 0.9974),
    (0.3204, 1.2623, 0.8114, 0.9761),
    (0.4795, 1.4556, 0.7278, 0.9429),
    (0.5916, 1.6440, 0.6687, 0.9077),
    (0.6716, 1.8258, 0.6245, 0.8733),
    (0.7332, 2.011, 0.5881, 0.8394),
    (0.7948, 2.265, 0.5480, 0.7961),
    (0.83495, 2.494, 0.5186, 0.7602),
    (0.87366, 2.800, 0.4863, 0.7169),
    (0.90999, 3.233, 0.4499, 0.6636),
    (0.93657, 3.738, 0.4166, 0.6112),
    (0.95738, 4.395, 0.3830, 0.5551),
    (0.97290, 5.267, 0.3490, 0.4960),
    (0.983797, 6.448, 0.3150, 0.4352),
    (0.990902, 8.062, 0.2814, 0.3745),
    (0.995112, 10.222, 0.2497, 0.3176),
]


@pytest.mark.parametrize(("difference", "semi_major", "semi_minor", "approach"), TABLE)
def test_table(difference: float, semi_major: float, semi_minor: float, approach: float) -> None:
    found = ellipse_numbers((1.0 - difference, 1.0 + difference))
    # The printed F(rho) is rounded too: near 1 half a digit of it moves the ellipse by some 1e-4.
    assert found.semi_major == pytest.approx(semi_major, rel=6e-4)
    assert found.semi_minor == pytest.approx(semi_minor, rel=6e-4)
    assert found.approach == pytest.approx(approach, rel=6e-4)
