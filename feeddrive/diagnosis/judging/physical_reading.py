"""What a sign and a size mean on a machine: one sentence per effect."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from feeddrive.effects.base import Effect, Value
from feeddrive.units.quantity import percent


def physical_reading(effect: Effect) -> str:
    """The physical reading of an effect's sign and size."""
    if effect.name in READINGS_AT:
        return READINGS_AT[effect.name](effect.place, effect.values)
    return READINGS[effect.name](effect.values)


def _signed(value: Value, positive: str, negative: str) -> str:
    return positive if isinstance(value, float | int) and value > 0 else negative


def _coulomb_asymmetry(v: Mapping[str, Value]) -> str:
    return _signed(
        v["delta_force"],
        "Friction is higher when the table moves in + direction: a one-sided preload, wiper or cover.",
        "Friction is higher when the table moves in − direction: a one-sided preload, wiper or cover.",
    )


def _viscous_asymmetry(v: Mapping[str, Value]) -> str:
    return _signed(
        v["delta_viscous"],
        "Drag rises faster with speed in + direction.",
        "Drag rises faster with speed in − direction, and more slowly in + direction.",
    )


def _stribeck(v: Mapping[str, Value]) -> str:
    return _signed(
        v["delta_force"],
        "Friction is higher near rest than in motion: mixed lubrication below the Stribeck velocity.",
        "Friction is lower near rest than the declared Coulomb level: the level was read at speed and does not hold "
        "below the Stribeck velocity.",
    )


def _presliding(v: Mapping[str, Value]) -> str:
    return (
        "After a reversal the friction builds up over micrometres of travel, as an elastic contact before break-away."
    )


def _friction_vs_position(v: Mapping[str, Value]) -> str:
    if isinstance(v["position"], tuple):
        return "Friction changes along the stroke: rail straightness, alignment of screw and guide, or a cover."
    return _signed(
        v["peak"],
        "A tight place on the stroke: alignment, a damaged rail or a cover that rubs.",
        "A loose place on the stroke: wear, or a rail that gives way.",
    )


def _friction_deviation(v: Mapping[str, Value]) -> str:
    coulomb = v["coulomb_factor"]
    return _signed(
        coulomb - 1 if isinstance(coulomb, float) else 0.0,
        "The declared Coulomb friction is too low for this machine: more preload, drier seals, or a cold start.",
        "The declared Coulomb friction is too high for this machine: run in, less preload, or warm.",
    )


def _load_dependent_friction(v: Mapping[str, Value]) -> str:
    bend = _one(v["bend"])
    where = f" at {_one(v['at_force']):.3g} N, going with the power {1 + bend:.2f} of the load" if bend else ""
    cause = "sliding" if not bend else "rolling" if bend > 0 else "friction that the load saturates"
    return (
        f"The screw loses {percent(_one(v['coefficient']), 2)} of the torque that the load takes{where}: {cause} in "
        "the nut, which an efficiency declared too high leaves out."
    )


def _declared_friction(v: Mapping[str, Value]) -> str:
    return "Friction that the plant itself declares."


def _table(v: Mapping[str, Value]) -> str:
    return "What no named effect explains, carried as a table: look for what follows its variable."


def _torque_ripple(v: Mapping[str, Value]) -> str:
    order = v["order"]
    near = isinstance(order, float) and math.isclose(order, round(order), abs_tol=0.02) and round(order) > 0
    cause = "cogging, pole pairs, or current offset" if near else "not an integer: rolling elements or a gear"
    return f"Locked to the motor angle, {_periods(order)} per revolution ({cause})."


def _periods(order: Value) -> str:
    count = f"{_one(order):.4g}"
    return f"{count} period{'' if count == '1' else 's'}"


def _constant_force(v: Mapping[str, Value]) -> str:
    return _signed(
        v["force"],
        "A force pulls the table in − direction: gravity, a counterbalance, a cable, or an offset of the drive.",
        "A force pulls the table in + direction: gravity, a counterbalance, a cable, or an offset of the drive.",
    )


def _backlash(v: Mapping[str, Value]) -> str:
    return "Free play between screw and table: a worn nut, a loose bearing or coupling."


def _lead_error(v: Mapping[str, Value]) -> str:
    return f"Travel error locked to the screw angle, {_periods(v['order'])} per revolution: wobble, or pitch error."


def _ball_pass_ripple(v: Mapping[str, Value]) -> str:
    return f"The drag of the screw changes with its angle, {_periods(v['order'])} per revolution: balls passing."


def _position_spring(v: Mapping[str, Value]) -> str:
    return _signed(
        v["stiffness"],
        "A force draws the table back to one place: cable chain, bellows or hoses.",
        "A force drives the table away from one place: a counterbalance or a spring past its dead point.",
    )


