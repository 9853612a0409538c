"""Which part of the catalogue fits a wish: a name, or a size; and which others would do."""

from __future__ import annotations

import math
import re

from feeddrive.errors import InputError
from feeddrive.parts.catalogue.part_files import CataloguePart, catalogue, find_part
from feeddrive.units.quantity import parse


def of_kind(kind: str) -> list[CataloguePart]:
    """Every part of a kind, in the order of the catalogue."""
    return [part for part in catalogue().values() if part.kind == kind]


def _sizes(text: str, unit: str, plain: str, where: str) -> list[float]:
    """Sizes such as "32 x 10 mm" or "400 W" [unit], `plain` where no unit is written; none where it is a name."""
    if not text[:1].isdigit():
        return []
    pieces = re.split(r"\s*[x×*]\s*", text.strip())
    last = re.sub(r"[\d.\s+-]", "", pieces[-1]) or plain
    found = [parse(one if re.search("[A-Za-z]", one) else f"{one} {last}", unit, where) for one in pieces]
    if not all(size > 0 for size in found):
        raise InputError(f'"{text}" is no size', where, "write positive values")
    return found


def chosen_screw(wanted: str) -> tuple[CataloguePart, str]:
    """The screw of a name or a size, "32 x 10 mm"; and why it is this one where several would do.

    Raises:
        InputError: no screw of that name or size; names the nearest.
    """
    sizes = _sizes(wanted, "m", "mm", "--screw")
    if not sizes:
        return find_part(wanted, "screw", "--screw"), ""
    if len(sizes) != 2:
        raise InputError(f'"{wanted}" is no size of a screw', "--screw", "write diameter x lead, such as '32 x 10 mm'")
    diameter, lead = sizes
    near = sorted(of_kind("screw"), key=lambda one: (away(one, diameter, lead), "nut" not in one.sections))
    fitting = [part for part in near if away(part, diameter, lead) < 1e-6]
    if not fitting:
        offered = ", ".join(list(dict.fromkeys(part.size.split(",")[0] for part in near))[:4])
        what = f"the catalogue holds no screw of {wanted}"
        raise InputError(what, "--screw", f"nearest are {offered}; take one, and change its values in the file")
    stiff = [part for part in fitting if "nut" in part.sections] or fitting
    chosen = min(stiff, key=lambda part: newton(part, "ball_screw", "dynamic_rating"))
    return chosen, _beside(chosen, fitting, "the lightest of its size with a known nut")


def away(part: CataloguePart, diameter: float, lead: float) -> float:
    """How far a screw is from a size, 0 where it is of it."""
    own = parse(part.further["nominal_diameter"], "m", part.name)
    return abs(math.log(own / diameter)) + abs(math.log(parse(part.sections["ball_screw"]["lead"], "m", "") / lead))


def newton(part: CataloguePart, section: str, key: str) -> float:
    """A force that a part gives to a section [N]."""
    return parse(part.sections[section][key], "N", part.name)


def chosen_motor(wanted: str) -> tuple[CataloguePart, str]:
    """The motor of a name or a rated power, "400 W"; else as `chosen_screw`."""
    sizes = _sizes(wanted, "W", "W", "--motor")
    if not sizes:
        return find_part(wanted, "motor", "--motor"), ""
    near = sorted(of_kind("motor"), key=lambda one: abs(math.log(_power(one) / sizes[0])))
    fitting = [part for part in near if abs(_power(part) / sizes[0] - 1) < 0.01]
    if not fitting:
        offered = ", ".join(f"{part.name} ({part.size})" for part in near[:3])
        raise InputError(f"the catalogue holds no motor of {wanted}", "--motor", f"nearest are {offered}")
    # The widest of them: the most inertia suits a screw, whose inertia is several times that of a small rotor.
    chosen = max(fitting, key=lambda part: parse(part.sections["motor"]["rotor_inertia"], "kg m^2", ""))
    return chosen, _beside(chosen, fitting, f"of the motors of {wanted} that of the most inertia")


def _beside(chosen: CataloguePart, fitting: list[CataloguePart], why: str) -> str:
    """Why a part was chosen among those that fit; "" where it is the only one."""
    others = ", ".join(part.name for part in fitting if part is not chosen)
    return f"{chosen.name}, {why}; also {others}" if others else ""


def _power(part: CataloguePart) -> float:
    return parse(part.further["rated_power"], "W", part.name)
