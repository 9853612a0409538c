"""The heat of a machine, ready to be written in another form: temperatures and growth from speed and surroundings.

    from thermal_bench_heat_ss import system
    fmpy.simulate_fmu("thermal_bench_heat.fmu", stop_time=3600, start_values={"screw_speed": 50})

Inputs are the speed of the screw [rad/s] and the temperature of the air [degC], outputs what the sensors read
[degC, m], or every output where the plant declares no sensor. It starts cold, at `start.temperature`.
"""

from __future__ import annotations

from feeddrive import __version__
from feeddrive.export.nonlinear_model import Model, Quantity, identifier_of
from feeddrive.export.point import Point
from feeddrive.thermal.heat_equations import HEAT_INPUT_UNITS, HEAT_INPUTS, heat_equations, linear_heat
from feeddrive.thermal.machine_heat import Heat
from feeddrive.units.quantity import format_quantity

_COMMENTS = ("of the screw, either sign", "of the air around screw and nut")


def heat_model_of(heat: Heat) -> Model:
    """The equations of the heat of a plant, cold and at rest at the start.

    Args:
        heat: the machine.
    """
    equations = heat_equations(heat)
    start = zip(HEAT_INPUTS, HEAT_INPUT_UNITS, (0.0, heat.ambient), _COMMENTS, strict=True)
    units = (
        "J^0.5 K^0.5" if name.startswith("network_") else "m" if "growth" in name else "K" for name in equations.states
    )
    return Model(
        plant=None,
        name=f"{heat.name}, heat",
        identifier=identifier_of(f"{heat.name} heat"),
        point=Point(0.0, 0.0),
        subject="temperatures and growth",
        notes=_notes(heat),
        states=tuple(Quantity(name, unit) for name, unit in zip(equations.states, units, strict=True)),
        inputs=tuple(Quantity(*row) for row in start),
        outputs=tuple(Quantity(name, unit) for name, unit in equations.outputs.items()),
        parameters=tuple(
            Quantity(name, unit, value, heat.origins.get(f"thermal.{name}", ""))
            for name, (unit, value) in equations.parameters.items()
        ),
        function=equations.function,
        nominal=tuple(equations.states.values()),
    )


def heat_python_text(heat: Heat, speed: float) -> str:
    """Source of a module with the heat linearised at a speed of the screw [rad/s], `system` a control.StateSpace."""
    system = linear_heat(heat, speed)
    held, lacking = _notes(heat)
    lines = [
        f"# {heat.name}, heat, linear about {format_quantity(speed, 'rad/s')} at {heat.ambient:g} degC.",
        f"# Made by feeddrive {__version__}. SI units: x' = A x + B u, y = C x + D u, deviations from the point.",
        *(f"# Included: {line}" for line in held),
        *(f"# Left out: {line}" for line in (*lacking, "what changes with time is taken at the start")),
        "import control",
        *(f"{key} = {getattr(system, key).tolist()!r}" for key in "ABCD"),
        "",
        f"system = control.ss(A, B, C, D, states={list(system.state_labels)!r},",
        f"                    inputs={list(system.input_labels)!r}, outputs={list(system.output_labels)!r})",
    ]
    return "\n".join(" ".join(line.split()) if line.startswith("#") else line for line in lines) + "\n"


def _notes(heat: Heat) -> tuple[tuple[str, ...], tuple[str, ...]]:
    held = [
        f"screw, nut and {len(heat.bodies)} bodies, reduced; films, contact and friction heat that follow the speed"
    ]
    held += [f"effect {effect.label}" for effect in heat.effects]
    low, high = (format_quantity(end, "rad/s") for end in (0.0, heat.highest_speed))
    lacking = (f"speeds outside {low} to {high}", "the motion: the nut is averaged over its travel")
    return tuple(held), lacking
