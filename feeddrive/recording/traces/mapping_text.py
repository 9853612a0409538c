"""The mapping file that says again, for the next file of the same machine, what was understood of a trace."""

from __future__ import annotations

import json
import math

from feeddrive.recording.channels import channel_unit
from feeddrive.recording.files.channel_mapping import FORMAT
from feeddrive.recording.traces.channel_choice import Choice, Pick, Wishes
from feeddrive.recording.traces.resampling import HELD
from feeddrive.units.quantity import unit_conversion


def mapping_text(choice: Choice, wishes: Wishes, sample_time: float, described: str) -> str:
    """Return a mapping file in TOML of what was understood and wished, for a grid with a sample time [s]."""
    rate = wishes.rate or float(f"{1.0 / sample_time:.12g}")
    lines = [f'format = "{FORMAT}"', f"description = {_quoted(described)}", f'rate = "{rate!r} Hz"']
    if wishes.sample_time is not None:
        lines.append(f'sample_time = "{wishes.sample_time!r} s"')
    if wishes.part is not None:
        lines.append(f"part = {wishes.part}")
    for pick in choice.picks:
        lines += [
            "",
            f"# {_comment(pick.reason)}",
            f"[channels.{pick.channel}]",
            f"variable = {_quoted(pick.signal.name)}",
            *_scale(pick),
        ]
    return "\n".join((*lines, ""))


def _scale(pick: Pick) -> list[str]:
    """Return the lines for unit, factor and hold of a channel."""
    needed = channel_unit(pick.channel, "")
    lines = [f"unit = {_quoted(pick.unit)}"]
    if pick.channel == "motor_angle" and _is_length(pick.unit):
        per_unit = pick.factor  # rad of the motor for each of the file's units of length
        lines.append(f'factor = "{per_unit!r} rad/{pick.unit}"')
    else:
        ratio = pick.factor / unit_conversion(pick.unit, needed, "").factor
        if not math.isclose(ratio, 1.0, rel_tol=1e-12):
            lines.append(f"factor = {float(f'{ratio:.15g}')!r}")
    if pick.channel in HELD:
        lines.append('hold = "zero_order"')
    return lines


def _is_length(unit: str) -> bool:
    from feeddrive.recording.traces.naming import conversion

    return conversion(unit, "m") is not None


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)  # a basic string of TOML, since names hold no control characters


def _comment(text: str) -> str:
    return "".join(letter if letter.isprintable() else "?" for letter in text)
