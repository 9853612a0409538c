"""The measurements of paper 004, and what it says about their distance from the calculation."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.parts.combined_stiffness import combined_stiffness
from feeddrive.parts.screw.screw_drive import BallScrewDrive
from feeddrive.plant.analysis.modes import held_frequency
from feeddrive.reproduce.paper_004_drive import FORCE_LENGTH, MODULI, TORQUE_LENGTH, paper_drive
from feeddrive.reproduce.row import Paper, Row, claim, not_possible, number

_STIFFNESS, _FREQUENCY = 191e6, 185.0
"""Measured [N/m], [Hz]."""

_CALCULATED, _CALCULATED_FREQUENCY = 202.7e6, 195.7
"""As the paper prints them [N/m], [Hz]."""

_FROM_MOTOR = 1.1
_LENGTHS = (0.7, 1.5)
_PAPER = Paper.STIFFNESS


def measurement_rows(drive: BallScrewDrive) -> tuple[Row, ...]:
    """Deviations, their cause, and the place of the nut (section 4)."""
    static, dynamic = 100.0 * (_CALCULATED / _STIFFNESS - 1.0), 100.0 * (_CALCULATED_FREQUENCY / _FREQUENCY - 1.0)
    worst = max(static, dynamic)
    return (
        _static_row(drive),
        number(_PAPER, "sec. 4", "static stiffness, calculated above measured", "%", "6.1", static, law=None),
        _dynamic_row(drive),
        number(_PAPER, "sec. 4", "natural frequency, calculated above measured", "%", "5.8", dynamic, law=None),
        claim(_PAPER, "abstract, conclusion 4", "calculation and measurement differ", "by less than 6 %",
              f"{static:.1f} and {dynamic:.1f} %", worst < 6.0, law=None,
              otherwise="the static deviation is above 6 %, by the paper's own 6.1 %"),
        _friction_row(),
        _place_row(drive),
        _near_motor_row(drive),
        not_possible(_PAPER, "Fig. 6", "force and displacement of three repeats", "", "a curve",
                     "the points are not printed; only their slope is"),
        not_possible(_PAPER, "Fig. 7", "frequency response", "", "a curve",
                     "neither damping nor higher modes are printed; only the peak is"),
    )  # fmt: skip


def _static_row(drive: BallScrewDrive) -> Row:
    found = combined_stiffness(drive, FORCE_LENGTH)
    missing = 1.0 / _STIFFNESS - 1.0 / found.total
    reason = (
        f"computed {found.total / 1e6:.1f}; {missing * 1e9:.2f} nm/N are missing, as a housing of "
        f"{1e-6 / missing:.0f} N/µm would give, or a bearing, nut, coupling or screw a little softer"
    )
    return not_possible(_PAPER, "Fig. 6", "measured static stiffness", "N/µm", "191", reason)


def _dynamic_row(drive: BallScrewDrive) -> Row:
    """The measured stiffness with the screw's own mass, over the lengths that the screw may have."""
    housing = 1.0 / (1.0 / _STIFFNESS - 1.0 / combined_stiffness(drive, FORCE_LENGTH).total)
    softer = replace(drive, housing_stiffness=housing)
    lengths = [replace(softer, screw=replace(drive.screw, length=length)) for length in _LENGTHS]
    high, low = (held_frequency(one, FORCE_LENGTH) for one in lengths)
    assumption = "measured stiffness; screw's own mass, its length of 0.7 to 1.5 m is not printed"
    return claim(
        _PAPER, "Fig. 7", "measured natural frequency", "185", f"{low:.1f} to {high:.1f}",
        low <= _FREQUENCY <= high, law=held_frequency, unit="Hz", assumption=assumption,
    )  # fmt: skip


def _friction_row() -> Row:
    """Guides that hold part of the force lie parallel to the drive."""
    with_guides = _CALCULATED + 5e6
    holds = with_guides < _CALCULATED
    return claim(
        _PAPER, "sec. 4", "guide friction left out makes the measured stiffness lower", "lower",
        f"5 N/µm of sticking guides raise it to {with_guides / 1e6:.1f} N/µm", holds, law=None,
        otherwise="friction carries part of the force: it raises the stiffness and never lowers it",
    )  # fmt: skip


def _place_row(drive: BallScrewDrive) -> Row:
    """The stiffness if the torque's length were the 1.1 m from the motor."""
    position = _FROM_MOTOR - (TORQUE_LENGTH - FORCE_LENGTH)
    longer = combined_stiffness(paper_drive(screw_length=1.2), position).total
    below = 100.0 * (1.0 - longer / _STIFFNESS)
    return claim(
        _PAPER, "sec. 4, Table 1", "nut 1.1 m from the motor agrees with 670 mm under torque", "the same test",
        f"{longer / 1e6:.1f} N/µm, {below:.0f} % below measured", abs(below) < 10.0, law=combined_stiffness,
        otherwise="consistent only if 1.1 m is counted from the motor's rear, 430 mm behind the coupling",
    )  # fmt: skip


def _near_motor_row(drive: BallScrewDrive) -> Row:
    longer = paper_drive(screw_length=1.2)
    near, far = (combined_stiffness(longer, place).total for place in (0.1, _FROM_MOTOR))
    return claim(
        _PAPER, "sec. 4", "near the motor displacements are smaller", "smaller",
        f"{near / 1e6:.0f} N/µm at 0.1 m, {far / 1e6:.0f} N/µm at 1.1 m", near > far,
        law=combined_stiffness, assumption=MODULI,
    )  # fmt: skip
