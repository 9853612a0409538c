"""A recording of temperatures and growth made ready for comparison: speed, surroundings, and which channels count.

The series are compared as they are, from zero to half the sample rate: what a screw does in minutes needs no filter. A
run starts cold at what its ambient channel says first.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from feeddrive.diagnosis.likelihood.evidence import Evidence
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.channels import channel_unit
from feeddrive.thermal.full.full_model import growth_name
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.run.warm_up import channel_of
from feeddrive.typing import BoolArray, FloatArray

SPEED, AMBIENT = "screw_speed", "ambient_temperature"

HEAT_BLOCK = 900.0
"""Length of a block of cross-validation [s]: some minutes' time constants of sensors and skin, short against a run."""

FEWEST_ROWS = 60
"""Rows from which an effect can be distinguished from noise at all."""

GAIN_ERROR = 1e-3
"""Standard deviation of what sensor and model miss in proportion to a rise: two careful models of one rig differ by
0.09 and 0.14 %, thermometers by as much. An effect that would only scale a channel by so little is lost in it."""

MODEL_ERROR = {"degC": 4e-3, "m": 1e-8}
"""What two careful models of one rig differ by beside a gain [K, m]: grids, rows, laws between their nodes. It is added
to the sensor noise as its square, and an effect must explain more than it."""

MODEL_SHARE = 4e-4
"""What two such models differ by, as a share of the rms of a rise, where it rises high."""

KINK = 4.5
"""Fourth differences beyond this multiple of their usual size are no noise; of white noise none of 10^5 is."""

SAME_SPEED = 0.005
"""Speeds within this share are one: a measured speed is never twice the same, and each costs a propagator."""


@dataclass(frozen=True, eq=False)
class HeatEvidence(Evidence):
    """A recording of temperatures and growth.

    Attributes:
        speed: of the screw over each row that is simulated, (k,) [rad/s].
        ambient: over the same rows, (k,) [degC].
        start_rows: 1 where the first row is the cold start itself, at time zero; 0 where it is the end of an interval.
    """

    speed: FloatArray
    ambient: FloatArray
    start_rows: int

    @property
    def motion_speed(self) -> FloatArray:
        """Speed of the screw [rad/s], (n,)."""
        return np.asarray(self.recording[SPEED], dtype=np.float64)

    def without_open(self, name: str, part: FloatArray, rows: BoolArray) -> FloatArray:
        """One channel over its noise, (k,), what lies along its own rise u discounted by the gain that is not known.

        Noise and gain have the covariance 1 + G^2 u u'; its inverse root leaves 1 / sqrt(1 + G^2 u'u) along u.
        """
        part = part / self.noise[name]
        rise = self.rise(name)[rows] / self.noise[name]
        square = float(rise @ rise)
        kept = 1 / np.sqrt(1 + GAIN_ERROR**2 * square)
        return part - (1 - kept) * float(rise @ part) / square * rise if square > 0 else part

    def missed(self, name: str) -> float:
        """Rms of what model and sensor may miss of a channel."""
        return float(np.hypot(self.model_error[name], GAIN_ERROR * np.sqrt(np.mean(self.rise(name) ** 2))))

    def rise(self, name: str) -> FloatArray:
        """A channel over its cold start, (n,): a temperature over the first of the surroundings, a growth as it is."""
        return _over_start(name, self.recording)


def prepare_heat(recording: Recording, heat: Heat, share: float) -> HeatEvidence:
    """Evidence of a recording, its first `share` fitted and the rest judged.

    Args:
        recording: with the speed of the screw, the surroundings, and a temperature or growth that the plant predicts.
        heat: whose sensors are predicted.
        share: 1 to fit on all of it, 0 to judge on all of it.

    Raises:
        InputError: too short, or channels that are needed are missing or unknown.
    """
    _refuse_missing(recording)
    names = _predicted(recording, heat)
    n, step = len(recording), recording.sample_time
    if n < FEWEST_ROWS:
        raise InputError(f"{n} rows are too few to compare", recording.name, f"record at least {FEWEST_ROWS}")
    first = 1 if abs(float(recording.time[0])) < 0.5 * step else 0
    time: FloatArray = np.arange(1, n + 1, dtype=np.float64) * step
    noise = plant_noise(heat)
    missed = {name: model_error_of(name, recording) for name in names}
    return HeatEvidence(
        recording,
        {name: recording[name] for name in names},
        {name: float(np.hypot(noise.get(name) or smooth_noise(recording[name]), missed[name])) for name in names},
        np.arange(n) >= first,
        fitted_rows(time, share),
        0.5 / step,
        max(HEAT_BLOCK, 10 * step),
        1,
        (),
        missed,
        same_speeds(np.abs(recording[SPEED]))[first:],
        recording[AMBIENT][first:],
        first,
    )


