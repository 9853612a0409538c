"""The [guide] of a plant file: which carriages, how many, what loads them, and the friction that follows.

[guide]
carriage = "HSR-30R"            # a known one, or its geometry in place of the name:
ball_diameter = "5.556 mm"
rail_conformity = 0.52          # groove radius over ball diameter
carriage_conformity = 0.52
contact_angle = "45 deg"
preload_oversize = "5 µm"       # ball oversize; 0 for none
balls_per_row = 12              # under load
carriages = 4
seal_drag = "6 N"               # of one carriage; may be left out
load = "500 N"                  # vertical load of one carriage; may be left out: the table's weight, shared evenly
coefficients = "A"              # of rolling and slip: set A or B; may be left out
smoothing_velocity = "0.5 mm/s" # may be left out
friction_factor = 1.1           # level that acts over the computed one, as a recording told it; may be left out

or a carriage of the catalogue, whose geometry is not published (`feeddrive.parts.guide.guide_rating`):

carriage = "HGH25HA"
carriages = 4
preload_class = "Z0"            # may be left out: the lightest
preload = "420 N"               # in place of that of the class
friction_coefficient = 0.004    # as seal_drag, load and smoothing_velocity: may be left out

Effects that follow from what a plant file says of table and guide: weight, counterbalance, friction of carriages.

F = M g sin(inclination) - counterbalance                 weight, positive resists + motion
guide_friction of `carriages` ball carriages              see `feeddrive.plant.file.guide_section`
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from feeddrive.effects.base import Effect
from feeddrive.effects.friction.guide_friction import GuideFriction, guide_effect
from feeddrive.effects.source.weight import GRAVITY, Weight
from feeddrive.errors import InputError
from feeddrive.parts.catalogue.part_files import CataloguePart, catalogue, nearest_names
from feeddrive.parts.guide.guide_coefficients import SET_A, SET_B
from feeddrive.parts.guide.guide_geometry import GUIDE_VALUES, HSR_20R, HSR_30R, BallGuide
from feeddrive.parts.guide.guide_rating import Carriages, RatedCarriage, RollingCarriage, rated_friction
from feeddrive.plant.file.drive_sections import placed
from feeddrive.plant.file.effect_sections import next_label
from feeddrive.schema.table import Table
from feeddrive.units.quantity import format_quantity, parse

CARRIAGES = {"HSR-20R": HSR_20R, "HSR-30R": HSR_30R}
"""Carriages whose geometry is published, by their name."""

COEFFICIENTS = {"A": SET_A, "B": SET_B}
_GEOMETRY = tuple(value.key for value in GUIDE_VALUES)
_SHARED = ("carriage", "carriages", "seal_drag", "smoothing_velocity", "load", "source", "friction_factor")
_OF_GEOMETRY = (*_SHARED, "coefficients", *_GEOMETRY)
_OF_RATING = (*_SHARED, "preload_class", "preload", "friction_coefficient")

TURNING = 5e-4
"""Where tanh of the guide friction turns unless it is stated [m/s]."""


def guide_friction_of(top: Table, gravity: float, before: Sequence[Effect]) -> list[tuple[Effect, str]]:
    """The guide friction of a plant file and where it comes from; none without a [guide]; gravity in m/s^2.

    Raises InputError: a value that is missing, without unit or not possible, or friction declared twice, as by the
    effects `before`.
    """
    found = declared_carriages(top, gravity)
    if found is None:
        return []
    table = top.table("guide")
    if any(isinstance(effect, GuideFriction) for effect in before):
        raise InputError("guide and guide_friction are both declared", table.where, "keep one of them")
    turning = table.quantity("smoothing_velocity") if "smoothing_velocity" in table.entries else TURNING
    one, count, load, seal = found.one, found.count, found.load, found.seal_drag
    origin, under = f"computed from {count} carriages {found.name}", format_quantity(load, "N")
    if isinstance(one, RatedCarriage):
        drag = placed(table.where, lambda: rated_friction(load, one.preload, one.friction_coefficient, seal))
        origin += (
            f" under {under} and a preload of {format_quantity(one.preload, 'N')} each; {_rated()[found.name].source}"
        )
        return [(_scaled(GuideFriction.of(coulomb=count * drag, smoothing_velocity=turning), table), origin)]
    effect = placed(table.where, lambda: guide_effect(one.guide, one.coefficients, count, load, seal, turning))
    return [(_scaled(effect, table), f"{origin} with {under} and seals of {format_quantity(seal, 'N')} each")]


def _scaled(effect: GuideFriction, table: Table) -> GuideFriction:
    """The friction that acts: the computed level times what recordings have told of it."""
    factor = table.quantity("friction_factor") if "friction_factor" in table.entries else 1.0
    return effect.with_values(coulomb=factor * float(effect.values["coulomb"]))  # type: ignore[arg-type]


def declared_carriages(top: Table, gravity: float) -> Carriages | None:
    """The carriages of a plant file; None without a [guide]; gravity in m/s^2.

    Raises InputError: a value that is missing, without unit or not possible.
    """
    if "guide" not in top.entries:
        return None
    table = top.table("guide")
    if "carriage" in table.entries and table.text("carriage") in _rated():
        table.refuse_unknown(_OF_RATING)
        part = _rated()[table.text("carriage")]
        count = table.whole("carriages")
        drag = _or_printed(table, "seal_drag", part.sections["guide"]["seal_drag"])
        coefficient = _or_printed(table, "friction_coefficient", part.further["friction_coefficient"])
        load = _load(top, gravity, count)
        return Carriages(part.name, count, load, drag, RatedCarriage(_preload(table, part), coefficient))
    table.refuse_unknown(_OF_GEOMETRY)
    name, guide = _carriage(table)
    coefficients = COEFFICIENTS[table.choice("coefficients")]
    count = table.whole("carriages")
    seal = table.quantity("seal_drag", "N", "guide.seal_drag") if "seal_drag" in table.entries else 0.0
    return Carriages(name, count, _load(top, gravity, count), seal, RollingCarriage(guide, coefficients))


def _carriage(table: Table) -> tuple[str, BallGuide]:
    """Name and geometry: a known carriage, or one whose geometry is written."""
    written = [key for key in _GEOMETRY if key in table.entries]
    if "carriage" in table.entries and written:
        mend = "keep the name of a known carriage, or its geometry"
        raise InputError(f"carriage and {written[0]} are both given", table.where, mend)
    if not written:
        name = table.text("carriage")
        if name not in CARRIAGES:
            raise InputError(f'no carriage "{name}"', table.place("carriage"), _known_carriages(name))
        return name, CARRIAGES[name]
    balls = table.whole("balls_per_row")
    size = {v.key: table.quantity(v.key, v.unit, f"guide.{v.key}") for v in GUIDE_VALUES if v.key != "balls_per_row"}
    return "as written", placed(
        table.where,
        lambda: BallGuide(
            size["ball_diameter"],
            size["rail_conformity"],
            size["carriage_conformity"],
            size["contact_angle"],
            size["preload_oversize"],
            balls,
        ),
    )


def _known_carriages(name: str) -> str:
    """The remedy for an unknown carriage: those that are near, those whose geometry is known, or a geometry."""
    near = ", ".join(nearest_names(name, "guide"))
    guess = f"near in the catalogue are {near}; " if near else ""
    known = f"of {', '.join(CARRIAGES)} the geometry is known"
    return f"{guess}{known}; or write a geometry in place of the name: {', '.join(_GEOMETRY)}"


def _rated() -> Mapping[str, CataloguePart]:
    """Carriages of the catalogue by their name."""
    return {name: part for name, part in catalogue().items() if part.kind == "guide"}


def _preload(table: Table, part: CataloguePart) -> float:
    """Preload of one carriage [N]: written, or that of its class."""
    if "preload" in table.entries:
        return table.quantity("preload", "N", "guide.preload")
    shares = part.further["preload_share"]
    name = table.text("preload_class", next(iter(shares)))
    if name not in shares:
        raise InputError(f'no class "{name}"', table.place("preload_class"), f"write one of {', '.join(shares)}")
    if "dynamic_rating" not in part.further:
        what = f"of {part.name} the catalogue's dynamic rating is not known, of which a preload class is a share"
        raise InputError(what, table.place("preload"), 'write the preload of one carriage, such as preload = "400 N"')
    return float(shares[name] * parse(part.further["dynamic_rating"], "N", part.name))


def _or_printed(table: Table, key: str, printed: object) -> float:
    """A value that is written, or that of the catalogue."""
    if key in table.entries:
        return table.quantity(key, "", f"guide.{key}")
    return parse(printed, "1" if key == "friction_coefficient" else "N", key)


def _load(top: Table, gravity: float, count: int) -> float:
    """Vertical load of one carriage [N]: written, or the table's weight across the guide, shared evenly."""
    guide, table = top.table("guide"), top.table("table")
    if "load" in guide.entries:
        return guide.quantity("load", "N", "guide.load")
    angle = table.quantity("inclination", "rad", "table.inclination") if "inclination" in table.entries else 0.0
    return table.quantity("mass", "kg", "table_mass") * gravity * math.cos(angle) / count


