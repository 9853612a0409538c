"""Free play in the transmission.

    F = k dz(e) + c de/dt outside the gap, 0 inside; dz(e) = e - sign(e) w/2 for |e| > w/2

| symbol | key | meaning | unit |
|---|---|---|---|
| w | width | free play, total | m |

Conservative spring, dissipative damper. Under a torque chirp the motion in free play is chaotic: it cannot be
predicted, only its statistics can.
Source: Nordin and Gutman, Automatica 38 (2002) 1633, section 2.
"""

from __future__ import annotations

from collections.abc import Mapping

from feeddrive.effects.base import Parameter, Signature, TransmissionEffect
from feeddrive.typing import Expression


class Backlash(TransmissionEffect):
    """Dead zone of the transmission."""

    name = "backlash"
    parameters = (Parameter("width", "m", 0.0, 5e-3, size=5e-6),)
    signature = Signature(
        ("table_position", "motor_torque"), "sign of the transmitted force", ("presliding", "preload_loss")
    )
    has_play = True

    def free_play(self, p: Mapping[str, Expression]) -> Expression:
        """Free play [m]."""
        return p["width"]
