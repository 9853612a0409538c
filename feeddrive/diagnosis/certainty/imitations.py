"""Effects that become another one where they are small, started from that one's values.

    backlash w  ->  preload_loss with F1 = k (w / 2) a / (1 - a)

Both let the table lag by w / 2 once the transmitted force has passed F1. Where the recordings never dwell at forces
below F1 the two are one; a search that starts at forces which can be seen does not come upon this one.

| symbol | meaning | unit |
|---|---|---|
| w | free play | m |
| a, F1 | stiffness around zero force over the declared one, and the force up to which it is soft | 1, N |
| k | declared stiffness of the nut's spring | N/m |
"""

from __future__ import annotations

from feeddrive.effects.base import Effect
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.analysis.stiffness_budget import nut_stiffness
from feeddrive.plant.plant import Plant

SOFTENED = 0.1
"""Ratio a of the start: far from both ends of its range, 0.01 (free play) and 1 (no loss)."""


def imitations_of(effect: Effect, plant: Plant) -> tuple[Effect, ...]:
    """The effects that this one could be a small case of; none for most.

    Args:
        effect: found.
        plant: as declared.
    """
    if not isinstance(effect, Backlash) or not plant.chain.elastic:
        return ()
    width = effect.values["width"]
    if not isinstance(width, float) or width <= 0:
        return ()
    stiffness = nut_stiffness(plant)
    return (PreloadLoss.of(ratio=SOFTENED, force=0.5 * width * stiffness * SOFTENED / (1 - SOFTENED)),)
