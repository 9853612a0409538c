"""A plant file from a few wishes: parts of the catalogue, and guesses where nothing was stated, each marked as one.

A guess stands in the file with `source = "guess: ..."`, so that it shows wherever origins are shown, and so that a
diagnosis takes it for as uncertain as it is.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

from feeddrive.errors import InputError
from feeddrive.parts.bearings.supports import Support
from feeddrive.parts.catalogue.part_choice import away, chosen_motor, chosen_screw, newton, of_kind
from feeddrive.parts.catalogue.part_files import CataloguePart, catalogue, find_part
from feeddrive.parts.screw.screw_efficiency import ideal_torque
from feeddrive.plant.file.guide_section import CARRIAGES, TURNING
from feeddrive.schema.toml_text import nearest_choice
from feeddrive.units.quantity import format_quantity, parse

STRUCTURES = ("distributed_screw", "three_inertias")
"""Structures that a machine of parts can have."""

ORIENTATIONS = {"horizontal": 0.0, "vertical": math.pi / 2}
_CLEARANCE = 0.1
"""Distance of the nut's centre from either bearing at the ends of the stroke [m]: half a nut, a bearing, a bumper."""
_EFFICIENCY = 0.95
"""Efficiency of a ball screw; the preload torque follows: (1/eta - eta) F L / 2 pi (`parts.screw.preload_torque`)."""
_PRELOAD_SHARE = 0.05
"""Preload over the dynamic rating: half of what catalogues call the maximum possible preload."""
_JOURNAL = 0.75
"""Greatest bore of a support bearing over the root diameter, so that the shoulder carries the inner ring."""


@dataclass(frozen=True)
class Wishes:
    """What is asked for; a field that is empty is chosen, and marked as a guess.

    Attributes:
        screw: name of the catalogue, or size such as "32 x 10 mm".
        motor: name, or rated power such as "400 W".
        mass: of the table, with its load [kg].
        stroke, length: of the table, of the screw between its bearings [m]; one of them is enough.
        guide: name, or size of the rail such as "25".
        carriages: how many.
        preload: of the nut [N].
        supports: kind, "fixed-supported" and the like.
        bearing: name.
        coupling: name.
        orientation: "horizontal" or "vertical", + upward.
        structure: of `STRUCTURES`.
        name: of the machine.
    """

    screw: str = ""
    motor: str = ""
    mass: float | None = None
    stroke: float | None = None
    length: float | None = None
    guide: str = ""
    carriages: int = 4
    preload: float | None = None
    supports: str = ""
    bearing: str = ""
    coupling: str = ""
    orientation: str = "horizontal"
    structure: str = "distributed_screw"
    name: str = "my axis"


@dataclass
class Drafted:
    """What is written: section to key to value, and what of it is a guess.

    Attributes:
        sections: in the order of the file; "effect" holds a list.
        guesses: dotted key to why this value.
        remarks: section to what it is, for the comment above it.
    """

    sections: dict[str, Any] = field(default_factory=dict)
    guesses: dict[str, str] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)

    def guess(self, section: str, key: str, value: str | float, why: str) -> None:
        """Put in a value that nobody gave."""
        self.sections.setdefault(section, {})[key] = {"value": value, "source": f"guess: {why}"}
        self.guesses[f"{section}.{key}"] = why


RESOLUTIONS = {
    "motor_angle.resolution": ("6e-6 rad", "20 bit"),
    "table_position.resolution": ("10 nm", "a fine linear scale"),
}
"""Of encoder and scale: value, and why; the catalogue holds none."""


def drafted(wishes: Wishes) -> Drafted:
    """The parts and values of an axis.

    Raises:
        InputError: screw, motor, mass, or both stroke and length are missing; a part that the catalogue does not hold.
    """
    _refuse_missing(wishes)
    made = Drafted()
    (motor, why_motor), (screw, why_screw) = chosen_motor(wishes.motor), chosen_screw(wishes.screw)
    made.guesses |= {key: why for key, why in (("motor.part", why_motor), ("ball_screw.part", why_screw)) if why}
    made.sections["motor"] = {"part": motor.name}
    made.remarks["motor"] = motor.size
    _coupling(wishes, motor, made)
    _shaft(wishes, screw, made)
    _supports(wishes, screw, made)
    preload = _nut(wishes, screw, made)
    _table(wishes, made)
    _guide(wishes, made)
    made.guess("damping", "ratio", 0.02, "steel parts with rolling contacts, 0.01 to 0.05")
    _drags(made, screw, preload)
    made.guesses |= {key: why for key, (_, why) in RESOLUTIONS.items()}
    return made


