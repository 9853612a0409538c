"""Words for people: what effects, parameters, channels and variables of the catalogue are called in a report."""

from __future__ import annotations

import math

from feeddrive.effects.base import Effect
from feeddrive.effects.catalogue import EFFECTS, THERMAL_EFFECTS

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
    known = _known(name)
    return known.words if known is not None and known.words else plain(name)


def _known(name: str) -> type[Effect] | None:
    return EFFECTS.get(name) or THERMAL_EFFECTS.get(name)


def variable_words(name: str) -> str:
    """What a measured variable is called."""
    return _VARIABLES.get(name, plain(name))


def headline_parameters(name: str, keys: list[str]) -> list[str]:
    """Parameter keys that the verdict names for an effect: those of its card, else the first one there is."""
    known = _known(name)
    return [key for key in (known.headline if known is not None else ()) if key in keys] or keys[:1]


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
