"""A reduced model of the moving nut whose speed and contact change while it runs.

What the ripple takes away (`moving`) is worked out on one basis at some speeds and interpolated in between, over the
logarithm of the feed. It grows with the square of the contact conductance (the resolvent stays the declared one's).
All speeds share the states, so that a run may go from one to the next.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import PchipInterpolator

from feeddrive.errors import ValidityWarning
from feeddrive.thermal.full.full_model import discretise, model_of
from feeddrive.thermal.full.grid import Cells
from feeddrive.thermal.full.moving import lowered, ripple_loss
from feeddrive.thermal.machine_heat import Heat
from feeddrive.thermal.reduced.parametric_model import HeatModel, Path
from feeddrive.thermal.reduced.reduction import DEFAULT_ORDER, common_basis
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Travel, refuse_unless
from feeddrive.typing import FloatArray


@dataclass(frozen=True, eq=False)
class MovingFamily:
    """The reduced model of one travel at every feed of a range.

    Attributes:
        model: averaged, reduced.
        feeds: at which the ripple was worked out, ascending, (s,) [m/s].
        losses: lost K beside lost B, (s, r, r + m).
        contact: conductance that they were worked out with [W/(m² K)].
    """

    model: HeatModel
    feeds: FloatArray
    losses: FloatArray
    contact: float

    def at(self, conductances: Mapping[Path, float], feed: float) -> HeatSystem:
        """The slow system; feed 0 is the average alone, for a nut that rests anywhere on its travel.

        Args:
            conductances: path to g.
            feed: of the nut [m/s].

        Warns:
            ValidityWarning: a feed outside the range, or conductances outside the model's.
        """
        averaged = self.model.at(conductances)
        if feed == 0:
            return averaged
        low, high = float(self.feeds[0]), float(self.feeds[-1])
        if not low * (1 - 1e-9) <= feed <= high * (1 + 1e-9):
            what = f"a feed of {feed * 1e3:.4g} mm/s lies outside {low * 1e3:.4g} to {high * 1e3:.4g} mm/s"
            warnings.warn(f"{what}: the ripple at the nearer end is taken", ValidityWarning, stacklevel=2)
        order = averaged.order
        curve = PchipInterpolator(np.log(self.feeds), self.losses)
        lost = curve(np.log(np.clip(feed, low, high))) * (conductances.get(Path.CONTACT, 0.0) / self.contact) ** 2
        return lowered(averaged, lost[:, :order], lost[:, order:])


def moving_family(
    heat: Heat,
    speeds: FloatArray,
    travel: Travel | None = None,
    order: int = DEFAULT_ORDER,
    cells: Cells | None = None,
) -> MovingFamily:
    """Work out a family.

    Args:
        heat: the machine.
        speeds: of the screw, ascending, at which the ripple is worked out, at least two, (s,) [rad/s].
        travel: in place of the rig's.
        order: number of states.
        cells: in place of the plant's grid.

    Raises:
        InputError: fewer than two speeds, or speeds that do not ascend from above zero.

    Warns:
        ValidityWarning: a speed at which the nut is too slow for the contact.
    """
    ascending = len(speeds) >= 2 and speeds[0] > 0 and bool(np.all(np.diff(speeds) > 0))
    refuse_unless(ascending, "speeds do not ascend from above zero", "speeds", "write at least two, the slowest first")
    parts, travel = discretise(heat.rig, cells or heat.cells), travel or heat.rig.travel
    full = model_of(parts, travel)
    limits = dict(heat.limits())
    basis = common_basis([full], limits, order)
    feeds = np.array([heat.feed(float(speed)) for speed in speeds])
    losses = [
        np.hstack(ripple_loss(parts, heat.at_speed(float(speed)), float(feed), basis, travel))
        for speed, feed in zip(speeds, feeds, strict=True)
    ]
    return MovingFamily(replace(full.projected(basis), limits=limits), feeds, np.array(losses), heat.contact)