def _refuse_missing(wishes: Wishes) -> None:
    for value, name, example in (
        (wishes.screw, "screw", "'32 x 10 mm', or a name that `feeddrive parts screw` lists"),
        (wishes.motor, "motor", "'400 W', or a name that `feeddrive parts motor` lists"),
        (wishes.mass, "mass", "'80 kg', table and load"),
        (wishes.stroke or wishes.length, "stroke", "'800 mm', or --length of the screw"),
    ):
        if not value:
            raise InputError(f"no {name} is given", f"--{name}", f"write --{name} {example}")
    for word, words, name in (
        (wishes.orientation, tuple(ORIENTATIONS), "orientation"),
        (wishes.structure, STRUCTURES, "structure"),
        (wishes.supports or Support.FIXED_FREE.value, tuple(kind.value for kind in Support), "supports"),
    ):
        if word not in words:
            raise InputError(f'"{word}" is not possible', f"--{name}", nearest_choice(word, words))


def _coupling(wishes: Wishes, motor: CataloguePart, made: Drafted) -> None:
    if wishes.coupling:
        part = find_part(wishes.coupling, "coupling", "--coupling")
    else:
        peak = parse(motor.sections["motor"]["torque_limit"], "N m", motor.name)
        strong = [one for one in of_kind("coupling") if parse(one.further["rated_torque"], "N m", "") >= peak]
        part = min(strong, key=lambda one: parse(one.further["rated_torque"], "N m", ""))
        why = f"{part.name}, the smallest that carries the motor's peak torque"
        made.guesses["coupling.part"] = why
    made.sections["coupling"] = {"part": part.name}
    made.remarks["coupling"] = part.size


def _shaft(wishes: Wishes, screw: CataloguePart, made: Drafted) -> None:
    made.sections["ball_screw"] = {"part": screw.name}
    made.remarks["ball_screw"] = screw.size
    if wishes.length is not None:
        made.sections["ball_screw"]["length"] = _written(wishes.length, "mm")
    else:
        assert wishes.stroke is not None
        length = _written(wishes.stroke + 2 * _CLEARANCE, "mm")
        made.guess("ball_screw", "length", length, "the stroke and 100 mm beyond either end")


def _supports(wishes: Wishes, screw: CataloguePart, made: Drafted) -> None:
    kind = Support(wishes.supports or Support.FIXED_SUPPORTED)
    made.sections["support"] = {"kind": kind.value}
    if not wishes.supports:
        made.guesses["support.kind"] = f"{kind.value}, the usual one"
    root = parse(screw.sections["ball_screw"]["root_diameter"], "m", screw.name)
    if wishes.bearing:
        part = find_part(wishes.bearing, "bearing", "--bearing")
    else:
        seated = [one for one in of_kind("bearing") if parse(one.further["bore"], "m", "") <= _JOURNAL * root]
        part = max(seated or of_kind("bearing")[:1], key=lambda one: parse(one.further["bore"], "m", ""))
        made.guesses["bearing.near.part"] = f"{part.name}, the widest whose shoulder the screw can carry"
    made.sections["bearing.near"] = {"part": part.name}
    made.remarks["bearing.near"] = part.size
    if kind.far_end_takes_force:
        made.sections["bearing.far"] = {"part": part.name}


def _nut(wishes: Wishes, screw: CataloguePart, made: Drafted) -> float:
    """The nut; its preload [N]."""
    rating = newton(screw, "ball_screw", "dynamic_rating")
    preload = wishes.preload if wishes.preload is not None else _PRELOAD_SHARE * rating
    if "nut" in screw.sections:
        made.sections["nut"] = {"part": screw.name}
        if wishes.preload is not None:
            made.sections["nut"]["preload"] = _written(preload, "N")
        else:
            made.guess("nut", "preload", _written(preload, "N"), "5 % of the dynamic rating")
        return preload
    like = min((one for one in of_kind("screw") if "nut" in one.sections), key=lambda one: _unlike(one, screw))
    stiffness = 0.4 * parse(like.sections["nut"]["catalogue_stiffness"], "N/m", like.name)
    why = f"of this nut nothing is printed; half of what {like.name} really has, for a single nut"
    made.guess("nut", "axial_stiffness", format_quantity(stiffness, "N/m"), why)
    return 0.0


def _unlike(one: CataloguePart, other: CataloguePart) -> float:
    size = parse(other.further["nominal_diameter"], "m", "")
    lead = parse(other.sections["ball_screw"]["lead"], "m", "")
    ratings = newton(one, "ball_screw", "dynamic_rating") / newton(other, "ball_screw", "dynamic_rating")
    return away(one, size, lead) + 0.1 * abs(math.log(ratings))


