"""A first look at hours of recording: the play that a linear pass at equal positions finds, for the search to ask.

What differs over the stroke and has no name, a lead map of some micrometres, may be as large as a play. Declared values
then run to where they stand in for the play before anything is found. The pass of `trend` has both as maps over
position, so that a play is told by opposite directions at equal places. Its value is a start and no finding: the search
asks it again, on the data that it fits, and judges it as any other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from feeddrive.diagnosis.finding.materiality import is_material
from feeddrive.diagnosis.likelihood.tolerances import SURE
from feeddrive.effects.base import Effect
from feeddrive.effects.transmission.backlash import Backlash
from feeddrive.errors import InputError
from feeddrive.plant.plant import Plant
from feeddrive.recording import Recording
from feeddrive.recording.long.joined import is_joined
from feeddrive.trend.pooling import pool
from feeddrive.trend.regressors import TRAVEL, grid_for, linear_pass
from feeddrive.trend.watched_quantities import prior_widths


def play_seen(plant: Plant, recordings: Sequence[Recording]) -> tuple[Effect, ...]:
    """The backlash that the last of the recordings of hours shows; none where there is no such recording.

    Args:
        plant: as declared.
        recordings: as they are compared, long ones cut.
    """
    long = [one for one in recordings if is_joined(one)]
    if not long or not plant.chain.elastic or any(effect.name == Backlash.name for effect in plant.effects):
        return ()
    grid = grid_for(plant, long[-1])
    try:
        passes = [one for one in linear_pass(long[-1], plant, grid) if one.channel == "table_position"]
    except InputError:  # nothing that a pass could use; the search says what is wrong with it
        return ()
    if not passes:
        return ()
    pooled, place = pool(passes, grid, prior_widths(plant)), TRAVEL.index("play")
    width, deviation = float(pooled.values[0, place]), float(pooled.deviation[0, place])
    if not width > SURE * deviation or not math.isfinite(width):
        return ()
    found = Backlash.of(width=min(width, Backlash.parameters[0].maximum))
    return (found,) if is_material(found, plant) else ()
