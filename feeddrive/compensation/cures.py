"""What to do about each effect: the part to look at, the value to set, and what a control can compensate.

The order is that of a person at the machine: first what is worn or loose (a table on top of a worn part is wrong again
next month), then values that are simply wrong, then what the control may compensate.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from feeddrive.plant.plant import Plant

REPAIR, SET, COMPENSATE, WATCH = "repair", "set", "compensate", "watch"


@dataclass(frozen=True)
class Cure:
    """What to do about an effect.

    Attributes:
        kind: `REPAIR`, `SET`, `COMPENSATE` or `WATCH`.
        look_at: the part or the setting, and what to do there.
        form: what can be written for it: "table", "heat", "friction", "cogging", or nothing.
    """

    kind: str
    look_at: str
    form: str = ""


CURES: dict[str, Cure] = {
    "backlash": Cure(REPAIR, "nut preload, bearing preload, coupling: find the play by a dial gauge at nut and screw; "
                     "until it is renewed, a table may take the play away in slow motion", "table"),
    "preload_loss": Cure(REPAIR, "nut preload: measure the drag torque without load and renew it; it is elastic, "
                         "no backlash value cures it"),
    "friction_vs_position": Cure(REPAIR, "guide or cover at the position found: alignment, chips, lubrication there",
                                 "friction"),
    "structural_mode": Cure(REPAIR, "what is mounted on the table or its column: bolts, mounting; else a filter there"),
    "stiffness_deviation": Cure(REPAIR, "support bearings and nut: preload, seat, bolts; else the declared value"),
    "stiffness_vs_position": Cure(SET, "axial_stiffness and bearing arrangement in the plant file: the screw's own "
                                  "compliance grows with its free length"),
    "coulomb_asymmetry": Cure(REPAIR, "counterbalance, wipers, alignment: one direction is heavier", "friction"),
    "viscous_asymmetry": Cure(REPAIR, "lubrication and wipers: one direction is heavier", "friction"),
    "stribeck": Cure(COMPENSATE, "lubricant of the guides (stick-slip); feed-forward at reversals", "friction"),
    "presliding": Cure(COMPENSATE, "friction feed-forward or a pulse at reversals; it is no play", "friction"),
    "friction_deviation": Cure(SET, "coulomb and viscous in the plant file, and the feed-forward of the drive; a "
                               "rise since last time is wear or lubrication", "friction"),
    "load_dependent_friction": Cure(WATCH, "nut and bearings: friction that grows with load takes part of the torque"),
    "viscous_warmup": Cure(WATCH, "run warm before tuning and before measuring; choose the lubricant"),
    "torque_ripple": Cure(COMPENSATE, "current offsets of the drive first, then a cogging map", "cogging"),
    "ball_pass_ripple": Cure(REPAIR, "ball return and preload of the nut; no map holds it, its order is not whole"),
    "torque_constant_droop": Cure(SET, "torque constant over current in the drive"),
    "constant_force": Cure(SET, "torque offset of the drive, and the counterbalance"),
    "position_spring": Cure(REPAIR, "cable chain, bellows, counterbalance: a force that changes along the stroke"),
    "lead_error_periodic": Cure(COMPENSATE, "coupling and screw end (bent, eccentric), then a table with points "
                                "close enough", "table"),
    "lead_error_cumulative": Cure(COMPENSATE, "pitch or gear ratio in the control, or a table", "table"),
    "tabulated_travel": Cure(COMPENSATE, "a table along the stroke", "table"),
    "thermal_growth": Cure(COMPENSATE, "warm up before precise work; temperature compensation over a sensor", "heat"),
    "payload": Cure(SET, "table mass in the plant file, load inertia and gains in the drive"),
    "inertia_deviation": Cure(SET, "inertia in the plant file and in the drive's feed-forward"),
    "drive_delay": Cure(SET, "current loop and dead time in the controller file"),
    "channel_delay": Cure(SET, "the recorder: one channel is sampled later than the others"),
    "motor_heat": Cure(COMPENSATE, "flange cooling or duty; temperature compensation", "heat"),
    "bearing_heat": Cure(REPAIR, "bearing preload and grease at the end found; temperature compensation", "heat"),
    "ambient_drift": Cure(WATCH, "hall temperature; record it", "heat"),
    "preload_growth": Cure(WATCH, "preload while warm", "heat"),
    "cooling": Cure(SET, "coolant flow and temperature", "heat"),
    "structure_growth": Cure(WATCH, "scale mounting and frame: the scale itself moves", "heat"),
    "heat_sink": Cure(SET, "attached masses in the plant file", "heat"),
}  # fmt: skip
"""Effect to its cure; what is not listed is looked at and corrected in the plant file."""

UNKNOWN = Cure(WATCH, "the declared value it contradicts, in the plant file")


def cure(effect: str) -> Cure:
    """The cure of an effect of the catalogue, or of none known."""
    return CURES.get(effect, UNKNOWN)


ORDER = (REPAIR, SET, COMPENSATE, WATCH)


def in_order(effects: list[str]) -> list[str]:
    """Effects as a person goes through them: repairs, settings, compensations, what is only watched."""
    return sorted(dict.fromkeys(effects), key=lambda one: ORDER.index(cure(one).kind))


WORN = ("backlash", "preload_loss")
"""Effects that a new preload of the nut takes away; lead errors stay, they are the screw's own."""


def repaired(plant: Plant) -> Plant | None:
    """The plant with the preload renewed; None where none of it is lost."""
    kept = tuple(one for one in plant.effects if one.name not in WORN)
    return None if len(kept) == len(plant.effects) else replace(plant, effects=kept)
