"""A plant simulated under the controller that it declares, at the samples of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from feeddrive.plant.plant import Plant
from feeddrive.simulate.controlled.controlled import ControlledRun
from feeddrive.simulate.controlled.declared_loop import declared_loop
from feeddrive.typing import FloatArray

NOTHING: Mapping[str, FloatArray] = MappingProxyType({})


def declared_run(
    plant: Plant,
    time: FloatArray,
    setpoint: FloatArray,
    position: float,
    injected: Mapping[str, FloatArray] = NOTHING,
) -> tuple[ControlledRun, slice]:
    """The run from rest at `position` [m], and which of its ticks are samples."""
    loop = declared_loop(plant, float(time[1] - time[0]))
    assert loop is not None
    run = loop.simulated(plant, loop.reference(setpoint, injected), position)
    return run, slice(None, None, loop.ticks)
