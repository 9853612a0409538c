"""Series that are evaluated hold numbers alone: one that is missing would be a figure of nothing, in silence."""

from __future__ import annotations

import numpy as np

from feeddrive.errors import InputError
from feeddrive.typing import FloatArray


def refuse_unknown(where: str, **series: FloatArray) -> None:
    """Refuse series with a value that is not a number, or infinite.

    Args:
        where: what is evaluated, for the message.
        series: name to values, of any shape.

    Raises:
        InputError: there is one; it says of which series, how many, and where the first stands.
    """
    for name, values in series.items():
        unknown = np.argwhere(~np.isfinite(values))
        if len(unknown):
            first = ", ".join(str(int(i) + 1) for i in unknown[0])
            count = f"{len(unknown)} of {np.size(values)} values"
            what = f"{name} has {count} that are no number, the first at place {first}"
            raise InputError(what, where, "leave them out, or record them again")
