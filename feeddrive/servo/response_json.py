"""Frequency responses as plain values for JSON: Hz, dB, degrees; what is not finite is None."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from feeddrive.servo.margins import Margins
from feeddrive.servo.mechanics_response import decibel, degrees
from feeddrive.servo.resonances import Resonance, on_curve
from feeddrive.servo.response_family import Curve, Family
from feeddrive.typing import ComplexArray, FloatArray


def family_content(family: Family) -> dict[str, Any]:
    """A family with all its curves."""
    response = family.curves[0].response
    return {
        "title": family.title,
        "from": response.given,
        "to": response.output,
        "unit": response.unit,
        "curves": [_curve(curve) for curve in family.curves],
    }


def margins_content(margins: Margins) -> dict[str, Any]:
    """Margins of a loop; None where one does not exist."""
    return {
        "gain_db": finite(margins.gain),
        "gain_frequency": finite(margins.gain_frequency),
        "phase_deg": finite(margins.phase),
        "phase_frequency": finite(margins.phase_frequency),
        "sensitivity_peak": finite(margins.sensitivity),
        "stable": margins.stable,
    }


def measured_content(frequency: FloatArray, values: ComplexArray, coherence: FloatArray) -> dict[str, Any]:
    """A measured response."""
    return {
        "frequency": frequency.tolist(),
        "magnitude_db": decibel(values).tolist(),
        "phase_deg": degrees(values).tolist(),
        "coherence": [finite(float(value)) for value in coherence],
    }


def finite(value: float) -> float | None:
    """A number for JSON; None where it is not finite."""
    return value if math.isfinite(value) else None


def _curve(curve: Curve) -> dict[str, Any]:
    response = curve.response
    return {
        **asdict(curve.case),
        "frequency": response.frequency.tolist(),
        "magnitude_db": response.decibel.tolist(),
        "phase_deg": response.degrees.tolist(),
        "resonances": [_root(root, curve) for root in response.marks],
        "extrema": [asdict(one) for one in curve.seen],
        "margins": margins_content(curve.margins) if curve.margins else None,
        "closed": {key: finite(value) for key, value in asdict(curve.closed).items()} if curve.closed else None,
    }


def _root(root: Resonance, curve: Curve) -> dict[str, Any]:
    seen = on_curve(root, curve.seen)
    return {**asdict(root), "seen_at": seen.frequency if seen else None, "seen_db": seen.decibel if seen else None}