def _table(wishes: Wishes, made: Drafted) -> None:
    assert wishes.mass is not None
    made.sections["table"] = {"mass": _written(wishes.mass, "kg")}
    if wishes.stroke is not None:
        stroke = wishes.stroke
        made.sections["table"]["stroke"] = ["0 mm", _written(stroke, "mm")]
    else:
        assert wishes.length is not None
        stroke = wishes.length - 2 * _CLEARANCE
        if stroke <= 0:
            raise InputError("the screw is too short for a stroke", "--length", "write the --stroke too")
        made.sections["table"]["stroke"] = ["0 mm", _written(stroke, "mm")]
        made.guesses["table.stroke"] = "the screw less 100 mm at either end"
    length = wishes.length if wishes.length is not None else stroke + 2 * _CLEARANCE
    if length < stroke:
        raise InputError("the stroke is longer than the screw", "--stroke", "write a longer --length")
    first = _written(0.5 * (length - stroke), "mm")
    made.guess("table", "first_nut_position", first, "the stroke in the middle of the screw")
    if ORIENTATIONS[wishes.orientation]:
        made.sections["table"]["inclination"] = "90 deg"


def _guide(wishes: Wishes, made: Drafted) -> None:
    name = wishes.guide
    if not name:
        name = "25"
        made.guesses["guide.carriage"] = "rails of size 25"
    name = re.sub(r"(?<=\d)\s*mm$", "", name)
    if name.isdecimal():
        sized = [one for one in of_kind("guide") if one.further["rail"] == int(name)]
        known = [one for one in sized if "dynamic_rating" in one.further]
        if not known:
            rails = sorted({one.further["rail"] for one in of_kind("guide")})
            mend = f"write one of {', '.join(map(str, rails))}, or a name that `feeddrive parts guide` lists"
            raise InputError(f"the catalogue holds no carriage of size {name}", "--guide", mend)
        part = max(known, key=lambda one: parse(one.further["static_rating"], "N", ""))
        others = ", ".join(one.name for one in sized if one is not part)
        made.guesses["guide.carriage"] = f"{part.name}, the strongest of size {name}; also {others}"
    elif name in CARRIAGES:
        made.sections["guide"] = {"carriage": name, "carriages": wishes.carriages}
        made.guess("guide", "seal_drag", "6 N", "no more than the size is known of its seals")
        return
    else:
        part = find_part(
            name, "guide", "--guide", f"of {', '.join(CARRIAGES)} the geometry is known; or write one in [guide]"
        )
    made.sections["guide"] = {"carriage": part.name, "carriages": wishes.carriages}
    made.remarks["guide"] = part.size
    if "dynamic_rating" not in part.further:
        static = parse(part.further["static_rating"], "N", part.name)
        made.guess("guide", "preload", _written(0.005 * static, "N"), "0.5 % of the static rating, a light preload")


def _drags(made: Drafted, screw: CataloguePart, preload: float) -> None:
    """Drag of nut and bearings."""
    lead = parse(screw.sections["ball_screw"]["lead"], "m", screw.name)
    torque = (1 / _EFFICIENCY - _EFFICIENCY) * float(ideal_torque(preload, lead))
    near = catalogue()[made.sections["bearing.near"]["part"]]
    printed = near.further.get("starting_torque")
    turning = f"{TURNING / (lead / (2 * math.pi)):.3g} rad/s"  # where the guide turns, seen at the screw
    made.sections["effect"] = []
    if torque > 0:
        why = f"preload torque of a screw with an efficiency of {_EFFICIENCY:g}"
        made.sections["effect"].append(_drag("nut_drag", torque, turning, f"guess: {why}"))
        made.guesses["nut_drag.coulomb"] = why
    if printed is not None:
        start = (2 if "bearing.far" in made.sections else 1) * parse(printed, "N m", near.name)
        made.sections["effect"].append(_drag("bearing_drag", start, turning, f"starting torque, {near.origin}"))


def _drag(name: str, torque: float, turning: str, source: str) -> dict[str, Any]:
    coulomb = {"value": format_quantity(torque, "N m"), "source": source}
    return {"name": name, "coulomb": coulomb, "smoothing_speed": turning}


def _written(value: float, unit: str) -> str:
    """A value as people write it, in a unit of lengths, masses or forces."""
    factor = {"mm": 1e3, "kg": 1.0, "N": 1.0}[unit]
    return f"{value * factor:.6g} {unit}"
