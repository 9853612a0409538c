"""Recordings with fewer rows than the drive has cycles: what their torque is, and where the motion is known.

A drive holds its torque for one cycle, so that a recording with one row a cycle tells all of it. Where rows are further
apart, a row is the torque of that instant, held for the cycle that begins there (`suspicion.logged.declared_hold`), and
between two rows the motor may have done anything. Where it was smooth, differences of its angle are small:

    delta a = |D4 theta| / (12 h^2) or |D6 theta| / (30 h^2),    delta T = J delta a,    delta x = s delta a

| symbol | meaning | unit |
|---|---|---|
| D4, D6 | fourth difference of rows slower than any cycle, sixth of faster ones | 1 |
| theta | motor angle at the rows | rad |
| h | time between rows | s |
| delta a | error of the acceleration | rad/s^2 |
| delta T, delta x | what it misses of the torque, of the table position | N m, m |
| J | inertia of all that moves, at the motor | kg m^2 |
| s | how far the table stays behind per acceleration (`feeddrive.plant.analysis.modes`) | m s^2/rad |

The fourth difference tells the error of the second one; a ripple of 80 Hz at rows of 2 ms misses 34 times less by the
quintic spline. The spline's second derivative of exp(i u n), at a row, is off by u^6 / 720 for small u and, from the
symbol of quintic B-splines, by less than (2 sin(u / 2))^6 / 90 up to u = 2.27, 0.72 of half the rate. A jump of the
acceleration leaves 1 / 30 of its sixth difference in the band, on the mean over where in a row it is: that is the
greater. Rows slower than any cycle keep the older bound: with a free play of some steps of the encoder what the drive
does between them is much more than its spline misses.
Rows at which either is more than the noise of its sensor are left out, unless the encoder's steps make as much of them,
and those at which the torque jumps from row to row. What the motor did there sets the load ringing against it, and a
mode faster than half the rate of the rows shows as a slow one: rows are left out until exp(Re(p) t), p its pole with
the motor held, has brought it below the noise in the band. So are those of faster rows whose drive is declared to have
several cycles in each.
Valid where what the drive does between rows shows at the rows; a vibration at a multiple of their rate
does not.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import binary_dilation, uniform_filter1d

from feeddrive.diagnosis.motion.band import Band, sensor_noise, white_noise
from feeddrive.errors import InputError
from feeddrive.plant.analysis.modes import braked_modes, inertia_at_motor, lag_per_acceleration
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.checks.flaws import quantisation_step
from feeddrive.typing import BoolArray, FloatArray

SLOWEST_CYCLE = 2e-3
"""Cycle of a servo loop at most [s]: those of machine tools take 0.03 to 2 ms."""

CLOCK_OFF = 0.05
"""Share by which times may be off, so that rows of the slowest cycle are still of one: no drive or logger writes rows
2.0 to 2.1 ms apart by design."""

BOUND = {4: 1 / 12, 6: 1 / 30}
"""delta a over a difference of the order and h^-2: above."""

ROUGH = 3.0
"""Rms of fourth differences, as far as the filter reaches, over that of the quietest tenth, beyond which it is no
noise: five independent ones exceed 2.4 once in 10^5, and the quietest tenth is a fifth below the mean."""

VIBRATION = 2.0
"""Length of stretches [s] of which nothing is kept where the torque jumps at half of their rows."""

FEWEST_ROWS = 100
"""Rows with known motion from which an effect can be distinguished from noise at all."""


def is_slow(recording: Recording) -> bool:
    """Whether rows are further apart than any drive's cycles."""
    return recording.sample_time > (1 + CLOCK_OFF) * SLOWEST_CYCLE


def known_motion(recording: Recording, plant: Plant, band: Band) -> BoolArray:
    """Rows of a slow recording at which the motion between rows is known, as far as the filter reaches; (n,).

    Args:
        recording: with a motor angle.
        plant: whose inertia and stiffness apply.
        band: of the comparison.
    """
    missed = np.zeros(len(recording))
    order = 4 if is_slow(recording) else 6
    bound, ends = BOUND[order] / recording.sample_time**2, order // 2
    missed[ends:-ends] = bound * np.abs(np.diff(recording["motor_angle"], order))
    # differences of the encoder's steps: of white noise the power of the binomials
    steps = ROUGH * math.sqrt(math.comb(2 * order, order) / 12) * quantisation_step(recording["motor_angle"])
    least = max(_least_acceleration(recording, plant), bound * steps)
    unknown: BoolArray = missed > least
    unknown |= _ringing(np.where(unknown, missed, 0.0) * _most_shown(recording, plant, band), plant, recording)
    reach = int(np.ceil(band.sample_rate / band.edge))
    if "motor_torque" in recording:
        unknown |= _vibrating(recording["motor_torque"], band.sample_rate, reach)
    return ~np.asarray(binary_dilation(unknown, iterations=reach))