def _lead_error_cumulative(v: Mapping[str, Value]) -> str:
    return _signed(
        v["slope"],
        "The screw's travel is longer than its nominal lead: warm, or made so.",
        "The screw's travel is shorter than its nominal lead: stretched less than meant, or made so.",
    )


def _thermal_growth(v: Mapping[str, Value]) -> str:
    return _signed(
        v["strain"],
        f"The screw grows while it is recorded, about {_one(v['strain']) / 11.7e-6:.2g} K of warming in steel.",
        f"The screw shrinks while it is recorded, about {-_one(v['strain']) / 11.7e-6:.2g} K of cooling in steel.",
    )


def _viscous_warmup(v: Mapping[str, Value]) -> str:
    return _signed(
        v["share"],
        "The viscous drag falls while the axis runs: the lubricant warms.",
        "The viscous drag rises while the axis runs: fresh grease, or cooling.",
    )


def _stiffness_deviation(place: str, v: Mapping[str, Value]) -> str:
    factor = _one(v["factor"])
    if place in _SOFT_PARTS:
        part, cause = _SOFT_PARTS[place]
        statement = f"The {part} has {percent(factor)} of the declared stiffness"
        if place == "nut":  # Hertz: the stiffness of a preloaded nut goes with the cube root of its preload
            cause += f" (by preload alone, {percent(factor**3)} of it)"
        return f"{statement}{f': {cause}' if factor < 1 else ''}."
    return _signed(
        _one(v["factor"]) - 1,
        "The drive is stiffer along its axis than declared.",
        "The drive is softer along its axis than declared: bearing, bracket or nut, or less preload.",
    )


_SOFT_PARTS = {
    "nut": ("nut", "worn balls or grooves, less preload"),
    "bearing": ("bearing at the motor's end", "less preload, a loose bracket"),
    "far_bearing": ("bearing at the far end", "less preload or stretch of the screw, a loose bracket"),
    "drive": ("drive between motor and screw", "coupling or belt, a loose hub"),
    "screw": ("screw", "another diameter"),
}
"""Part to what it is called, and what makes it softer."""


def _stiffness_vs_position(v: Mapping[str, Value]) -> str:
    share = _one(v["share_over_stroke"])
    middle = _one(v["middle_compliance"])
    where, side = "falls" if share > 0 else "rises", "more" if middle > 0 else "less"
    along = (
        f"The axial stiffness {where} by {percent(abs(share))} from {1e3 * _one(v['low']):.0f} mm to "
        f"{1e3 * _one(v['high']):.0f} mm"
    )
    if not middle:
        return f"{along}: the free length of a screw held at one end, or a bearing that is not the one declared."
    return (
        f"{along}, and halfway the drive gives way by {percent(abs(middle))} {side} than a straight line between them: "
        "the free length of a screw that both ends hold, or a bearing that is not the one declared."
    )


def _preload_loss(v: Mapping[str, Value]) -> str:
    return (
        f"Below {_one(v['force']):.3g} N the drive gives way {1 / _one(v['ratio']):.2g} times as much as declared: nut "
        "or bearing have lost preload, without free play yet."
    )


def _structural_mode(v: Mapping[str, Value]) -> str:
    return (
        f"{_one(v['mass']):.3g} kg on the table swing at {_one(v['frequency']):.3g} Hz: fixture, spindle head, tank or "
        "cover that is not fixed firmly."
    )


def _one(value: Value) -> float:
    return value[0] if isinstance(value, tuple) else value


def _convection(v: Mapping[str, Value]) -> str:
    return _signed(
        _one(v["factor"]) - 1,
        "More heat goes to the air than declared: draught, a fan, a cover taken off.",
        "Less heat goes to the air than declared: covers, still air, dirt.",
    )


def _contact(v: Mapping[str, Value]) -> str:
    return _signed(
        _one(v["factor"]) - 1,
        "Nut and screw are tied more closely than declared: more preload, more grease.",
        "Nut and screw are tied more loosely than declared: less preload, fewer balls under load.",
    )


def _preload_growth(v: Mapping[str, Value]) -> str:
    return _signed(
        v["coefficient"],
        "The nut grows against the screw as it warms, and its load torque with it: watch the preload when hot.",
        "The load torque falls as the nut warms: the screw grows less than the nut and the preload is lost.",
    )


def _ambient_drift(v: Mapping[str, Value]) -> str:
    seen = "The air at the machine is not what was recorded: move the sensor, or look for sun, doors, a warm cabinet."
    return _signed(v["amplitude"], seen, seen)


def _motor_heat(v: Mapping[str, Value]) -> str:
    return f"The motor heats the end of the screw, {percent(_one(v['share_at_rest']))} of it whatever the speed."


