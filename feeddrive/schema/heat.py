"""Keys of [thermal] and of what stands inside it; `feeddrive.plant.file.heat` reads them."""

from __future__ import annotations

import math

from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, keyed

SOURCE = Key("source", "where the values come from, of every value here that names none itself", kind=Kind.TEXT)
_PATH = "plant.thermal"


def positive(name: str, unit: str, meaning: str, **further: object) -> Key:
    """A quantity above zero that must stand there."""
    return Key(name, meaning, unit, minimum=0.0, open_ends=True, required=True, **further)  # type: ignore[arg-type]


_ALONE = "where the motion declares no friction of its own"


def _friction(path: str, meaning: str, *seat: Key) -> Section:
    return Section(
        path,
        meaning,
        keyed(
            Key("load_torque", "friction torque from load and preload", "N m", minimum=0.0, required=True,
                when=_ALONE),
            Key("viscous_factor", "f0, times number of nuts and turns for a nut", "1", minimum=0.0, required=True,
                when=_ALONE),
            Key("viscosity", "kinematic viscosity of the lubricant", "m^2/s", minimum=0.0, open_ends=True,
                required=True, when=_ALONE),
            Key("mean_diameter", "mean diameter of the rolling bodies' path", "m", minimum=0.0, open_ends=True,
                required=True, when=_ALONE),
            Key("heat_share", "share of the friction that becomes heat here", "1", minimum=0.0, maximum=1.0,
                default="1"),
            *seat,
            SOURCE,
        ),
    )  # fmt: skip


_SEAT = (
    Key("seat_length", "length of the shaft in the bearing", "m", minimum=0.0),
    Key("film", "heat transfer from the seat to the air", "W/(m^2 K)", minimum=0.0),
    Key("end_share", "share of the shaft's end face that convects", "1", minimum=0.0, maximum=1.0, default="0"),
)


def _oil(name: str, meaning: str) -> Section:
    return Section(
        f"{_PATH}.coupling.{name}",
        meaning,
        keyed(
            positive("viscosity_40", "m^2/s", "kinematic viscosity at 40 degC"),
            positive("viscosity_100", "m^2/s", "kinematic viscosity at 100 degC"),
            SOURCE,
        ),
    )


COUPLING = Section(
    f"{_PATH}.coupling",
    "how heat and drive act on each other",
    keyed(
        Key("nut_at_zero", "nut's centre from the fixed end where the table is at 0", "m", required=True),
        positive("nut_stiffness", "N/m", "axial stiffness of the whole nut at its preload"),
        positive("group_distance", "m", "distance of the two ball groups"),
        Key("contact_angle", "contact angle of the balls in the nut", "rad", minimum=0.0, maximum=math.pi / 2,
            open_ends=True, required=True),
        Key("spacer", "nuts pushed apart, or pulled together", kind=Kind.TEXT, choices=("oversize", "undersize"),
            required=True),
        Key("rear_share", "share of the bearings' friction in the rear one", "1", minimum=0.0, maximum=1.0,
            default="0.5"),
        Key("motor_constant", "torque per root of the winding's heat; without it the motor gives no heat",
            "N m/W^0.5", minimum=0.0, open_ends=True),
        Key("guide_heat_to", "name of a [[thermal.body]] that takes the heat of the guides; the bed if left out",
            kind=Kind.TEXT, default=""),
        SOURCE,
    ),
    {
        "nut_oil": _oil("nut_oil", "lubricant of the nut"),
        "bearing_oil": _oil("bearing_oil", "lubricant of the bearings; that of the nut if left out"),
    },
)  # fmt: skip

_FILM = Section(
    f"{_PATH}.film",
    "heat transfer to the air",
    keyed(
        positive("screw", "W/(m^2 K)", "of the screw at 250 rev/min, growing with speed to the power 2/3"),
        positive("screw_least", "W/(m^2 K)", "of the screw at rest"),
        positive("nut_free", "W/(m^2 K)", "of the nut at rest"),
        positive("nut_forced", "W/(m^2 K)", "of the nut moving, at 250 rev/min"),
        SOURCE,
    ),
)

_BODY = Section(
    f"{_PATH}.body",
    "one heat capacity beside screw and nut: motor, housing, table",
    keyed(
        Key("name", "of the body, as sensors and other keys call it", kind=Kind.TEXT, required=True),
        Key("port", "where it touches", kind=Kind.TEXT, choices=("front", "rear", "nut"), required=True),
        positive("capacity", "J/K", "heat capacity"),
        positive("conductance", "W/K", "to the surface at the port"),
        Key("to_air", "conductance to the air", "W/K", minimum=0.0),
        SOURCE,
    ),
    listed=True,
)

THERMAL = Section(
    _PATH,
    "heat of screw, nut and bearings",
    keyed(
        positive("shaft_radius", "m", "half the diameter of the pitch circle, or the nominal radius"),
        positive("shaft_length", "m", "length of the shaft"),
        positive("nut_outer_radius", "m", "outer radius of the nut"),
        positive("nut_length", "m", "length of the nut"),
        Key("travel", "least and greatest place of the nut's centre, from the motor-side end", "m", Kind.QUANTITIES,
            required=True),
        Key("growth_positions", "where the growth of the table position is wanted", "m", Kind.QUANTITIES,
            required=True),
        Key("conductivity", "of the steel", "W/(m K)", minimum=0.0, open_ends=True, default="50 W/(m K)"),
        Key("heat_capacity", "of the steel's volume", "J/(m^3 K)", minimum=0.0, open_ends=True,
            default="3.926e6 J/(m^3 K)"),
        Key("expansion", "of the steel's length", "1/K", default="11.7e-6 1/K"),
        Key("elasticity", "Young's modulus of the steel", "Pa", minimum=0.0, open_ends=True, default="206e9 Pa"),
        positive("contact_conductance", "W/(m^2 K)", "shaft to nut, at the preload"),
        positive("preload", "N", "of the nut, for which friction and contact are declared"),
        Key("lead", "table travel per turn; that of [ball_screw] if left out", "m", minimum=0.0, open_ends=True),
        Key("ambient", "temperature of the air, for which the machine is declared", "degC", required=True),
        Key("highest_speed", "up to which the reduced model has to hold", "rad/s", minimum=0.0, open_ends=True,
            default="1500 rev/min"),
        Key("nut_heat_share", "share of the heat on the nut's side of the contact", "1", minimum=0.0, maximum=1.0,
            default="1"),
        Key("nut_end_share", "share of the nut's end faces that convects", "1", minimum=0.0, maximum=1.0,
            default="0"),
        SOURCE,
    ),
    {
        "film": _FILM,
        "nut": _friction(f"{_PATH}.nut", "friction heat of the nut"),
        "front_bearing": _friction(f"{_PATH}.front_bearing", "friction heat and seat of the front bearing", *_SEAT),
        "rear_bearing": _friction(f"{_PATH}.rear_bearing", "friction heat and seat of the rear bearing", *_SEAT),
        "body": _BODY,
        "coupling": COUPLING,
    },
)  # fmt: skip
"""[thermal] of a plant file."""
