"""What a ledger keeps of one run beyond its diagnosis, as it writes it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Kept:
    """What the ledger keeps of a run.

    Attributes:
        tried: every effect tried in every round, its values after its start was refined, and why it was taken or not.
        covariance: `values`, names of what was fitted as `effect.key`, and `matrix`, SI.
        since: what changed since the run that was continued, in sentences.
    """

    tried: tuple[dict[str, Any], ...] = ()
    covariance: dict[str, Any] = field(default_factory=lambda: {"values": [], "matrix": []})
    since: tuple[str, ...] = ()
