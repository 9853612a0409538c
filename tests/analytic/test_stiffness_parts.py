"""Parts refuse impossible values, warn of unusual ones, and a slip of the unit is either."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.parts.bearings.supports import SupportBearing
from feeddrive.parts.coupling import Coupling, Transmission
from feeddrive.parts.motor import HoldingBrake, Motor
from feeddrive.parts.screw.ball_screw import STEEL, ScrewShaft, ShaftMaterial
from feeddrive.parts.screw.nut import Nut, stiffness_at_preload
from feeddrive.parts.screw.wedge import (
    self_locking,
    self_locking_lead,
    wedge_back_driving_efficiency,
    wedge_efficiency,
)

SLIPS: list[tuple[str, Callable[[], object]]] = [
    ("lead of 20 m", lambda: ScrewShaft(20.0, 0.04, 1.2)),
    ("diameter of 40 m", lambda: ScrewShaft(0.02, 40.0, 1.2)),
    ("length of 1200 m", lambda: ScrewShaft(0.02, 0.04, 1200.0)),
    ("stub of 106 m", lambda: ScrewShaft(0.02, 0.04, 1.2, stub=106.0)),
    ("root diameter above nominal", lambda: ScrewShaft(0.02, 0.04, 1.2, root_diameter=0.041)),
    ("nut of 1499 N/m", lambda: Nut(1499.0)),
    ("nut of 1499e6 N/µm", lambda: Nut(1499e12)),
    ("bearing of 780 N/m", lambda: SupportBearing(780.0)),
    ("no stiffness", lambda: Coupling(0.0)),
    ("negative inertia", lambda: Coupling(1e4, -1e-3)),
    ("inertia of 6000 kg m²", lambda: Motor(6000.0, 20.0)),
    ("not a number", lambda: Motor(math.nan, 20.0)),
    ("infinite brake", lambda: HoldingBrake(20.0, math.inf)),
    ("ratio of zero", lambda: Transmission(0.0, 1e4)),
    ("E of 210 GPa typed as 210", lambda: ShaftMaterial(210.0, 83e9, 7850.0, 1.2e-5)),
    ("accuracy factor above 1", lambda: stiffness_at_preload(1e9, 2000.0, 2000.0, 1.2)),
    ("friction of 3 %", lambda: wedge_efficiency(3.0, 0.02, 0.04)),
]

UNUSUAL: list[tuple[str, Callable[[], object]]] = [
    ("lead of 200 mm", lambda: ScrewShaft(0.2, 0.04, 1.2)),
    ("nut of 1.5 N/µm", lambda: Nut(1.499e6)),
    ("bearing of 78 000 N/µm", lambda: SupportBearing(7.8e10)),
    ("inertia of 30 kg m² for kg cm²", lambda: Coupling(27_000.0, 30.0)),
    ("density in g/cm³ times 100", lambda: ShaftMaterial(2.1e11, 8e10, 785.0, 1.2e-5)),
    ("shear modulus above E/2", lambda: ShaftMaterial(2.1e11, 1.2e11, 7850.0, 1.2e-5)),
]


@pytest.mark.parametrize("make", [make for _, make in SLIPS], ids=[name for name, _ in SLIPS])
def test_impossible_is_refused_in_one_line(make: Callable[[], object]) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.where and caught.value.mend
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("make", [make for _, make in UNUSUAL], ids=[name for name, _ in UNUSUAL])
def test_unusual_is_warned_of(make: Callable[[], object]) -> None:
    with pytest.warns(ValidityWarning):
        make()


def test_plausible_range_is_said() -> None:
    with pytest.raises(InputError, match=r"screw\.lead: 20 m is not possible; .* between 0\.1 mm and 500 mm"):
        ScrewShaft(20.0, 0.04, 1.2)
    with pytest.warns(ValidityWarning, match="1 mm to 80 mm is usual"):
        ScrewShaft(0.2, 0.04, 1.2)


def test_screw_is_a_cylinder() -> None:
    """Against the textbook numbers of a 32 mm steel rod: 6.31 kg/m and 8.08e-4 kg m²/m (half m r²)."""
    rod = ScrewShaft(0.01, 0.032, 1.0, stub=0.5)
    assert rod.mass_per_length == pytest.approx(6.3134, rel=1e-4)  # digits of the number beside it
    assert rod.inertia_per_length == pytest.approx(rod.mass_per_length * 0.016**2 / 2.0, rel=1e-12)
    assert rod.mass == pytest.approx(1.5 * rod.mass_per_length, rel=1e-12)
    assert rod.inertia == pytest.approx(1.5 * rod.inertia_per_length, rel=1e-12)
    assert rod.axial_stiffness(2.0) == pytest.approx(rod.axial_stiffness(1.0) / 2.0, rel=1e-12)
    assert math.isinf(rod.axial_stiffness(0.0)) and math.isinf(rod.torsional_stiffness(0.0))


def test_root_diameter_counts_for_stiffness_alone() -> None:
    solid, grooved = ScrewShaft(0.01, 0.04, 1.0), ScrewShaft(0.01, 0.04, 1.0, root_diameter=0.036)
    assert grooved.axial_rigidity == pytest.approx(solid.axial_rigidity * 0.9**2, rel=1e-12)
    assert grooved.torsional_rigidity == pytest.approx(solid.torsional_rigidity * 0.9**4, rel=1e-12)
    assert (grooved.mass, grooved.inertia) == (solid.mass, solid.inertia)


def test_steel_is_isotropic() -> None:
    """nu = E / 2 G - 1 of steel is 0.28 to 0.30."""
    assert 0.28 <= STEEL.young / (2.0 * STEEL.shear) - 1.0 <= 0.30


def test_preload_stiffens_with_its_cube_root() -> None:
    assert stiffness_at_preload(1e9, 1000.0, 8000.0, 0.5) == pytest.approx(1e9, rel=1e-12)


def test_wedge_without_friction_loses_nothing() -> None:
    assert wedge_efficiency(0.0, 0.02, 0.04) == 1.0
    assert wedge_back_driving_efficiency(0.0, 0.02, 0.04) == 1.0


def test_wedge_is_the_textbook_angle_sum() -> None:
    """eta = tan(beta) / tan(beta + rho), back tan(beta - rho) / tan(beta), with rho = atan(mu)."""
    beta, rho = math.atan(0.02 / (math.pi * 0.04)), math.atan(0.1)
    forward, back = math.tan(beta) / math.tan(beta + rho), math.tan(beta - rho) / math.tan(beta)
    assert wedge_efficiency(0.1, 0.02, 0.04) == pytest.approx(forward, rel=1e-12)
    assert wedge_back_driving_efficiency(0.1, 0.02, 0.04) == pytest.approx(back, rel=1e-12)


def test_wedge_locks_at_its_lead() -> None:
    lead = self_locking_lead(0.1, 0.04)
    assert self_locking(0.1, lead * (1 - 1e-9), 0.04)
    assert not self_locking(0.1, lead * (1 + 1e-9), 0.04)


def test_wedge_that_jams_moves_nothing() -> None:
    """A lead angle above 90 degrees less the friction angle: no torque moves it."""
    assert wedge_efficiency(0.5, 0.03, 0.004) == 0.0
