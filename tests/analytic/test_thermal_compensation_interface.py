"""The public design of a thermal compensation: bodies, places, a trial, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import feeddrive as fd


@pytest.fixture(scope="module")
def design() -> fd.ThermalCompensation:
    axis = fd.load("thermal_bench").with_body(
        "housing", "front", capacity="1.5 kJ/K", conductance=3.0, to_air="0.4 W/K"
    )
    return fd.thermal_compensation(axis, sensors=1, heats={"housing": "5 W"})


def test_a_body_is_that_of_a_file(tmp_path: Path) -> None:
    axis = fd.load("thermal_bench").with_body("bed", "rear", capacity="60 kJ/K", conductance="0.2 W/K")
    (body,) = axis.heat.bodies
    assert (body.name, body.port, body.capacity, body.conductance, body.to_air) == ("bed", "rear", 60e3, 0.2, 0.0)
    assert fd.load(axis.save(tmp_path / "axis.toml")).heat.bodies == axis.heat.bodies
    with pytest.raises(fd.InputError, match="top"):
        axis.with_body("lid", "top", capacity="1 kJ/K", conductance="1 W/K")
    with pytest.raises(fd.InputError, match="declares no heat"):
        fd.load("bench_axis").with_body("bed", "rear", capacity="1 kJ/K", conductance="1 W/K")


def test_a_sensor_leaves_less_than_none_and_the_best_place_comes_first(design: fd.ThermalCompensation) -> None:
    assert [one.places for one in design.places[0]] == [()]
    spread = [one.rms for one in design.places[1]]
    assert spread == sorted(spread) and spread[0] < design.places[0][0].rms
    assert {one.places[0] for one in design.places[1]} == {"nut", "rear", "housing"}


def test_a_machine_as_declared_leaves_nothing_to_its_model(design: fd.ThermalCompensation) -> None:
    tried = design.on("750 rev/min", "1 h", "30 min")
    assert len(tried.machine.times) == 180 and tried.stop == 3600.0
    moving = tried.machine.speeds > 0
    assert moving[:120].all() and not moving[120:].any()
    # another mesh and a model of 16 states: below 0.1 um where the error is 20 um
    assert (
        tried.left["model alone, air recorded"].largest_after < 1e-7 < 1e-5 < tried.left["no compensation"].rms_before
    )
    hotter = design.on("750 rev/min", "1 h", "30 min", heat=1.2, undeclared={"housing": "5 W"})
    assert hotter.left["model alone, air recorded"].rms_factor < tried.left["model alone, air recorded"].rms_factor
    assert hotter.left["observer, 1 sensor"].rms_after < hotter.left["model alone, air recorded"].rms_after
    assert [one.title.split(": ")[1] for one in hotter.tables()] == [
        "heating by moving the axis", "places of the sensors", "error left over stroke and time",
    ]  # fmt: skip
    same = design.on("750 rev/min", "1 h", "30 min", heat=1.2, undeclared={"housing": "5 W"})
    assert all(np.array_equal(same.compensations[name], one) for name, one in hotter.compensations.items())


def test_what_cannot_be_tried_is_refused_with_the_remedy(design: fd.ThermalCompensation) -> None:
    with pytest.raises(fd.InputError, match="whole number of rows"):
        design.on("750 rev/min", "61.5 s")
    with pytest.raises(fd.InputError, match="write one of front, rear, housing"):
        design.on("750 rev/min", undeclared={"spindle": "5 W"})
    with pytest.raises(fd.InputError, match="write 1 to 3"):
        fd.thermal_compensation(fd.load("thermal_bench"), sensors=7)
    with pytest.raises(fd.InputError, match="declares no heat"):
        fd.thermal_compensation(fd.load("bench_axis"))
