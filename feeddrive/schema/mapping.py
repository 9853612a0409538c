"""Keys of a mapping file; `feeddrive.recording.files.channel_mapping` reads them."""

from __future__ import annotations

from dataclasses import replace

from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import keyed, sections

_VARIABLE = """
variable | words | | required | name in the foreign file, or a list of names that are multiplied
unit | text | | required | of what the file holds, of the product of the variables
factor | | | = 1 | a number, or a number with its unit
offset | | | = 0 | added last, in a unit of the channel
hold | text | zero_order, interval_before | = zero_order | for which time a sample stands: to the next one, or from \
the one before
column | whole | [1, 1e6] | = 1 | of a matrix, 1 for the first
"""

_MAPPING = sections(f"""
[mapping] which variable of a foreign file is which channel
format | text | | required | its first line, "feeddrive-map/1"
description | text | | | in a sentence
sample_time | s | > 0 | | where the file holds no time, in place of [time]
rate | Hz | > 0 | | of the one grid of a trace file; that of its slowest channel if left out
part | whole | [1, 1e6] | | stretch between gaps of a trace file, 1 for the first; the longest if left out

[mapping.time] the variable that holds the time
{_VARIABLE}
[mapping.channels] channels by their name, such as [channels.motor_torque]

[mapping.channels.*] one channel
{_VARIABLE}
[mapping.file] where the table stands in a text file
header_row | whole | [0, 1e6] | | of the names, 0 if there is none
first_row | whole | [1, 1e6] | | of the numbers
""")
_MARKS = keyed(
    Key("separator", "between cells", kind=Kind.TEXT, choices=(",", ";", "\t")),
    Key("decimal", "point or comma", kind=Kind.TEXT, choices=(".", ",")),
)
_FILE = _MAPPING.sections["file"]
MAPPING = replace(_MAPPING, sections={**_MAPPING.sections, "file": replace(_FILE, keys={**_FILE.keys, **_MARKS})})
"""A mapping file."""
