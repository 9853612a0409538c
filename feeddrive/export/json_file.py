"""Everything about a plant at a point as JSON.

    import json
    model = json.load(open("bench_axis.json", encoding="utf-8"))
    system = control.ss(*(model["linear"][key] for key in "ABCD"))

Numbers are written so that reading them back gives the same bits; SI units.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from feeddrive import __version__
from feeddrive.export.linear_model import LinearModel
from feeddrive.export.nonlinear_model import Quantity, parameters
from feeddrive.export.notes import included, left_out, linear_notes
from feeddrive.plant.analysis.modes import Modes, braked_modes, free_modes
from feeddrive.plant.plant import Plant

FORMAT = "feeddrive-export/1"


def json_text(model: LinearModel) -> str:
    """The linear model, the chain, the parameters, modes and notes as JSON.

    Keys: `format`, `version`, `plant`, `structure`, `point`, `linear` (A, B, C, D, states, inputs, outputs, poles),
    `chain` (coordinates, mass, damping, stiffness), `parameters`, `modes` (braked, free), `stroke`, `torque_limit`,
    `sensors`, `notes`. A pole is [real, imaginary]. Rows are {name, unit, value}; the value of a state or an input is
    the one at the point.
    """
    plant, system = model.plant, model.system
    content = {
        "format": FORMAT,
        "version": __version__,
        "plant": plant.name,
        "structure": plant.chain.structure,
        "point": {"table_position": model.position, "table_velocity": model.velocity},
        "linear": {
            **{key: getattr(system, key).tolist() for key in "ABCD"},
            "states": rows(model.states),
            "inputs": rows(model.inputs),
            "outputs": [{"name": row.name, "unit": row.unit} for row in model.outputs],
            "poles": [[pole.real, pole.imag] for pole in system.poles()],
        },
        "chain": {
            "coordinates": rows(model.states[: len(plant.chain.coordinates)]),
            "mass": model.mass.tolist(),
            "damping": model.damping.tolist(),
            "stiffness": model.stiffness.tolist(),
        },
        "parameters": rows(parameters(plant)),
        "modes": {
            "braked": _modes(braked_modes(plant, model.position)),
            "free": _modes(free_modes(plant, model.position)),
        },
        **_equipment(plant),
        "notes": {"included": included(plant), "left_out": (*left_out(plant), *linear_notes(plant))},
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def rows(quantities: Sequence[Quantity]) -> list[dict[str, Any]]:
    """Name, unit and value of each, and the comment where there is one."""
    return [
        {"name": row.name, "unit": row.unit, "value": row.value} | ({"comment": row.comment} if row.comment else {})
        for row in quantities
    ]


def _equipment(plant: Plant) -> dict[str, Any]:
    limit = plant.torque_limit
    return {
        "stroke": list(plant.stroke) if plant.stroke else None,
        "torque_limit": limit if limit < float("inf") else None,
        "sensors": [
            {"channel": sensor.channel, "kind": sensor.kind, "at": sensor.at, "resolution": sensor.resolution}
            for sensor in plant.sensors
        ],
    }


def _modes(modes: Modes) -> dict[str, Any]:
    """Frequencies [Hz], damping ratios [1], shapes by mode, in table travel [1]."""
    return {
        "frequencies": modes.frequencies.tolist(),
        "damping": modes.damping.tolist(),
        "shapes": modes.shapes.T.tolist(),
    }