WEIGHT_KEYS = ("inclination", "counterbalance")


def derived_effects(top: Table, before: Sequence[Effect]) -> tuple[Effect, ...]:
    """Weight and guide friction of a plant file, with their origins noted, beside the effects that it declares itself.

    Raises InputError: a value that is missing, without unit or not possible, or friction declared twice.
    """
    made: list[Effect] = []
    for effect, origin in [*_weight(top), *_guide(top, before)]:
        label = next_label(effect.name, [*before, *made])
        for key in effect.values:
            top.origins.found[f"{label}.{key}"] = origin
        made.append(effect)
    return tuple(made)


def _weight(top: Table) -> list[tuple[Effect, str]]:
    table = top.table("table")
    if "inclination" not in table.entries:
        if "counterbalance" in table.entries:
            mend = 'write inclination = "90 deg" for a vertical axis whose + direction is up'
            raise InputError("a counterbalance without inclination", table.place("counterbalance"), mend)
        return []
    angle = table.quantity("inclination", "rad", "table.inclination")
    if abs(angle) > math.pi / 2 + 1e-9:
        mend = "write -90 deg to 90 deg, positive where the + direction points up"
        raise InputError(f"{math.degrees(angle):g} deg is not an inclination", table.place("inclination"), mend)
    held = table.quantity("counterbalance", "N", "table.counterbalance") if "counterbalance" in table.entries else 0.0
    inside = math.copysign(min(abs(angle), math.pi / 2), angle)
    return [(Weight.of(inclination=inside, counterbalance=held), "declared with the table")]


def _guide(top: Table, before: Sequence[Effect]) -> list[tuple[Effect, str]]:
    if "guide" not in top.entries:
        return []
    from feeddrive.plant.file.guide_section import guide_friction_of  # Hertz's contacts take time to import

    return guide_friction_of(top, GRAVITY, before)
