"""The heat of a machine as equations in time: a reduced network, the laws that act on it, and what its sensors read.

    C dx/dt = -(K₀ + Σ gᵢ Kᵢ) x + Σ gᵢ aᵢ θ_i + Σ b_j Q_j,    g, Q = laws(speed, time, L x; p),    y = θ₀ + L x

| symbol | meaning | unit |
|---|---|---|
| x | states of the reduced network, bodies that effects attach, lagging sensors | K (J/K)^½, K |
| g, Q | conductances and heats of `feeddrive.thermal.laws.laws` | |
| y | what the sensors read | degC, m |
| θ₀ | temperature at the start, a parameter like the others | degC |

The rows of `warm_up` are these equations with speed and surroundings held. A coolant starts within a millisecond.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from feeddrive.symbolic_turn import SYMBOLS
from feeddrive.thermal.full.full_model import NUT
from feeddrive.thermal.laws.laws import FOLLOWED, INPUTS, PATHS, growth_places, laws_of, values_of
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import AMBIENT, HeatModel
from feeddrive.thermal.reduced.reduction import reduce_model
from feeddrive.thermal.rig import refuse_unless
from feeddrive.thermal.run.warm_up import channel_of
from feeddrive.typing import Expression, FloatArray

if TYPE_CHECKING:
    import control

HEAT_INPUTS = ("screw_speed", "ambient_temperature")
HEAT_INPUT_UNITS = ("rad/s", "degC")
START = "start.temperature"
"""Name of the parameter θ₀ [degC]."""

_SWITCH = 1e-3
_FRICTION = {"load_torque": "N m", "viscous_factor": "1", "viscosity": "m^2/s", "mean_diameter": "m", "heat_share": "1"}
_UNITS = {
    "film": dict.fromkeys(("screw", "screw_least", "nut_free", "nut_forced"), "W/(m^2 K)"),
    "contact": dict.fromkeys(("conductance", "front_film", "rear_film"), "W/(m^2 K)"),
    "nut": _FRICTION,
    "front_bearing": _FRICTION,
    "rear_bearing": _FRICTION,
    "start": {"temperature": "degC"},
}


@dataclass(frozen=True, eq=False)
class HeatEquations:
    """dx/dt = f(t, x, u, p), y = g(t, x, p), all SI, temperatures in degC.

    Attributes:
        function: (time, x, u, p) -> (xdot, y); u of `HEAT_INPUTS`.
        states: name to its typical size; all start at zero.
        outputs: channel to its unit.
        parameters: name to its unit and value, θ₀ the last.
    """

    function: ca.Function
    states: dict[str, float]
    outputs: dict[str, str]
    parameters: dict[str, tuple[str, float]]

    @property
    def values(self) -> FloatArray:
        """Values of the parameters, (p,)."""
        return np.array([value for _, value in self.parameters.values()])


@SYMBOLS.taken()
def heat_equations(heat: Heat, model: HeatModel | None = None) -> HeatEquations:
    """The equations of a plant.

    Args:
        heat: what the file declares, effects among it.
        model: its reduced model without the bodies of effects; None to reduce it for the range of `limits`.

    Raises:
        InputError: a full model, which is too large.
    """
    if model is None:
        model = reduce_model([replace(heat, effects=()).full_model()], heat.limits())[0]
    refuse_unless(isinstance(model.conduction, np.ndarray), "a full model is too large", "thermal", "reduce it first")
    laws, n = laws_of(heat), model.order
    lagged = [(channel, i) for channel, rows in laws.lagging.items() for i in rows]
    time, u = (ca.SX.sym(name, size) for name, size in (("time", 1), ("u", 2)))
    x, p = ca.SX.sym("x", n + len(laws.bodies) + len(lagged)), ca.SX.sym("p", len(laws.names) + 1)
    values, cold = p[:-1], p[-1]
    network: Expression = x[:n]
    rises = ca.vertcat(*[ca.DM(model.readings[name]).T @ network for name in FOLLOWED])
    speed, air = ca.vertsplit(u)
    g, heats = laws.acting(speed, time, _SWITCH, air - cold, rises, cold, values)
    given = dict(zip(INPUTS, ca.vertsplit(heats), strict=True))
    frame, lags, bodies = laws.sensing(time, values)
    flow = _flow(model, network, g, given)
    rates = []
    for i in range(len(laws.bodies)):
        port = ca.DM(model.ports[NUT])
        taken = bodies[2 * i] * (port.T @ network - x[n + i])
        flow -= port * taken
        rates.append(taken / bodies[2 * i + 1])
    shown = _shown(heat, model, network, frame)
    follows: dict[str, Expression] = {}
    for k, (channel, i) in enumerate(lagged):
        state = x[n + len(laws.bodies) + k]
        led: Expression = follows[channel] if channel in follows else shown[channel]
        rates.append((led - state) / ca.fmax(lags[i], _SWITCH))
        follows[channel] = state
    read = {**shown, **follows}
    y = [value if channel.startswith("table_growth") else cold + value for channel, value in read.items()]
    xdot = ca.vertcat(flow / ca.DM(model.capacity), *rates)
    function = ca.Function(
        "heat_ode", [time, x, u, p], [ca.densify(xdot), ca.vertcat(*y)], ["time", "x", "u", "p"], ["xdot", "y"]
    )
    sizes = {f"network_{i + 1}": float(np.sqrt(np.sum(heat.full_model().capacity))) for i in range(n)}
    sizes |= {f"{label}_rise": 1.0 for label in laws.bodies}
    sizes |= {f"{channel}_lag_{i + 1}": 1e-6 if channel.startswith("table_growth") else 1.0 for channel, i in lagged}
    outputs = {channel: "m" if channel.startswith("table_growth") else "degC" for channel in read}
    named = dict(zip((*laws.names, START), (*values_of(heat), heat.ambient), strict=True))
    return HeatEquations(function, sizes, outputs, {key: (_unit(heat, key), float(v)) for key, v in named.items()})


def linear_heat(heat: Heat, speed: float, model: HeatModel | None = None) -> control.StateSpace:
    """The equations linearised at a speed of the screw [rad/s], cold and at the temperature of the start.

    Inputs and outputs are deviations, with their names, SI.
    """
    import control  # takes half a second, with the plotting that it brings

    equations = heat_equations(heat, model)
    with SYMBOLS.taken():
        arguments = [ca.SX.sym(of, equations.function.size1_in(of)) for of in equations.function.name_in()]
        slopes = [ca.jacobian(of, to) for of in equations.function(*arguments) for to in arguments[1:3]]
        taken = ca.Function("heat_slopes", arguments, slopes)
    at = taken(0.0, np.zeros(len(equations.states)), [speed, heat.ambient], equations.values)
    return control.ss(
        *(one.full() for one in at),
        states=list(equations.states),
        inputs=list(HEAT_INPUTS),
        outputs=list(equations.outputs),
    )


def _flow(model: HeatModel, x: Expression, g: Expression, given: dict[str, Expression]) -> Expression:
    """C dx/dt of the network."""
    flow = -(ca.DM(model.conduction) @ x) + ca.DM(model.air) * given[AMBIENT]
    for name, vector in model.heats.items():
        if name in given:
            flow += ca.DM(vector) * given[name]
    for i, path in enumerate(PATHS):
        way = model.ways[path]
        flow -= g[i] * (ca.DM(way.matrix) @ x)
        if way.source == AMBIENT:
            flow += g[i] * ca.DM(way.facing) * given[AMBIENT]
    return flow


def _shown(heat: Heat, model: HeatModel, x: Expression, frame: Expression) -> dict[str, Expression]:
    """Channel to its rise or growth, without lags; those of the plant's sensors, or all."""
    named = {sensor.output: sensor.channel for sensor in heat.sensors}
    moved = dict(zip(growth_places(heat), ca.vertsplit(frame), strict=True))
    return {
        named.get(name, channel_of(name)): ca.DM(row).T @ x + moved.get(name, 0.0)
        for name, row in model.readings.items()
        if not named or name in named
    }


def _unit(heat: Heat, name: str) -> str:
    """Unit of a parameter."""
    group, _, key = name.partition(".")
    key = key.partition("[")[0]
    if group in _UNITS:
        return _UNITS[group][key]
    effect = next(one for one in heat.effects if one.label == group)
    return effect.parameter(key).unit