def _bearing_heat(v: Mapping[str, Value]) -> str:
    front, share = _one(v["factor"]), _one(v["rear_share"])
    return (
        f"The bearings rub: {front:.2g} times the heat that the plant declares for its front bearing comes on top of "
        f"it at the front and {front * share:.2g} times at the rear. A plant that declares none is counted by a small "
        "bearing in an oil bath, 0.31 W at 750 rev/min."
    )


def _structure_growth(v: Mapping[str, Value]) -> str:
    return (
        "The frame or the scale's carrier grows: the table is read elsewhere, beyond what the screw's warmth explains."
    )


def _sensor_lag(v: Mapping[str, Value]) -> str:
    return "The sensor follows late: a thick pocket, little paste, a filter."


def _cooling(v: Mapping[str, Value]) -> str:
    return f"From {_one(v['start']) / 60:.0f} min on something cools the nut."


def _heat_sink(v: Mapping[str, Value]) -> str:
    return "A mass on the nut takes up heat and gives it back: housing, bracket or table, which the plant leaves out."


def _viscosity_temperature(v: Mapping[str, Value]) -> str:
    return "The viscous torque of the nut falls as its grease warms."


def _payload(v: Mapping[str, Value]) -> str:
    return _signed(
        v["mass"], "The table is heavier than declared.", "The table is lighter than declared, or an inertia is."
    )


def _drive_delay(v: Mapping[str, Value]) -> str:
    return _signed(
        v["delay"],
        "The torque acts later than it is recorded: current loop and dead time. Motor angle and table position, both "
        "read late by as much, would look the same.",
        "The torque is recorded later than it acts: the channel is filtered or sampled late.",
    )


def _channel_delay(channel: str, v: Mapping[str, Value]) -> str:
    late = f"{1e6 * _one(v['delay']):.3g} µs"
    causes = {
        "motor_torque": "filtered for display, or sent a bus cycle late",
        "motor_angle": "interpolated or sent late by the drive; or what else is recorded comes from a faster input",
        "table_position": "read by another card or clock, or filtered by the scale's interpolator",
    }
    return f"The channel {channel} is recorded {late} later than the others: {causes[channel]}."


def _inertia_deviation(where: str, v: Mapping[str, Value]) -> str:
    parts = {"motor": "rotor, brake, coupling half or pulley", "screw": "screw, its coupling half, or a rotating nut"}
    more = _signed(v["inertia"], "more", "less")
    return f"The {where} side turns with {more} inertia than declared: {parts[where]}."


def _torque_constant_droop(v: Mapping[str, Value]) -> str:
    return (
        f"The motor gives {percent(_one(v['share']), 2)} less than constant times current at "
        f"{_one(v['at_torque']):.3g} N m: its iron saturates."
    )


READINGS_AT: dict[str, Callable[[str, Mapping[str, Value]], str]] = {
    "channel_delay": _channel_delay,
    "inertia_deviation": _inertia_deviation,
    "stiffness_deviation": _stiffness_deviation,
}
"""Effect name to the reading of its place and values."""

READINGS: dict[str, Callable[[Mapping[str, Value]], str]] = {
    "coulomb_asymmetry": _coulomb_asymmetry,
    "viscous_asymmetry": _viscous_asymmetry,
    "stribeck": _stribeck,
    "presliding": _presliding,
    "friction_vs_position": _friction_vs_position,
    "friction_deviation": _friction_deviation,
    "load_dependent_friction": _load_dependent_friction,
    **dict.fromkeys(("guide_friction", "nut_drag", "bearing_drag", "nut_friction"), _declared_friction),
    **dict.fromkeys(("tabulated_force", "tabulated_torque", "tabulated_friction", "tabulated_travel"), _table),
    "torque_ripple": _torque_ripple,
    "constant_force": _constant_force,
    "backlash": _backlash,
    "lead_error_periodic": _lead_error,
    "payload": _payload,
    "drive_delay": _drive_delay,
    "torque_constant_droop": _torque_constant_droop,
    "ball_pass_ripple": _ball_pass_ripple,
    "position_spring": _position_spring,
    "lead_error_cumulative": _lead_error_cumulative,
    "thermal_growth": _thermal_growth,
    "viscous_warmup": _viscous_warmup,
    "stiffness_vs_position": _stiffness_vs_position,
    "preload_loss": _preload_loss,
    "structural_mode": _structural_mode,
    "motor_heat": _motor_heat,
    "bearing_heat": _bearing_heat,
    "ambient_drift": _ambient_drift,
    "preload_growth": _preload_growth,
    "viscosity_temperature": _viscosity_temperature,
    "cooling": _cooling,
    "convection_deviation": _convection,
    "contact_conductance_deviation": _contact,
    "heat_sink": _heat_sink,
    "structure_growth": _structure_growth,
    "sensor_lag": _sensor_lag,
}
"""Effect name to the reading of its values."""
