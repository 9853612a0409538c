"""The four kinds of screw support: symmetry, limits, which is stiffer, refusals."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.bearings.supports import ScrewSupports, Support, SupportBearing
from feeddrive.parts.screw.ball_screw import ScrewShaft
from tests.analytic.stiffness_cases import bearings, supports

SCREW = ScrewShaft(lead=0.01, diameter=0.032, length=1.5)
ROUNDING = 1e-12
"""Relative; a handful of operations in double precision."""
positions = st.floats(0.0, SCREW.length)


def _stiffness(kind: Support, near: SupportBearing, far: SupportBearing, position: float) -> float:
    held = ScrewSupports(kind, near, far if kind.far_end_takes_force else None)
    return held.axial_stiffness(SCREW, position)


@given(bearings, bearings, positions)
@pytest.mark.parametrize("kind", [Support.FIXED_FIXED, Support.SUPPORTED_SUPPORTED])
def test_turning_the_screw_round_changes_nothing(
    kind: Support, near: SupportBearing, far: SupportBearing, position: float
) -> None:
    turned = _stiffness(kind, far, near, SCREW.length - position)
    assert _stiffness(kind, near, far, position) == pytest.approx(turned, rel=ROUNDING)


@given(bearings, bearings, positions)
def test_order_of_the_four_kinds(near: SupportBearing, far: SupportBearing, position: float) -> None:
    """Both ends together are the stiffest; one end at a time, in its softer direction, is the softest."""
    one_end = _stiffness(Support.FIXED_SUPPORTED, near, far, position)
    assert _stiffness(Support.FIXED_FREE, near, far, position) == one_end
    assert _stiffness(Support.FIXED_FIXED, near, far, position) >= one_end * (1 - ROUNDING)
    assert _stiffness(Support.SUPPORTED_SUPPORTED, near, far, position) <= one_end * (1 + ROUNDING)


def test_rigid_bearings_give_the_catalogues_formulas() -> None:
    """E A / x, and E A l / (x (l - x)) with its least value 4 E A / l in the middle."""
    with pytest.warns(ValidityWarning, match="unusual"):
        rigid = SupportBearing(9.9e10)
    tolerance = 5e-3  # E A / x of this screw is 4.1e8 N/m, 0.42 % of the bearing's
    x, length = 0.4, SCREW.length
    one_end = _stiffness(Support.FIXED_SUPPORTED, rigid, rigid, x)
    assert one_end == pytest.approx(SCREW.axial_rigidity / x, rel=tolerance)
    both = _stiffness(Support.FIXED_FIXED, rigid, rigid, x)
    assert both == pytest.approx(SCREW.axial_rigidity * length / (x * (length - x)), rel=2 * tolerance)
    middle = _stiffness(Support.FIXED_FIXED, rigid, rigid, length / 2)
    assert middle == pytest.approx(4 * SCREW.axial_rigidity / length, rel=2 * tolerance)


@given(supports(), positions)
def test_parts_add_up_and_shares_too(held: ScrewSupports, position: float) -> None:
    """Strain energies of the parts are those of the branches in parallel: checked by the work of the force."""
    near, far = held.load_shares(SCREW, position)
    assert near + far == pytest.approx(1.0, rel=ROUNDING)
    displacement = 1.0 / held.axial_stiffness(SCREW, position)
    if near > 0.0:
        branch = 1.0 / held.near.axial_stiffness + position / SCREW.axial_rigidity
        assert displacement == pytest.approx(near * branch, rel=1e-10)
    if held.far is not None and far > 0.0:
        branch = 1.0 / held.far.axial_stiffness + (SCREW.length - position) / SCREW.axial_rigidity
        assert displacement == pytest.approx(far * branch, rel=1e-10)


@given(bearings, bearings)
def test_at_the_bearing_a_single_end_is_the_bearing(near: SupportBearing, far: SupportBearing) -> None:
    stiffness = _stiffness(Support.FIXED_SUPPORTED, near, far, 0.0)
    assert stiffness == pytest.approx(near.axial_stiffness, rel=ROUNDING)


def test_what_is_refused() -> None:
    bearing = SupportBearing(5e8)
    with pytest.raises(InputError, match="needs a bearing at the far end"):
        ScrewSupports(Support.FIXED_FIXED, bearing)
    with pytest.raises(InputError, match="takes no axial force"):
        ScrewSupports(Support.FIXED_FREE, bearing, bearing)
    with pytest.raises(InputError, match=r"1600 mm is not on the screw; choose 0 to 1500 mm"):
        ScrewSupports(Support.FIXED_FREE, bearing).axial_stiffness(SCREW, 1.6)