def missed_between_rows(recording: Recording, plant: Plant, counted: BoolArray) -> dict[str, float]:
    """Rms of what the motion between rows may make of each channel: delta T and delta x above.

    By the fourth difference over 12 h^2, the error of the second one: a channel without noise is a simulation's, whose
    own steps may differ by that.

    Args:
        recording: with a motor angle.
        plant: whose inertia and stiffness apply.
        counted: rows that are compared, (n,).
    """
    fourth = np.diff(recording["motor_angle"], 4)[counted[2:-2]]
    missed = BOUND[4] * float(np.sqrt(np.mean(fourth**2))) / recording.sample_time**2
    made = {"motor_torque": inertia_at_motor(plant) * missed}
    if plant.chain.elastic:
        made["table_position"] = lag_per_acceleration(plant) * missed
    return made


def _ringing(over_noise: FloatArray, plant: Plant, recording: Recording) -> BoolArray:
    """Rows at which modes that the rows show as slower ones still answer motion that is not known, (n,).

    Args:
        over_noise: what was missed over the noise in the band, 0 where nothing was, (n,).
        plant: that rings.
        recording: the rows.
    """
    fastest = math.pi / recording.sample_time
    decays = [-pole.real for pole in braked_modes(plant, plant.middle).poles if pole.real < 0 and pole.imag > fastest]
    if not decays:
        return np.zeros(len(over_noise), dtype=bool)
    decayed: FloatArray = min(decays) * recording.sample_time * np.arange(len(over_noise), dtype=np.float64)
    with np.errstate(divide="ignore"):
        begun = np.maximum.accumulate(np.log(over_noise) + decayed)
    return np.asarray(begun > decayed)


def _most_shown(recording: Recording, plant: Plant, band: Band) -> float:
    """Error over the noise in the band that an error of the acceleration makes in the channel that shows most [s²]."""
    shown = [0.0]
    if "motor_torque" in recording:
        shown.append(_share(inertia_at_motor(plant), sensor_noise(recording["motor_torque"], band)))
    if "table_position" in recording and plant.chain.elastic:
        shown.append(_share(lag_per_acceleration(plant), sensor_noise(recording["table_position"], band)))
    return max(shown)


def _share(made: float, noise: float) -> float:
    """Error over noise; 0 where a channel has none to compare with."""
    return made / noise if noise > 0 else 0.0


def _vibrating(torque: FloatArray, rate: float, reach: int) -> BoolArray:
    """Rows between which the torque jumps, (n,)."""
    squares = np.zeros(len(torque))
    squares[2:-2] = np.diff(torque, 4) ** 2 / 70  # of white noise, its power
    power = np.maximum(uniform_filter1d(squares, reach), 0.0)  # a running sum loses digits of what is much larger
    jumps: BoolArray = np.sqrt(power) > ROUGH * white_noise(torque, rate)
    # a vibration passes a multiple of the rows' rate and looks slow for a moment
    share = uniform_filter1d(jumps.astype(float), max(1, round(VIBRATION * rate)), mode="nearest")
    return np.asarray(jumps | (share > 0.5))


def _least_acceleration(recording: Recording, plant: Plant) -> float:
    """Error of the acceleration that shows in a channel [rad/s²]; infinite where none shows it."""
    rate = 1 / recording.sample_time
    shown = [np.inf]
    if "motor_torque" in recording:
        shown.append(white_noise(recording["motor_torque"], rate) / inertia_at_motor(plant))
    if "table_position" in recording and plant.chain.elastic:
        shown.append(white_noise(recording["table_position"], rate) / lag_per_acceleration(plant))
    return float(min(shown))


def refuse_unknown_motion(known: BoolArray, counted: BoolArray, recording: Recording) -> None:
    """Refuse a recording of which hardly a row is left.

    Raises:
        InputError: fewer than `FEWEST_ROWS`.
    """
    left = int(np.sum(known & counted))
    if left < FEWEST_ROWS:
        what = f"the motion between rows {recording.sample_time * 1e3:.3g} ms apart is known at {left} of them"
        faster = f"at {1 / SLOWEST_CYCLE:.0f} Hz or more" if is_slow(recording) else "every cycle of the drive"
        mend = f"record {faster}, or a motion of long strokes at constant speed"
        raise InputError(what, recording.name, mend)


def sentence(known: BoolArray, recording: Recording) -> str:
    """Remarks on a slow recording."""
    return (
        f"rows are {recording.sample_time * 1e3:.3g} ms apart, further than a drive's cycles: a torque is that of its "
        f"row's instant, {_lost(known)} % of the rows are left out because the motion between them is not known, and "
        f"nothing faster than {0.1 / recording.sample_time:.3g} Hz is seen"
    )


def sentence_of_cycles(known: BoolArray, recording: Recording) -> str:
    """Remark on a recording whose drive has several cycles in a row."""
    return (
        f"{_lost(known)} % of the rows are left out: the drive has several cycles in each of "
        f"{recording.sample_time * 1e3:.3g} ms, and what the motor did between them is not known; record every cycle"
    )


def _lost(known: BoolArray) -> str:
    """Rows that are left out, in per cent."""
    return f"{100 * (1 - float(np.mean(known))):.2g}"
