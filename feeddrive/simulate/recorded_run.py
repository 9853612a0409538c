"""A recorded run under a sampled controller, and a plant with other values: what a fit compares and moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled import SampledController
from feeddrive.simulate.controlled.controlled import TorqueLoop
from feeddrive.simulate.controlled.sensitivity import SERIES
from feeddrive.typing import FloatArray


@dataclass(frozen=True)
class RecordedRun:
    """A controlled run as it was recorded, from rest at 0.

    Attributes:
        controller: that ran.
        reference: what it was fed, shape (n, number of its references), SI.
        channels: recorded series by their names in `sensitivity.SERIES`, (n,) each, SI.
        noise: rms of each channel's white noise, SI.
        torque_loop: lag and dead time of the motor torque.
    """

    controller: SampledController
    reference: FloatArray
    channels: Mapping[str, FloatArray]
    noise: Mapping[str, float]
    torque_loop: TorqueLoop

    def __post_init__(self) -> None:
        for name, series in self.channels.items():
            if name not in SERIES or len(series) != len(self.reference) or not np.isfinite(series).all():
                raise InputError(f"channel {name!r} cannot be used", "recorded run", f"known are {', '.join(SERIES)}")
            if not self.noise.get(name, 0.0) > 0:
                raise InputError(f"no noise of {name!r}", "recorded run", "give its rms, above zero")


def with_values(plant: Plant, values: Mapping[str, float]) -> Plant:
    """The plant with other values, named `key` for the chain and `label.key` for effects.

    Raises:
        InputError: an unknown name, or a value outside its range.
    """
    chain = dict(plant.chain.values)
    effects = {effect.label: effect for effect in plant.effects}
    for name, value in values.items():
        label, _, key = name.rpartition(".")
        if not label and key in chain:
            chain[key] = value
        elif label in effects and key in effects[label].values:
            effects[label] = effects[label].with_values(**{key: value})
        else:
            raise InputError(f"unknown parameter {name!r}", plant.name, "name a value of the plant")
    changed = tuple(effects[effect.label] for effect in plant.effects)
    return replace(plant.with_chain_values(chain), effects=changed)
