"""The time-series type that measurement and simulation share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.recording.flaws import Flaw
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class Recording:
    """Evenly sampled channels of one run, SI units (temperatures in degC).

    Sample i: positions are read at time[i]; the torque acts from time[i] to time[i + 1].

    Attributes:
        name: file name, or what a person calls the run.
        time: time stamps, (n,) [s].
        channels: canonical name -> samples, (n,).
        sample_time: mean distance of the samples [s].
        source: where it was read from; empty if it was simulated.
        sha256: checksum of the file as it was read; empty if there is none.
        notes: what was found on reading and is said: quantisation, saturation, separator, clock drift.
        flaws: samples that are not what the machine did; bad and held ones are filled, clipped ones are not.

    Raises:
        InputError: a channel that is not as long as the time, or a sample time that is not positive.
    """

    name: str
    time: FloatArray
    channels: Mapping[str, FloatArray]
    sample_time: float
    source: str = ""
    sha256: str = ""
    notes: tuple[str, ...] = ()
    flaws: tuple[Flaw, ...] = ()

    def __post_init__(self) -> None:
        for channel, samples in self.channels.items():
            if samples.shape != self.time.shape or self.time.ndim != 1:
                shapes = f"shape {samples.shape}, the time {self.time.shape}"
                raise InputError(
                    f"channel {channel} has {shapes}", self.name, "give every channel one value per sample"
                )
        if not self.sample_time > 0.0:
            raise InputError(f"sample time {self.sample_time} s is not positive", self.name)

    def __getitem__(self, channel: str) -> FloatArray:
        """Return the samples of a channel, (n,).

        Raises:
            InputError: the recording has no such channel; names those it has.
        """
        if channel not in self.channels:
            mend = f"it has {', '.join(self.channels)}"
            raise InputError(f"no channel {channel}", self.name, mend)
        return self.channels[channel]

    def __contains__(self, channel: object) -> bool:
        return channel in self.channels

    def __len__(self) -> int:
        return int(self.time.size)

    @property
    def duration(self) -> float:
        """Time that the samples stand for, the last one with its sample time [s]."""
        return len(self) * self.sample_time

    def with_channels(self, channels: Mapping[str, FloatArray]) -> Recording:
        """Return a recording with these channels, (n,) each, added or put in place of those of the same name."""
        return replace(self, channels={**self.channels, **channels})

    def between(self, start: float, stop: float) -> Recording:
        """Return the samples with start <= time < stop [s]; time stamps stay as they are.

        Raises:
            InputError: no sample lies there.
        """
        first, last = np.searchsorted(self.time, (start, stop), side="left")
        if last <= first:
            span = f"{self.time[0]:g} s to {self.time[-1]:g} s" if len(self) else "no time at all"
            raise InputError(f"no sample from {start:g} s to {stop:g} s", self.name, f"it covers {span}")
        kept = {channel: samples[first:last] for channel, samples in self.channels.items()}
        flaws = tuple(part for part in (one.between(int(first), int(last)) for one in self.flaws) if part.rows.size)
        return replace(self, time=self.time[first:last], channels=kept, flaws=flaws)
