"""When the torque of a sample acts: a drive delay d = k T + f, T the sample time, in whole samples and the rest.

The torque of k + 1 samples ago acts for the first f of a sample, and that of k samples ago for the rest; the sample is
split there, so that the shifted torque is exact.

| symbol | meaning | unit |
|---|---|---|
| T, d | sample time, delay of the drive | s |
| k, f | whole samples in d, and what is left | 1, s |
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

from feeddrive.effects.base import TimingEffect
from feeddrive.errors import ValidityWarning
from feeddrive.plant.plant import Plant
from feeddrive.servo.sampled_plant import whole_and_rest


@dataclass(frozen=True)
class Timing:
    """How the held torque meets the samples; `late` and the number of parts change the equations, the rest is a value.

    Attributes:
        late: whole samples of delay.
        fraction: the rest of the delay, as part of a sample; 0 where there is none.
    """

    late: int
    fraction: float

    @property
    def parts(self) -> tuple[float, ...]:
        """Parts of a sample with one torque each."""
        return (self.fraction, 1 - self.fraction) if self.fraction else (1.0,)

    @property
    def past(self) -> int:
        """Torques of earlier samples that may still act."""
        return self.late + len(self.parts) - 1


def timing_of(plant: Plant, sample: float, dead_time: float = 0.0) -> Timing:
    """Delay of the plant's drive, and a dead time [s] beyond it, in samples of `sample` [s].

    A negative one warns and counts as none.
    """
    effects = [effect for effect in plant.effects if isinstance(effect, TimingEffect)]
    delay = dead_time + float(sum(effect.delay(effect.values) for effect in effects))
    if delay < 0:
        text = f"{plant.name}: torque cannot act before its command; the drive delay of {delay:g} s is taken as 0"
        warnings.warn(text, ValidityWarning, stacklevel=4)
        delay = 0.0
    return Timing(*whole_and_rest(delay / sample))