def model_error_of(name: str, recording: Recording) -> float:
    """What the model itself may miss of a channel beside a gain, rms [K, m]."""
    rise = _over_start(name, recording)
    return float(np.hypot(MODEL_ERROR[channel_unit(name, "")], MODEL_SHARE * np.sqrt(np.mean(rise**2))))


def _over_start(name: str, recording: Recording) -> FloatArray:
    cold = 0.0 if name.startswith("table_growth") else float(recording[AMBIENT][0])
    rise: FloatArray = recording[name] - cold
    return rise


def plant_noise(heat: Heat) -> dict[str, float]:
    """Channel to its declared noise; those without are left out."""
    return {sensor.channel: sensor.noise for sensor in heat.sensors if sensor.noise > 0}


def predicted_channels(heat: Heat) -> tuple[str, ...]:
    """Channels that a plant predicts: those of its sensors, or all under their default names."""
    if heat.sensors:
        return tuple(sensor.channel for sensor in heat.sensors)
    grown = [growth_name(x) for x in heat.rig.growth_positions]
    return tuple(channel_of(output) for output in ("nut", "front", "rear", "shaft_travel", *grown))


def smooth_noise(series: FloatArray) -> float:
    """Rms of the white part of a slow series, from its fourth differences without those at kinks of the speed."""
    differences = np.abs(np.diff(series, 4))
    usual = np.median(differences) / 0.6745  # a median alone would be as coarse as the resolution of the sensor
    kept = differences[differences <= KINK * usual]
    # 70 = 1 + 16 + 36 + 16 + 1, the power of the fourth difference of white noise
    return float(np.sqrt(np.mean(kept**2) / 70))


def same_speeds(speed: FloatArray) -> FloatArray:
    """Speeds (k,) [rad/s], those within half a per cent replaced by their mean."""
    moving = speed > 0
    keys = np.where(moving, np.round(np.log(np.where(moving, speed, 1.0)) / SAME_SPEED), -np.inf)
    _, which = np.unique(keys, return_inverse=True)
    return np.asarray((np.bincount(which, weights=speed) / np.bincount(which))[which])


def within_range(plant: Plant, evidence: Sequence[HeatEvidence]) -> tuple[Plant, tuple[str, ...]]:
    """The plant with its highest speed raised to the recordings', and a remark on it."""
    fastest, declared = max(float(one.speed.max()) for one in evidence), plant.heat.highest_speed
    if fastest <= declared * (1 + 1e-9):
        return plant, ()
    what = f"the screw turns at {fastest * 30 / np.pi:.0f} rev/min, declared are {declared * 30 / np.pi:.0f}"
    return replace(plant, network=replace(plant.heat, highest_speed=fastest)), (
        f"{what} at most: films and friction are extrapolated",
    )


def fitted_rows(time: FloatArray, share: float) -> BoolArray:
    """Rows that are fitted where the first `share` of a recording is, (n,)."""
    return time < share * time[-1] if share < 1 else np.ones(len(time), dtype=bool)


def _refuse_missing(recording: Recording) -> None:
    if SPEED not in recording:
        mend = f"record {SPEED} [rev/min], or name a plant with masses and drives for a recording of motion"
        raise InputError(f"no channel {SPEED}, and the plant declares heat alone", recording.name, mend)
    if AMBIENT not in recording:
        raise InputError(f"no channel {AMBIENT}", recording.name, "record the air's temperature at the machine")


def _slow(recording: Recording) -> list[str]:
    return [c for c in recording.channels if c.endswith("_temperature") or c.startswith("table_growth_")]


def _predicted(recording: Recording, heat: Heat) -> list[str]:
    """Channels that are compared; a name that only nearly is a sensor's is refused."""
    known = predicted_channels(heat)
    names = [name for name in known if name in recording]
    for channel in _slow(recording):
        if channel in known or channel == AMBIENT:
            continue
        near = difflib.get_close_matches(channel, [name for name in known if name not in recording], n=1, cutoff=0.8)
        if near or not names:
            mend = f'did you mean "{near[0]}"?' if near else f"its sensors are {', '.join(known)}"
            raise InputError(f"the plant has no sensor {channel}", recording.name, mend)
    if not names:
        raise InputError("no temperature or growth", recording.name, f"record one of {', '.join(known)}")
    return names


def left_out_channels(recording: Recording, heat: Heat) -> tuple[str, ...]:
    """Temperatures and growths of a recording that the plant does not predict."""
    known = (*predicted_channels(heat), AMBIENT)
    return tuple(channel for channel in _slow(recording) if channel not in known)
