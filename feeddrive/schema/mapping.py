"""Keys of a mapping file; `feeddrive.recording.files.channel_mapping` reads them."""

from __future__ import annotations

from feeddrive.schema.key import Key, Kind
from feeddrive.schema.section import Section, keyed

_VARIABLE = keyed(
    Key("variable", "name in the foreign file, or a list of names that are multiplied", kind=Kind.WORDS, required=True),
    Key("unit", "of what the file holds, of the product of the variables", kind=Kind.TEXT, required=True),
    Key("factor", "a number, or a number with its unit", default="1"),
    Key("offset", "added last, in a unit of the channel", default="0"),
    Key(
        "hold",
        "for which time a sample stands: to the next one, or from the one before",
        kind=Kind.TEXT,
        choices=("zero_order", "interval_before"),
        default="zero_order",
    ),
    Key("column", "of a matrix, 1 for the first", "1", Kind.WHOLE, 1, 1_000_000, default="1"),
)

MAPPING = Section(
    "mapping",
    "which variable of a foreign file is which channel",
    keyed(
        Key("format", 'its first line, "feeddrive-map/1"', kind=Kind.TEXT, required=True),
        Key("description", "in a sentence", kind=Kind.TEXT),
        Key("sample_time", "where the file holds no time, in place of [time]", "s", minimum=0.0, open_ends=True),
        Key(
            "rate",
            "of the one grid of a trace file; that of its slowest channel if left out",
            "Hz",
            minimum=0.0,
            open_ends=True,
        ),
        Key(
            "part",
            "stretch between gaps of a trace file, 1 for the first; the longest if left out",
            "1",
            Kind.WHOLE,
            1,
            1_000_000,
        ),
    ),
    {
        "time": Section("mapping.time", "the variable that holds the time", _VARIABLE),
        "channels": Section(
            "mapping.channels",
            "channels by their name, such as [channels.motor_torque]",
            sections={"*": Section("mapping.channels.*", "one channel", _VARIABLE)},
            any_name=True,
        ),
        "file": Section(
            "mapping.file",
            "where the table stands in a text file",
            keyed(
                Key("header_row", "of the names, 0 if there is none", "1", Kind.WHOLE, 0, 1_000_000),
                Key("first_row", "of the numbers", "1", Kind.WHOLE, 1, 1_000_000),
                Key("separator", "between cells", kind=Kind.TEXT, choices=(",", ";", "\t")),
                Key("decimal", "point or comma", kind=Kind.TEXT, choices=(".", ",")),
            ),
        ),
    },
)
"""A mapping file."""
