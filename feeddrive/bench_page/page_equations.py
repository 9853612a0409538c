"""The equations of a plant under a cascade as JavaScript functions, and the numbers that go with them.

| function | arguments -> results |
|---|---|
| before, watch, iterate | of the engine, see `simulate.program` and `simulate.step` |
| jacobians | (x, u, p) -> A, B, C, D of the linearised plant |
| chain | (p, x) -> M, C, K, row of the motor, row of the table, rigid motion |
| steady | (unknown, p, [velocity, position]) -> residual, its slope |
| travel | (phi, x, p) -> deviation, its slopes |
| cascade_linear | ([tick], parameters) -> derivatives of the cascade, as `servo.linear_loop` takes them |
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from feeddrive.bench_page.javascript import javascript
from feeddrive.effects.base import TimingEffect, TransmissionEffect
from feeddrive.engine.program import CELL, DEEPEST, TOLERANCE
from feeddrive.engine.step.linear_part import FORGETTING
from feeddrive.engine.step.step_constants import FULL_SCALE, converged
from feeddrive.errors import InputError
from feeddrive.plant.analysis.linear import jacobians
from feeddrive.plant.analysis.ode import OUTPUTS, ode
from feeddrive.plant.chain.chain import symbolic
from feeddrive.plant.equations import bristle_count
from feeddrive.plant.plant import Plant
from feeddrive.plant.structure import chain_symbols, parameter_symbols, parameter_values
from feeddrive.plant.transmission_law import travel_deviation
from feeddrive.servo.cascade import Cascade
from feeddrive.servo.cascade_function import PARAMETERS, cascade_controller
from feeddrive.servo.sampled_plant import MEASUREMENTS, SampledController
from feeddrive.simulate.controlled.controlled_machine import TorqueLoop, machine_for, resolutions_of
from feeddrive.symbolic_turn import SYMBOLS


def bench_equations(plant: Plant, cascade: Cascade) -> tuple[str, dict[str, Any]]:
    """JavaScript functions, and what the driver of the page needs to know of them.

    Args:
        plant: the machine, with a payload effect whose mass the page moves.
        cascade: with as many torque filters as the page has.

    Raises:
        InputError: a plant without elastic chain, whose loop the page does not compute.
    """
    if not plant.chain.elastic:
        raise InputError("a rigid plant has no mode to see", plant.name, "use `feeddrive bode` and `feeddrive run`")
    controller = cascade_controller(cascade)
    loop = TorqueLoop(cascade.current_lag, cascade.dead_time)
    machine, timing = machine_for(plant, controller, loop, resolutions_of(plant, controller))
    program = machine.program
    functions = {
        "before": program.before,
        "watch": program.step.watch,
        "iterate": program.step.iterate,
        **_linear_functions(plant),
        "cascade_linear": _cascade_linear(controller),
    }
    text = "\n".join(javascript(function, name) for name, function in functions.items())
    delays = (effect.delay(effect.values) for effect in plant.effects if isinstance(effect, TimingEffect))
    slots = [effect for effect in plant.effects if isinstance(effect, TransmissionEffect)]
    layout = program.step.layout
    numbers = {
        "sizes": program.sizes, "read": list(program.step.read), "forced": list(layout.forced),
        "lagging": layout.lagging, "parts": list(timing.parts), "past": timing.past,
        "values": parameter_values(plant), "parameters": controller.parameters.tolist(),
        "parameter_names": list(PARAMETERS), "resolutions": list(resolutions_of(plant, controller).values()),
        "torque_limit": plant.torque_limit, "initial": controller.initial.tolist(),
        "tick": cascade.sample_time, "divider": cascade.position_divider, "lag": cascade.current_lag,
        "dead": cascade.dead_time + max(0.0, float(sum(delays))), "feedback": str(cascade.feedback),
        "radius": cascade.radius, "lead_radius": plant.chain.radius, "n": len(plant.chain.coordinates),
        "bristles": bristle_count(plant), "outputs": list(OUTPUTS), "travel": plant.has_travel,
        "free_play": float(sum(effect.free_play(effect.values) for effect in slots)),
        "measured": [list(OUTPUTS).index(name) for name in controller.measurements],
        "controller_states": len(controller.initial), "signals": list(controller.signals),
        "references": list(controller.references), "cell": CELL, "deepest": DEEPEST, "tolerance": TOLERANCE,
        "full_scale": FULL_SCALE, "converged": converged(layout), "forgetting": FORGETTING, "varies": program.varies,
        "measurements": len(MEASUREMENTS),
    }  # fmt: skip
    return text, numbers


@SYMBOLS.taken()
def _linear_functions(plant: Plant) -> dict[str, ca.Function]:
    symbols = parameter_symbols(plant)
    chain, p = plant.chain, symbols.vector
    values, x = chain_symbols(plant, symbols), ca.SX.sym("x")
    rows = [symbolic([row]).T for row in (chain.motor(values), chain.table(values), chain.rigid_motion(values))]
    whole = [symbolic(matrix(values, x)) for matrix in (chain.mass, chain.damping, chain.stiffness)]
    phi = ca.SX.sym("phi")
    delta = travel_deviation(plant, symbols, phi, x, 0.0)
    return {
        "jacobians": jacobians(plant),
        "chain": ca.Function("chain", [p, x], [*whole, *rows]),
        "steady": _steady(plant, values, p),
        "travel": ca.Function("travel", [phi, x, p], [delta, ca.jacobian(delta, phi), ca.jacobian(delta, x)]),
    }


def _steady(plant: Plant, values: Any, p: Any) -> ca.Function:
    """Residual of a motion at constant velocity, as `plant.steady` has it, and its slope."""
    n = len(plant.chain.coordinates)
    unknown, given = ca.SX.sym("unknown", n + bristle_count(plant)), ca.SX.sym("given", 2)
    unknowns = [unknown[i] for i in range(unknown.numel())]
    rates = [given[0] * rate for rate in plant.chain.rigid_motion(values)]
    x = ca.vertcat(*unknowns[: n - 1], given[1], *rates, *unknowns[n:])
    xdot, _ = ode(plant)(x, ca.vertcat(unknown[n - 1], 0), p)
    mass = symbolic(plant.chain.mass(values, given[1]))
    residual = ca.vertcat(mass @ xdot[n : 2 * n], xdot[2 * n :])
    return ca.Function("steady", [unknown, p, given], [residual, ca.jacobian(residual, unknown), x])


@SYMBOLS.taken()
def _cascade_linear(controller: SampledController) -> ca.Function:
    """Derivatives of the cascade at one tick, away from its limits: blocks of `servo.linear_loop`."""
    function = controller.function
    arguments = [ca.SX.sym(f"a{i}", function.size1_in(i)) for i in range(5)]
    results = function(*arguments)
    blocks = [ca.jacobian(result, argument) for result in results for argument in arguments[:3]]
    zeros = [np.zeros(function.size1_in(i)) for i in range(3)]
    at_rest = ca.substitute(blocks, arguments[:3], [ca.SX(zero) for zero in zeros])
    return ca.Function("linear", [arguments[3], arguments[4]], at_rest)
