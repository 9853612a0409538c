"""The closed-loop simulation in `diagnosis.json`: keys that are without value are left out."""

from __future__ import annotations

from typing import Any

from feeddrive.diagnosis.simulated.simulation_result import ErrorFigure, SimulationResult


def simulation_record(simulation: SimulationResult) -> dict[str, Any]:
    """The entry `simulation`; `before` and `after` are of the channel named first, `after` as it is reported."""
    record: dict[str, Any] = {
        "channel": simulation.channel,
        "before": simulation.before,
        "after": simulation.after,
        "after_attribution": simulation.after_attribution,
        "after_refinement": simulation.after_refinement,
        "refinement_kept": simulation.kept,
        "statement": simulation.statement,
        "channels": [
            {
                "name": channel.name,
                "unit": channel.unit,
                "before": _figure(channel.before),
                "after": _figure(channel.after),
                "after_attribution": _figure(channel.after_attribution),
            }
            | ({"after_refinement": _figure(channel.after_refinement)} if channel.after_refinement else {})
            for channel in simulation.channels
        ],
        "refined": [
            {"effect": value.effect, "key": value.key, "unit": value.unit, "before": value.before, "after": value.after}
            for value in simulation.refined
        ],
        "not_refined": [{"name": name, "reason": reason} for name, reason in simulation.not_refined.items()],
    }
    return {key: value for key, value in record.items() if value is not None}


def _figure(figure: ErrorFigure) -> dict[str, float]:
    return {"rms": figure.rms, "relative": figure.relative}
