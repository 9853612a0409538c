"""How far the declared chain of a machine holds, in a sentence."""

from __future__ import annotations

import math


def chain_remark(valid_to: float) -> str:
    """What to know of frequencies beside simulations, whose chain holds up to `valid_to` [Hz]; empty without limit."""
    if not math.isfinite(valid_to):
        return ""
    holds = f"whose modes are within 1 % up to {valid_to:.0f} Hz" if valid_to else "whose first mode is 1 % off or more"
    return f"Within 0.5 %, whatever the elements of the screw. Simulations use the declared chain, {holds}."
