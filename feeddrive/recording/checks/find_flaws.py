"""Looks for flaws in a recording, and refuses those that leaving rows out does not mend."""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.recording.checks.bad_cells import bad_cells, refuse_jumps
from feeddrive.recording.checks.flaws import Flaw, filled, refuse_where_not_compared, resolution
from feeddrive.recording.checks.held_runs import held_and_clipped
from feeddrive.typing import FloatArray


def find_flaws(channels: Mapping[str, FloatArray], sample_time: float, first_row: int, where: str) -> list[Flaw]:
    """Return the flaws of a recording whose rows can be left out.

    Args:
        channels: (n,) each, SI.
        sample_time: between rows [s].
        first_row: row in the file of sample 0.
        where: file name.

    Raises:
        InputError: motion that jumps, or a bad cell in a channel that is not compared row by row.
    """
    steps = {name: resolution(samples) for name, samples in channels.items()}
    bad, _ = bad_cells(channels, sample_time, steps)
    # A bad cell of one position looks as if the other were left behind; and what was held is made up for by a jump.
    held = held_and_clipped(filled(channels, bad), sample_time, steps)
    more, jumps = bad_cells(filled(channels, [*bad, *held]), sample_time, steps)
    ends = {(one.channel, int(row)) for one in held for row in one.rows}
    refuse_jumps([jump for jump in jumps if (jump.channel, jump.row) not in ends], first_row, where)
    flaws = [*bad, *more, *held]
    refuse_where_not_compared(flaws, first_row, where)
    return flaws
