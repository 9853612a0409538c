"""Effects that become another one where they are small, started from that one's values.

    backlash w  <->  preload_loss with w = 2 F1 (1 - a) / (a k)

Both let the table lag by w / 2 once the transmitted force has passed F1. Where the recordings never dwell at forces
below F1 the two are one; a search that starts at forces which can be seen does not come upon this one.

| symbol | meaning | unit |
|---|---|---|
| w | free play | m |
| a, F1 | stiffness around zero force over the declared one, and the force up to which it is soft | 1, N |
| k | declared stiffness of the nut's spring | N/m |
"""

from __future__ import annotations

from feeddrive.effects.base import Effect, number
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.plant.analysis.stiffness_budget import nut_stiffness
from feeddrive.plant.plant import Plant

SOFTENED = 0.3
"""Ratio a of the start: far, as a factor, from both ends of its search, 0.1 (free play) and 1 (no loss)."""


def imitations_of(effect: Effect, plant: Plant) -> tuple[Effect, ...]:
    """The effects that this one could be a small case of; none for most.

    Args:
        effect: found.
        plant: as declared.
    """
    if not isinstance(effect, PreloadLoss | Backlash) or not plant.chain.elastic:
        return ()
    if isinstance(effect, PreloadLoss):
        width = lost_motion(number(effect.values["ratio"]), number(effect.values["force"]), plant)
        return (Backlash.of(width=min(width, Backlash.parameter("width").maximum)),) if width > 0 else ()
    if number(effect.values["width"]) <= 0:
        return ()
    return (softened(number(effect.values["width"]), SOFTENED, plant),)


def softened(width: float, ratio: float, plant: Plant) -> PreloadLoss:
    """The lost preload of a ratio that lets the table lag as a free play of some width [m] does."""
    force = 0.5 * width * nut_stiffness(plant) * ratio / (1 - ratio)
    return PreloadLoss.of(ratio=ratio, force=min(force, PreloadLoss.parameter("force").maximum))


def lost_motion(ratio: float, force: float, plant: Plant) -> float:
    """Way w [m] that a table lags behind more, from one direction to the other, where preload is lost.

    Args:
        ratio, force: a and F1 [N].
        plant: elastic, whose nut's spring it is.
    """
    return 2 * force * (1 - ratio) / (ratio * nut_stiffness(plant))
