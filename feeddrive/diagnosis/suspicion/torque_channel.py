"""The torque of a recording: as recorded, from the current, or to a scale that is not known and fitted with the rest.

Where the drive gives a current without its torque constant, or a share of a rated torque, all that is known is that the
torque is proportional to it. The inertia of the declared plant then sets the scale:

    g = <m, p> / <p, p>      p: torque that a plant predicts, m: what was recorded, over the fitted samples, in the band

Every plant that is tried gets its own g, so that nothing is named only to make up for a scale that fits another.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

PROPORTIONAL = {"motor_current": "A", "motor_torque_share": "1"}
"""Channels that the torque is proportional to, and their units."""

LEAST_CORRELATION = 0.5
"""Between a channel and the torque that the declared plant needs, below which the channel is something else."""


def with_torque(recording: Recording, plant: Plant) -> tuple[Recording, str]:
    """The recording with a motor torque, where it holds anything that makes one.

    Args:
        recording: as read.
        plant: whose torque constant applies, where it declares one.

    Returns:
        The recording, and the channel that its torque is only proportional to; empty where the torque is known.
    """
    if "motor_torque" in recording:
        return recording, ""
    if "motor_current" in recording and plant.torque_constant is not None:
        note = f"the torque is the current times {format_quantity(plant.torque_constant, 'N m/A')}, as declared"
        return _torque(recording, plant.torque_constant * recording["motor_current"], note), ""
    for name in PROPORTIONAL:
        if name in recording:
            return _torque(recording, recording[name], f"the torque is read from {name}, its scale fitted"), name
    return recording, ""


def _torque(recording: Recording, torque: FloatArray, note: str) -> Recording:
    channels = {**recording.channels, "motor_torque": torque}
    return replace(recording, channels=channels, notes=(*recording.notes, note))


def scale_of(measured: FloatArray, predicted: FloatArray) -> float:
    """g, the factor that makes a prediction fit best; one where nothing is predicted. Shapes (n,)."""
    energy = float(predicted @ predicted)
    return float(measured @ predicted) / energy if energy > 0 else 1.0


def refuse_what_is_no_torque(channel: str, measured: FloatArray, predicted: FloatArray, where: str) -> None:
    """Refuse a channel that does not follow the torque that the declared plant needs.

    Raises:
        InputError: it follows something else, or the torque with the other sign.
    """
    energy = float(np.linalg.norm(measured) * np.linalg.norm(predicted))
    correlation = float(measured @ predicted) / energy if energy > 0 else 0.0
    if correlation < LEAST_CORRELATION:
        mend = 'check the column; for the other sign write "factor = -1" in a mapping file'
        what = f"{channel} does not follow the torque that the plant needs (correlation {correlation:.2f})"
        raise InputError(what, where, mend)


def scale_sentence(channel: str, declared: float, found: float) -> str:
    """Remarks on a fitted scale [N m per unit of the channel], as declared and with what was found."""
    unit = "N m/A" if PROPORTIONAL[channel] == "A" else "N m"
    first, last = (format_quantity(value, unit) for value in (declared, found))
    return (
        f"{channel}: its torque per unit is not declared; {last} fits the plant with what was found, {first} the plant "
        f"as declared. Inertias and masses as declared set this scale: if all of them are off alike, so is every force."
    )


def without_torque_sentence(names: Iterable[str]) -> str:
    """What recordings without a torque leave open: names of the effects that cannot be seen."""
    return (
        "no recording holds a torque or a current: forces are seen only through what the transmission gives way, and "
        f"nothing can be said of {', '.join(sorted(names))}"
    )
