"""The study of a warm-up: its energy, its warm-up time, its time constants against other ways to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from feeddrive.thermal.full.full_model import NUT
from feeddrive.thermal.reduced.parametric_model import AMBIENT, Path
from feeddrive.thermal.rig import Body
from feeddrive.thermal.run.duty import Duty, constant_duty
from feeddrive.thermal.run.energy_balance import with_ledger
from feeddrive.thermal.run.study import study
from feeddrive.thermal.run.warm_up import Rows, run
from tests.analytic.thermal_cases import BENCH, QUICK, RPM

PLANT = replace(BENCH, cells=QUICK)


def test_warm_up_time_is_that_of_a_long_run() -> None:
    short = study(PLANT, constant_duty(750 * RPM, 1800.0, 23.0), within=1e-6)
    long = study(PLANT, constant_duty(750 * RPM, 12 * 3600.0, 23.0), within=1e-6)
    name = "growth_300mm"
    expected = short.warm_up[name]
    values, times = long.series[f"table_{name}"], long.duty.times
    assert expected.final == pytest.approx(values[-1], abs=1e-9)
    outside = np.abs(values - values[-1]) > 1e-6
    # A row of the long run is 30 s; the modes are those of the compressed system, some nm off.
    assert expected.time == pytest.approx(times[np.flatnonzero(outside)[-1]], abs=45)
    assert expected.time > short.duty.duration
    risen = times[np.flatnonzero(values >= (1 - np.exp(-1)) * values[-1])[0]]
    assert expected.rise_time == pytest.approx(risen, abs=45)


def test_shares_of_the_modes_add_up() -> None:
    found = study(PLANT, constant_duty(500 * RPM, 600.0, 23.0))
    for name in (NUT, "growth_200mm"):
        # Six of some twenty modes; the others carry less than a per cent together.
        assert sum(one.shares[name] for one in found.constants) == pytest.approx(1, abs=0.01)
    slowest = -1 / PLANT.full_model().at(found.conductances).poles(1)[0]
    assert found.constants[0].value == pytest.approx(slowest, rel=1e-3)


@pytest.mark.parametrize("bodies", [(), (Body("motor", "front", 900.0, 0.5, 0.2),)])
def test_energy_closes_under_changing_duty_and_air(bodies: tuple[Body, ...]) -> None:
    count = 200
    speeds = 600 * RPM * np.abs(np.sin(np.arange(count) / 9.0))
    duty = Duty(60.0, speeds, 23 + 3 * np.sin(np.arange(count) / 30.0))
    found = study(replace(PLANT, bodies=bodies), duty)
    assert found.energy.imbalance < 1e-9  # rounding alone: both sides are stepped by one scheme
    assert found.energy.heat_in > 1e4
    assert found.energy.stored > 0


def test_ledger_counts_what_the_film_takes() -> None:
    """Beside the sum over the rows of conductance times rise, on a fine grid of time."""
    model = with_ledger(PLANT.full_model())
    g = {path: np.full(400, value) for path, value in PLANT.at_speed(500 * RPM).items()}
    rows = Rows(10.0, g, {NUT: np.full(400, 3.0), AMBIENT: np.full(400, 0.5)})
    states = run(model, rows, substeps=4)
    lost = np.zeros(400)
    for path in (Path.SCREW_FILM, Path.NUT_FILM):
        facing = model.ways[path].facing[:-1]
        lost += g[path][0] * ((states[:, :-1] - 0.5) @ facing)
    # Trapezoids of 10 s over time constants of minutes; the first row starts at zero rise.
    first = -0.5 * sum(g[path][0] * model.ways[path].facing[:-1].sum() for path in (Path.SCREW_FILM, Path.NUT_FILM))
    summed = 10.0 * (np.sum(lost) - lost[-1] / 2 + first / 2)
    assert states[-1, -1] == pytest.approx(summed, rel=2e-4)
