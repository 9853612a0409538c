"""What acts on the heat network, written once in CasADi: films, contact, friction heats and the effects on them.

    g = g_0 Π cᵢ,    Q = Q_0 + Σ Qᵢ,    Q_nut = s ω (T_1 Π lᵢ(ΔT) + T_v Π vᵢ(ΔT)),    θ_i = θ_recorded + Σ Δθᵢ

| symbol | meaning | unit |
|---|---|---|
| g | film coefficients and contact conductance; the coolant's conductances add | W/(m² K), W/K |
| Q | heats of nut and seats | W |
| T_1, T_v, s | load and viscous torque of the nut, share of the heat | N m, 1 |
| l, v | factors at the nut's rise ΔT | 1 |
| θ_i | surroundings | K |

Where the plant has a coupling, T_1 follows the preload and T_v the oil of nut and bearings (`thermal.coupling`).
Simulation in rows, linearisation, exact sensitivities and export all take the two functions of `laws_of`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from feeddrive.effects.base import Value
from feeddrive.effects.heat.bearing_heat import reference_torque
from feeddrive.effects.heat.thermal_effect import Operation
from feeddrive.symbolic_turn import SYMBOLS, Holder
from feeddrive.thermal.full.full_model import END, FRONT, NUT, REAR, SHAFT, growth_name
from feeddrive.thermal.laws.films import film_on_nut, film_on_screw
from feeddrive.thermal.laws.friction import torque_law
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import AMBIENT, Path
from feeddrive.thermal.thermal_coupling import viscous_share
from feeddrive.typing import Expression, FloatArray


class BoundFunction:
    """A function with its arguments and results at fixed places; of one thread, and kept with its arrays."""

    def __init__(
        self, function: ca.Function, arguments: Sequence[FloatArray], results: Mapping[int, FloatArray]
    ) -> None:
        self._buffer, self._call = function.buffer()
        self._kept = (function, tuple(arguments), dict(results))  # the buffer holds addresses alone
        buffer: Expression = self._buffer
        for i, array in enumerate(arguments):
            buffer.set_arg(i, memoryview(array.data))
        for i, array in results.items():
            buffer.set_res(i, memoryview(array.data))

    def __call__(self) -> None:
        """Evaluate: reads the arguments where they are, writes the results."""
        self._call()


PATHS = tuple(Path)
INPUTS = (NUT, FRONT, REAR, AMBIENT)
"""Inputs of the network that the laws give: heats [W], rise of the surroundings [K]."""

FOLLOWED = (NUT, SHAFT, FRONT, REAR)
"""Outputs of the network that friction may follow [K]."""

Groups = Mapping[str, Mapping[str, Value]]


@dataclass(frozen=True, eq=False)
class Laws:
    """The laws of one structure of plant.

    Attributes:
        names: of the parameters, `group.key`, tables `group.key[i]`; groups are "film", "contact", "nut",
            "front_bearing", "rear_bearing" and the labels of effects.
        acting: (speed [rad/s], start [s], step [s], rise of the recorded surroundings [K], rises of `FOLLOWED` (4) [K],
            temperature at the start [degC], parameters) -> (conductances of `PATHS`, inputs of `INPUTS`).
        factors: (rises of `FOLLOWED`, temperature at the start, parameters) -> factors on the nut's load torque, on its
            viscous torque, on that of the bearings.
        sensing: (time [s], parameters) -> (growth of the frame at `growth_places` [m], lags by channel and effect [s],
            conductance and capacity of each attached body [W/K, J/K]).
        lagging: channel to the rows of `sensing`'s lags.
        bodies: labels of the effects that attach one.
        follows: whether heats depend on `FOLLOWED`.
    """

    names: tuple[str, ...]
    acting: ca.Function
    factors: ca.Function
    sensing: ca.Function
    lagging: Mapping[str, tuple[int, ...]]
    bodies: tuple[str, ...]
    follows: bool


def growth_places(heat: Heat) -> dict[str, float]:
    """Growths that the network gives, and where the nut is then [m]."""
    return {growth_name(x): x for x in heat.rig.growth_positions} | {END: heat.rig.length}


def channels(heat: Heat) -> tuple[str, ...]:
    """Channels of sensors that may lag."""
    return tuple(dict.fromkeys(e.place for e in heat.effects if e.place_key == "channel"))


def groups_of(heat: Heat) -> Groups:
    """Parameters by group: those that the file declares, then those of its effects."""
    seats = {"front_film": heat.rig.front.film or 0.0, "rear_film": heat.rig.rear.film or 0.0}
    frictions = {"nut": heat.nut, "front_bearing": heat.front, "rear_bearing": heat.rear}
    declared = {name: vars(friction) for name, friction in frictions.items() if friction is not None}
    own = {effect.label: effect.values for effect in heat.effects}
    return {"film": vars(heat.films), "contact": {"conductance": heat.contact, **seats}, **declared, **own}


def values_of(heat: Heat) -> FloatArray:
    """Parameters of `Laws.names`."""
    found: list[float] = []
    for group in groups_of(heat).values():
        for value in group.values():
            found += value if isinstance(value, tuple) else [float(value)]
    return np.array(found)


def laws_of(heat: Heat) -> Laws:
    """The laws of a plant; plants that differ in values alone share them."""
    lengths = tuple(
        (name, key, len(value) if isinstance(value, tuple) else 0)
        for name, group in groups_of(heat).items()
        for key, value in group.items()
    )
    forms = tuple((effect.name, effect.place) for effect in heat.effects)
    joined = () if heat.coupling is None else (heat.coupling, heat.preload, heat.ambient, heat.rig)
    return _laws((lengths, forms, joined, tuple(heat.rig.growth_positions), heat.rig.length), Holder(heat))


@lru_cache(maxsize=128)
def _laws(_: tuple[object, ...], holder: Holder[Heat]) -> Laws:
    with SYMBOLS.taken():
        return _made(holder.held)


def _made(heat: Heat) -> Laws:
    groups, names = _symbols(groups_of(heat))
    columns = ca.vertcat(*[symbol for group in groups.values() for symbol in group.values()])
    given = {name: ca.SX.sym(name) for name in ("speed", "start", "step", "air", "cold")}
    rises = ca.SX.sym("rises", len(FOLLOWED))
    turning = ca.fabs(given["speed"])
    run = Operation(turning, given["start"], given["step"], _bearing(heat, groups, turning))
    g = _conductances(heat, groups, run)
    u = _inputs(heat, groups, run, given["air"], dict(zip(FOLLOWED, ca.vertsplit(rises), strict=True)), given["cold"])
    arguments = [given["speed"], given["start"], given["step"], given["air"], rises, given["cold"], columns]
    shown = [
        ca.densify(ca.vertcat(*[g[path] for path in PATHS])),
        ca.densify(ca.vertcat(*[u[name] for name in INPUTS])),
    ]
    acting = ca.Function("heat_laws", arguments, shown, [*[*given][:4], "rises", "cold", "p"], ["g", "u"])
    named = dict(zip(FOLLOWED, ca.vertsplit(rises), strict=True))
    factors = ca.Function(
        "heat_factors", [rises, given["cold"], columns], [ca.vertcat(*_factors(heat, groups, named, given["cold"]))]
    )
    sensing, lagging, bodies = _sensing(heat, groups, columns)
    return Laws(names, acting, factors, sensing, lagging, bodies, bool(ca.depends_on(shown[1], rises)))


def _symbols(groups: Groups) -> tuple[dict[str, dict[str, Expression]], tuple[str, ...]]:
    symbols: dict[str, dict[str, Expression]] = {}
    names: list[str] = []
    for name, group in groups.items():
        symbols[name] = {}
        for key, value in group.items():
            length = len(value) if isinstance(value, tuple) else 1
            symbols[name][key] = ca.SX.sym(f"{name}.{key}", length)
            names += [f"{name}.{key}[{i}]" for i in range(length)] if isinstance(value, tuple) else [f"{name}.{key}"]
    return symbols, tuple(names)


def _bearing(heat: Heat, groups: Mapping[str, Mapping[str, Expression]], speed: Expression) -> Expression:
    """Torque of the front bearing, as declared [N m]."""
    return reference_torque(speed) if heat.front is None else torque_law(speed, groups["front_bearing"])


def _conductances(heat: Heat, groups: Mapping[str, Mapping[str, Expression]], run: Operation) -> dict[Path, Expression]:
    contact = groups["contact"]
    found: dict[Path, Expression] = {
        Path.CONTACT: contact["conductance"],
        Path.SCREW_FILM: film_on_screw(run.speed, groups["film"]),
        Path.NUT_FILM: film_on_nut(run.speed, groups["film"]),
        Path.FRONT_FILM: contact["front_film"],
        Path.REAR_FILM: contact["rear_film"],
        Path.COOLING: ca.SX(0),
    }
    films = {Path.SCREW_FILM: "screw", Path.NUT_FILM: "nut", Path.FRONT_FILM: FRONT, Path.REAR_FILM: REAR}
    for effect in heat.effects:
        p = groups[effect.label]
        for path, film in films.items():
            found[path] *= effect.film_factor(film, p)
        found[Path.CONTACT] *= effect.contact_factor(p)
        found[Path.COOLING] += effect.coolant_conductance(run, p)
    return found


def _inputs(
    heat: Heat,
    groups: Mapping[str, Mapping[str, Expression]],
    run: Operation,
    air: Expression,
    rises: Mapping[str, Expression],
    cold: Expression,
) -> dict[str, Expression]:
    load, oil, bearing_oil = _factors(heat, groups, rises, cold)
    found: dict[str, Expression] = {AMBIENT: air, FRONT: ca.SX(0), REAR: ca.SX(0)}
    for effect in heat.effects:
        p = groups[effect.label]
        found[AMBIENT] += effect.surroundings(run, p)
        for place, power in effect.heats(run, p).items():
            found[place] += power
    rubbing = {
        NUT: ("nut", load, oil),
        FRONT: ("front_bearing", 1, bearing_oil),
        REAR: ("rear_bearing", 1, bearing_oil),
    }
    for place, (group, by_load, by_oil) in rubbing.items():
        if group in groups:
            torque = torque_law(run.speed, groups[group], by_load, by_oil)
            found[place] = found.get(place, 0) + groups[group]["heat_share"] * run.speed * torque
    return found


def _factors(
    heat: Heat,
    groups: Mapping[str, Mapping[str, Expression]],
    rises: Mapping[str, Expression],
    cold: Expression,
) -> tuple[Expression, Expression, Expression]:
    """On the nut's load torque, on its viscous torque, on that of the bearings."""
    load, oil, bearing_oil = ca.SX(1), ca.SX(1), ca.SX(1)
    joined = heat.coupling
    if joined is not None:
        steel, diameter = heat.rig.steel, 2 * heat.rig.radius
        share = 1 + joined.preload_slope(heat.preload, diameter, steel.expansion) * (rises[NUT] - rises[SHAFT])
        mean = (1 - joined.rear_share) * rises[FRONT] + joined.rear_share * rises[REAR]
        load = ca.fmax(share, 0)
        oil = viscous_share(joined.nut_oil, cold + rises[NUT], heat.ambient)
        bearing_oil = viscous_share(joined.bearing_oil, cold + mean, heat.ambient)
    for effect in heat.effects:
        p = groups[effect.label]
        load *= effect.load_factor(rises[NUT], p)
        oil *= effect.viscous_factor(rises[NUT], p)
    return load, oil, bearing_oil


def _sensing(
    heat: Heat, groups: Mapping[str, Mapping[str, Expression]], columns: Expression
) -> tuple[ca.Function, dict[str, tuple[int, ...]], tuple[str, ...]]:
    time = ca.SX.sym("time")
    frame = [
        sum((effect.growth(x, time, groups[effect.label]) for effect in heat.effects), ca.SX(0))
        for x in growth_places(heat).values()
    ]
    lags: list[Expression] = []
    lagging: dict[str, tuple[int, ...]] = {}
    for channel in channels(heat):
        own = [e.lag(channel, groups[e.label]) for e in heat.effects if e.place == channel]
        lagging[channel] = tuple(range(len(lags), len(lags) + len(own)))
        lags += own
    bodies = {e.label: e.attached(groups[e.label]) for e in heat.effects}
    held = {label: body for label, body in bodies.items() if body is not None}
    shown = [ca.vertcat(ca.SX.zeros(0, 1), *of) for of in (frame, lags, [v for body in held.values() for v in body])]
    function = ca.Function(
        "heat_sensing", [time, columns], [ca.densify(one) for one in shown], ["time", "p"], ["frame", "lags", "bodies"]
    )
    return function, lagging, tuple(held)
