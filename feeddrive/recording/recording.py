"""The time-series type that measurement and simulation share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from feeddrive.errors import InputError
from feeddrive.recording.channels import channel_unit
from feeddrive.recording.checks.flaws import Flaw
from feeddrive.typing import BoolArray, FloatArray


@dataclass(frozen=True, eq=False, repr=False)
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
        notes: what was found on reading: quantisation, saturation, separator, clock drift.
        flaws: samples that are not what the machine did; bad and held ones are filled, clipped ones are not.
        kept_apart: samples that are kept for judging, (n,), where a long recording was cut so; None where time tells.

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
    kept_apart: BoolArray | None = None

    def __post_init__(self) -> None:
        for channel, samples in self.channels.items():
            if samples.shape != self.time.shape or self.time.ndim != 1:
                shapes = f"shape {samples.shape}, the time {self.time.shape}"
                raise InputError(
                    f"channel {channel} has {shapes}", self.name, "give every channel one value per sample"
                )
        if not self.sample_time > 0.0:
            raise InputError(f"sample time {self.sample_time} s is not positive", self.name)

    @classmethod
    def from_arrays(cls, name: str = "arrays", **channels: ArrayLike) -> Recording:
        """A recording of arrays that are in memory.

        Args:
            name: what to call it.
            **channels: `time` [s] and canonical channels, each of shape (n,), SI: `motor_torque` [N m], `motor_angle`
                [rad], `table_position` [m], `setpoint` [m], ...

        Raises:
            InputError: no time, an unknown channel, lengths that differ, a value that is not finite, or time stamps
                that are not even and ascending.

        >>> import feeddrive as fd
        >>> fd.Recording.from_arrays(time=[0.0, 0.5, 1.0], motor_angle=[0.0, 0.1, 0.2])
        Recording 'arrays': 3 samples at 2 Hz, motor_angle
        """
        try:
            arrays = {key: np.asarray(values, dtype=np.float64) for key, values in channels.items()}
        except (TypeError, ValueError):
            raise InputError("a channel holds what are no real numbers", name, "give arrays of them, in SI") from None
        for key, values in arrays.items():
            if key != "time":
                channel_unit(key, name)
            if values.ndim != 1 or not np.isfinite(values).all():
                raise InputError(f"{key} is not one row of finite numbers", name, "give an array of shape (n,)")
        time = arrays.pop("time", np.zeros(0))
        if time.size < 2:
            raise InputError("there is no time", name, "give time=..., in seconds, at least two samples")
        sample_time = float(time[-1] - time[0]) / (time.size - 1)
        if not sample_time > 0 or np.max(np.abs(np.diff(time) - sample_time)) > 0.01 * sample_time:
            raise InputError("the time stamps are not even and ascending", name, "resample before")
        return cls(name, time, arrays, sample_time)

    def __repr__(self) -> str:
        """Name, samples, rate, channels."""
        return (
            f"Recording {self.name!r}: {len(self)} samples at {1 / self.sample_time:.6g} Hz, {', '.join(self.channels)}"
        )

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
        apart = None if self.kept_apart is None else self.kept_apart[first:last]
        return replace(self, time=self.time[first:last], channels=kept, flaws=flaws, kept_apart=apart)
