"""Words for people: what effects, parameters, channels and variables of the catalogue are called in a report."""

from __future__ import annotations

import math

_EFFECTS = {
    "coulomb_asymmetry": "Coulomb friction different in the two directions",
    "viscous_asymmetry": "viscous friction different in the two directions",
    "stribeck": "Stribeck friction at low speed",
    "presliding": "presliding (elastic bristles before break-away)",
    "friction_vs_position": "friction that changes along the stroke",
    "viscous_warmup": "viscous drag falling as the lubricant warms",
    "friction_deviation": "friction level other than declared",
    "load_dependent_friction": "friction rising with the transmitted force",
    "torque_ripple": "torque ripple of the motor",
    "ball_pass_ripple": "drag ripple from the balls passing",
    "torque_constant_droop": "torque per ampere falling at high current",
    "constant_force": "constant force (gravity, counterbalance)",
    "position_spring": "spring force on the table (cable chain, bellows)",
    "backlash": "backlash",
    "lead_error_periodic": "periodic lead error",
    "lead_error_cumulative": "cumulative lead error",
    "thermal_growth": "thermal growth of the screw",
    "stiffness_deviation": "axial stiffness other than declared",
    "stiffness_vs_position": "axial stiffness falling along the stroke",
    "preload_loss": "loss of preload",
    "payload": "moving mass other than declared",
    "inertia_deviation": "inertia other than declared",
    "structural_mode": "structural resonance on the table",
    "drive_delay": "delay of the drive's torque",
    "channel_delay": "delay of a recorded channel",
    "motor_heat": "heat from the motor",
    "bearing_heat": "heat from the bearings",
    "ambient_drift": "surroundings other than recorded",
    "preload_growth": "preload torque growing as the nut warms",
    "viscosity_temperature": "viscous torque falling with the nut temperature",
    "cooling": "cooling of the nut",
    "convection_deviation": "convection other than declared",
    "contact_conductance_deviation": "nut to screw contact other than declared",
    "heat_sink": "attached mass taking heat from the nut",
    "structure_growth": "growth of the machine frame under the scale",
    "sensor_lag": "lag of a sensor",
    "tabulated_force": "a force on the table",
    "tabulated_torque": "a torque on a shaft",
    "tabulated_friction": "friction of the table",
    "tabulated_travel": "a travel error",
}

# The parameters that a one-line verdict names; elsewhere all are given.
_HEADLINE = {
    "friction_vs_position": ("peak", "centre"),
    "friction_deviation": ("coulomb_factor", "viscous_factor"),
    "stribeck": ("delta_force", "velocity"),
    "torque_ripple": ("amplitude", "order"),
    "ball_pass_ripple": ("amplitude", "order"),
    "lead_error_periodic": ("amplitude", "order"),
    "viscous_warmup": ("share", "time_constant"),
    "thermal_growth": ("strain", "time_constant"),
    "structural_mode": ("mass", "frequency"),
    "preload_loss": ("ratio", "force"),
    "motor_heat": ("power", "share_at_rest"),
    "bearing_heat": ("factor", "rear_share"),
    "ambient_drift": ("amplitude",),
    "cooling": ("conductance", "start"),
    "heat_sink": ("conductance", "capacity"),
}

_VARIABLES = {
    "table_velocity": "table velocity",
    "table_position": "table position",
    "motor_angle": "motor angle",
    "screw_angle": "screw angle",
    "screw_speed": "speed of the screw",
    "nut_rise": "rise of the nut",
    "ambient_temperature": "surroundings",
    "table_acceleration": "table acceleration",
    "predicted_torque": "torque that the plant predicts",
    "travel_since_reversal": "travel since the last reversal",
    "direction": "the direction",
}
_GLYPHS = "\u00a0√−→αβγδΔηθλµμνπρσΣτφϕψωΩ°"


def plain(name: str) -> str:
    """A catalogue name as words."""
    return " ".join(name.replace("_", " ").split())


def effect_words(name: str) -> str:
    """What an effect is called in a sentence; an effect of no known name keeps its own."""
    return _EFFECTS.get(name, plain(name))


def variable_words(name: str) -> str:
    """What a measured variable is called."""
    return _VARIABLES.get(name, plain(name))


def headline_parameters(name: str, keys: list[str]) -> list[str]:
    """Parameter keys that the verdict names for an effect: those of the table, else the first one there is."""
    wanted = [key for key in _HEADLINE.get(name, ()) if key in keys]
    return wanted or keys[:1]


def joined(items: list[str]) -> str:
    """Items as in a sentence: 'a', 'a and b', 'a, b and c'."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} and {items[-1]}"


def figure_text(text: str) -> str:
    """Text safe inside a figure: no mathematics markup, no glyph that the figure's font lacks."""
    known = (letter if letter in _GLYPHS or (letter.isprintable() and letter < "\u0250") else "?" for letter in text)
    return "".join(known).replace("$", r"\$")


def chain_remark(valid_to: float) -> str:
    """What to know of frequencies beside simulations, whose chain holds up to `valid_to` [Hz]; empty without limit."""
    if not math.isfinite(valid_to):
        return ""
    holds = f"whose modes are within 1 % up to {valid_to:.0f} Hz" if valid_to else "whose first mode is 1 % off or more"
    return f"Within 0.5 %, whatever the elements of the screw. Simulations use the declared chain, {holds}."
