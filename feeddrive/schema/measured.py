"""Keys of a file of measured numbers; `feeddrive.diagnosis.numbers.measured_file` reads them."""

from __future__ import annotations

from feeddrive.schema.key import SOURCE
from feeddrive.schema.section import sections

_MODES = "of a natural frequency"
_QUANTITIES = "axial_stiffness, natural_frequency, drag_torque, lost_motion, inertia_at_motor"

MEASURED = sections(f"""
[measured] numbers that were measured at a machine
format | text | | | "feeddrive-measured/1"; may be left out
name | text | | | of the measurements
description | text | | | in a sentence
{SOURCE}

[[measured.measured]] one measured number
quantity | text | {_QUANTITIES} | required | what was measured
value | | > 0 | required | measured, in the unit of its quantity
at | m | | | table position; the middle of the stroke if left out
tolerance | text | | | two standard deviations, as a share or in the unit of the value; a usual one if left out
motor | text | held, free | = held | held by its brake or free | {_MODES}
mode | whole | [1, 100] | = 1 | counted from 1 | {_MODES}
velocity | m/s | > 0 | = 1 mm/s | of the table | of drag torque and lost motion
{SOURCE}
""")
"""A file of measured numbers."""
