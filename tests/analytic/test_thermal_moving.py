"""The moving nut: ten states and the family over speed against the explicit scheme."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.full.full_model import discretise, model_of
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.full.moving import moving_system, ripple_number
from feeddrive.thermal.reduced.parametric_model import Path
from feeddrive.thermal.reduced.reduction import Sizes, compressed_basis
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Travel
from feeddrive.typing import FloatArray
from tests.analytic.thermal_cases import BENCH, RPM, bench_parts, conductances, nut_heat
from tests.heat_oracle.explicit import ExplicitRun, run_explicitly
from tests.heat_oracle.moving_family import moving_family
from tests.heat_oracle.reduction_error import reduced_system

WORKING = Sizes(heats=(("nut", 1.3), ("front", 1.0), ("rear", 0.17)))
"""Nut of a small axis, heat of the motor at the front end, of a bearing at the rear one [W]; 2 K of the air."""


def _at(run: ExplicitRun, system: HeatSystem, heat: float) -> FloatArray:
    """Outputs of a system at the oracle's times, (k, p)."""
    shown = system.step_response("nut", heat, 1080, 10.0)
    grid = np.arange(1081) * 10.0
    columns = [np.interp(run.times, grid, np.append(0.0, column)) for column in shown.T]
    return np.column_stack(columns)


def _against_the_oracle(
    speed: float, travel: Travel, cells: Cells, duration: float, share: float = 1.0
) -> dict[str, float]:
    """Largest errors of the averaged and of the order-10 moving model [K, µm]."""
    parts = discretise(replace(BENCH.rig, nut_heat_share=share), cells)
    g, heat, feed = conductances(speed), nut_heat(speed), BENCH.feed(speed * RPM)
    run = run_explicitly(parts, g, {"nut": heat}, feed, duration, travel=travel)
    assert run.imbalance < 1e-8
    full = model_of(parts, travel).at(g)
    moving = reduced_system(moving_system(parts, g, feed, compressed_basis(full, WORKING), travel), 10, WORKING)
    found = {}
    for label, system in (("averaged", full), ("moving", moving)):
        error = np.abs(_at(run, system, heat) - run.outputs).max(axis=0)
        found[f"{label} nut"] = float(error[full.row("nut")])
        found[f"{label} shaft"] = float(error[full.row("shaft_travel")])
        found[f"{label} growth"] = float(error[4:].max() * 1e6)
    return found


def test_ten_states_follow_the_moving_nut() -> None:
    found = _against_the_oracle(400, Travel(0.15, 0.35), Cells(100, 2, 20, 3), 3 * 3600.0)
    # Measured 0.0003 K before and 0.006 K after balancing to ten states for all inputs; the average's own is 0.038 K.
    assert found["moving nut"] < 0.01 < 0.03 < found["averaged nut"]
    assert found["moving shaft"] < 0.01
    assert found["moving growth"] < 0.05


def test_heat_on_the_shafts_side_moves_too() -> None:
    found = _against_the_oracle(300, Travel(0.15, 0.35), Cells(100, 2, 20, 3), 3600.0, share=0.0)
    assert found["moving nut"] < 0.01
    assert found["moving shaft"] < 0.01
    assert found["moving growth"] < 0.05


@pytest.mark.slow
@pytest.mark.parametrize("speed", [150, 400, 900])
@pytest.mark.parametrize("travel", [Travel(0.22, 0.28), Travel(0.15, 0.35), Travel(0.05, 0.45)])
def test_ten_states_follow_the_moving_nut_on_the_fine_grid(speed: float, travel: Travel) -> None:
    found = _against_the_oracle(speed, travel, Cells(200, 4, 40, 6), 3 * 3600.0)
    assert found["moving nut"] < 0.05
    assert found["moving shaft"] < 0.05
    assert found["moving growth"] < 0.3


def test_moving_system_is_symmetric_and_conducts_less() -> None:
    parts, g = bench_parts(), conductances(400)
    full = model_of(parts, BENCH.rig.travel).at(g)
    basis = compressed_basis(full)
    moving = moving_system(parts, g, BENCH.feed(400 * RPM), basis)
    averaged = basis.T @ (full.conductance @ basis)
    np.testing.assert_allclose(moving.conductance, moving.conductance.T, atol=1e-12)
    # The ripple only takes conductance away.
    assert np.linalg.eigvalsh(averaged - moving.conductance)[0] > -1e-9
    # A hundred times as fast with the same films, the average is all there is.
    fast = moving_system(parts, g, 100 * BENCH.feed(400 * RPM), basis)
    assert np.abs(fast.conductance - averaged).max() < 0.2 * np.abs(moving.conductance - averaged).max()


def test_family_follows_the_speed_between_those_it_was_made_at() -> None:
    cells = Cells(50, 2, 10, 3)
    family = moving_family(BENCH, np.array([100.0, 300.0, 900.0]) * RPM, cells=cells)
    parts = bench_parts(cells)
    g, feed = conductances(500), BENCH.feed(500 * RPM)
    basis = compressed_basis(model_of(parts, BENCH.rig.travel).at(g))
    exact = moving_system(parts, g, feed, basis)
    averaged = model_of(parts, BENCH.rig.travel).at(g)
    nut = exact.row("nut"), exact.column("nut")
    ripple = exact.gain()[nut] - averaged.gain()[nut]
    # Interpolated over the speed, with films that differ from those of the neighbours: a twentieth of the correction.
    assert family.at(g, feed).gain()[nut] == pytest.approx(exact.gain()[nut], abs=0.05 * ripple)
    assert family.at(g, 0.0).gain()[nut] == pytest.approx(averaged.gain()[nut], abs=0.05 * ripple)
    with pytest.warns(ValidityWarning, match="mm/s lies outside"):
        family.at(g, 2 * BENCH.feed(900 * RPM))
    with pytest.raises(InputError, match="do not ascend"):
        moving_family(BENCH, np.array([300.0, 100.0]) * RPM)


def test_moving_system_says_when_the_nut_is_too_slow() -> None:
    parts, g = bench_parts(), {**conductances(400), Path.CONTACT: 10_000.0}
    feed, travel = BENCH.feed(100 * RPM), Travel(0.15, 0.35)
    assert ripple_number(parts, g, feed, travel) > 1
    basis = compressed_basis(model_of(parts, travel).at(g))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            moving_system(parts, g, feed, basis, travel)
        except InputError as error:
            assert "too slow" in str(error)
    assert any(issubclass(one.category, ValidityWarning) for one in caught)
