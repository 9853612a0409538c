"""Keys of a file of measured numbers; `feeddrive.diagnosis.numbers.measured_file` reads them."""

from __future__ import annotations

from feeddrive.schema.controller import SOURCE
from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, keyed

_MODES = "of a natural frequency"
_MOVING = "of drag torque and lost motion"
_NUMBER = Section(
    "measured.measured",
    "one measured number",
    keyed(
        Key(
            "quantity",
            "what was measured",
            kind=Kind.TEXT,
            required=True,
            choices=("axial_stiffness", "natural_frequency", "drag_torque", "lost_motion", "inertia_at_motor"),
        ),
        Key("value", "measured, in the unit of its quantity", minimum=0.0, open_ends=True, required=True),
        Key("at", "table position; the middle of the stroke if left out", "m"),
        Key(
            "tolerance",
            "two standard deviations, as a share or in the unit of the value; a usual one if left out",
            kind=Kind.TEXT,
        ),
        Key(
            "motor", "held by its brake or free", kind=Kind.TEXT, choices=("held", "free"), default="held", when=_MODES
        ),
        Key("mode", "counted from 1", "1", Kind.WHOLE, 1, 100, default="1", when=_MODES),
        Key("velocity", "of the table", "m/s", minimum=0.0, open_ends=True, default="1 mm/s", when=_MOVING),
        SOURCE,
    ),
    listed=True,
)

MEASURED = Section(
    "measured",
    "numbers that were measured at a machine",
    keyed(
        Key("format", '"feeddrive-measured/1"; may be left out', kind=Kind.TEXT),
        Key("name", "of the measurements", kind=Kind.TEXT),
        Key("description", "in a sentence", kind=Kind.TEXT),
        SOURCE,
    ),
    {"measured": _NUMBER},
)
"""A file of measured numbers."""
