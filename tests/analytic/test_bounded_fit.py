"""Steps of a fit stay inside what is physical, solve what is left, and survive columns that no number can hold."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from feeddrive.diagnosis.likelihood import fit as fitting
from feeddrive.diagnosis.likelihood.coordinates import (
    absent_coordinates,
    coordinate_ends,
    coordinates_of,
    read_coordinates,
    write_coordinates,
)
from feeddrive.diagnosis.likelihood.fit import fit, inside_step, linear_step
from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS
from feeddrive.effects.chain.inertia_deviation import InertiaDeviation
from feeddrive.effects.chain.payload import Payload
from feeddrive.effects.source.constant_force import ConstantForce
from feeddrive.effects.timing.drive_delay import DriveDelay
from feeddrive.files import plants_folder
from feeddrive.plant.file.plant_file import read_plant
from tests.analytic.test_effects import NEUTRAL, PLACES
from tests.analytic.test_thermal_effects import NEUTRAL as THERMAL_NEUTRAL

BENCH = read_plant(plants_folder() / "bench_axis.toml")


@pytest.mark.parametrize("seed", range(8))
def test_step_inside_bounds_is_the_least_square(seed: int) -> None:
    random = np.random.default_rng(seed)
    # columns that hardly overlap: there, fixing what leaves its range one after the other is exact
    jacobian, _ = np.linalg.qr(random.standard_normal((60, 5)))
    jacobian = jacobian * random.uniform(0.1, 1e4, 5)
    residual = random.standard_normal(60)
    high = random.uniform(0.0, 1.0, 5) / np.linalg.norm(jacobian, axis=0)
    step = inside_step(jacobian, residual, 0.0, -high, high)
    wanted = lsq_linear(jacobian, residual, (-high, high), method="bvls").x
    np.testing.assert_allclose(step, wanted, rtol=1e-6, atol=1e-9 * np.abs(high).max())


@pytest.mark.parametrize("bad", [0.0, np.inf, np.nan, 1e200])
def test_columns_that_no_number_can_hold_do_not_move(bad: float) -> None:
    random = np.random.default_rng(3)
    jacobian, residual = random.standard_normal((40, 3)), random.standard_normal(40)
    good = np.linalg.lstsq(jacobian[:, [0, 2]], residual, rcond=None)[0]
    jacobian[5 if np.isfinite(bad) else slice(None), 1] = bad
    if bad == 0.0:
        jacobian[:, 1] = 0.0
    free = np.full(3, np.inf)
    for step in (inside_step(jacobian, residual, 0.0, -free, free), linear_step(jacobian, residual)):
        assert np.all(np.isfinite(step))
        if bad != 1e200:
            np.testing.assert_allclose(step[[0, 2]], good, rtol=1e-9)
            assert step[1] == 0.0
    assert not linear_step(jacobian, np.full(40, np.nan)).any()


def test_masses_inertias_and_delays_keep_their_sign() -> None:
    effects: list[Effect] = [
        Payload.of(mass=0.0), InertiaDeviation.of(None, "motor", inertia=0.0),
        InertiaDeviation.of(None, "screw", inertia=0.0), DriveDelay.of(delay=1e-4),
    ]  # fmt: skip
    far = write_coordinates(effects, BENCH, np.full(4, -1e9))
    plant = BENCH.with_effects(*far).chain_values()
    for key in ("table_mass", "motor_inertia", "screw_inertia"):
        # a twentieth of what is declared is left, as of a stiffness
        assert plant[key] == pytest.approx(0.05 * BENCH.chain.values[key])
    assert far[3].values["delay"] == 0.0


@pytest.mark.parametrize("name", {**EFFECTS, **THERMAL_EFFECTS})
def test_absent_coordinates_are_those_of_the_neutral_values(name: str) -> None:
    """Where the prior draws an effect, it is not there."""
    neutral = {**NEUTRAL, **THERMAL_NEUTRAL}
    if name in ("presliding", "structural_mode", "sensor_lag", "heat_sink"):
        return  # no neutral value, without mass, or known to a factor: see the next test
    kind = {**EFFECTS, **THERMAL_EFFECTS}[name]
    place = PLACES.get(name, "nut" if kind.place_key and name not in EFFECTS else "")
    place = place if not kind.places or place in kind.places else kind.places[0]
    effect = kind.of(place=place, **neutral[name])
    if not coordinates_of(effect, BENCH) or (kind.__name__.startswith(("Guide", "Nut", "Bearing")) and name in EFFECTS):
        return  # declared laws are not fitted
    absent, _ = absent_coordinates([effect], BENCH)
    low, high = coordinate_ends([effect], BENCH)
    at = read_coordinates([effect], BENCH)
    sized = ~np.isnan(absent)
    np.testing.assert_allclose(at[sized], absent[sized], atol=1e-12)
    assert np.all(low <= high)


def test_size_known_to_a_factor_is_one_step_from_none() -> None:
    lag = THERMAL_EFFECTS["sensor_lag"].of(place="nut_temperature", time_constant=40.0)
    absent, _ = absent_coordinates([lag], BENCH)
    assert absent[0] == pytest.approx(np.log(40.0) - 1.0)
    bristle = EFFECTS["presliding"].of(stiffness=5e6)
    absent, _ = absent_coordinates([bristle], BENCH)
    # the softer the bristle, the more it does
    assert absent[0] == pytest.approx(np.log(5e6) + 1.0)
    assert np.isnan(absent[1:]).all()


def test_spring_far_from_its_zero_is_fitted_by_its_force() -> None:
    """A spring whose zero is far off is a force that changes a little, and is fitted as straight as one."""
    spring = EFFECTS["position_spring"].of(stiffness=29.0, zero=BENCH.middle - 19.0)
    at = read_coordinates([spring], BENCH)
    force = float(EFFECTS["constant_force"].parameter("force").size)
    assert at[1] == pytest.approx(29.0 * 19.0 / force)
    # half the stiffness at the same force in the middle of the stroke, and half the force of the same spring
    softer, nearer = (write_coordinates([spring], BENCH, at * factor)[0].values for factor in ([0.5, 1.0], [1.0, 0.5]))
    assert softer == pytest.approx({"stiffness": 14.5, "zero": BENCH.middle - 38.0})
    assert nearer == pytest.approx({"stiffness": 29.0, "zero": BENCH.middle - 9.5})


@pytest.mark.parametrize("told", [0.5, 0.2, 0.1])
def test_a_step_that_leads_eighty_times_too_far_is_shortened_until_it_comes_nearer(
    told: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a law whose first slope is of its size as a whole, while a small one of it is what the data hold."""
    column = np.random.default_rng(4).standard_normal(200)
    column /= np.linalg.norm(column)
    size = ConstantForce.parameter("force").size

    def made(force: float) -> np.ndarray:
        return np.asarray(column * (force + 100.0 * np.tanh(force / told) * abs(force)))

    def force_of(effects: Sequence[Effect]) -> float:
        return float(effects[0].values["force"])  # type: ignore[arg-type]

    problem = SimpleNamespace(
        plant=BENCH,
        measured=made(told),
        predicted=lambda effects: made(force_of(effects)),
        possible=lambda effects: True,
        budget=SimpleNamespace(is_spent=False),
    )

    def jacobian(_: object, effects: Sequence[Effect], *__: object) -> np.ndarray:
        force = force_of(effects)
        return size * ((made(force + 1e-6) - made(force - 1e-6)) / 2e-6)[:, None]

    monkeypatch.setattr(fitting, "jacobian_of", jacobian)
    found = fit(problem, [ConstantForce.of(force=0.0)])  # type: ignore[arg-type]
    assert force_of(found.effects) == pytest.approx(told, rel=0.02)  # ENOUGH: a hundredth of the first error
