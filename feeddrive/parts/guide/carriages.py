"""The carriages under a table as a machine declares them: how many, what loads them, by geometry or by rating."""

from __future__ import annotations

from dataclasses import dataclass

from feeddrive.parts.guide.guide_coefficients import GuideCoefficients
from feeddrive.parts.guide.guide_geometry import BallGuide


@dataclass(frozen=True)
class RollingCarriage:
    """What is known of a carriage whose geometry is published.

    Attributes:
        guide: geometry and preload.
        coefficients: of rolling and slip, and the oil.
    """

    guide: BallGuide
    coefficients: GuideCoefficients


@dataclass(frozen=True)
class RatedCarriage:
    """What is known of a carriage whose geometry is not published: `feeddrive.parts.guide.guide_rating`.

    Attributes:
        preload: F_0 [N].
        friction_coefficient: mu [1].
    """

    preload: float
    friction_coefficient: float


@dataclass(frozen=True)
class Carriages:
    """Equal carriages that share the load of a table evenly.

    Attributes:
        name: of the carriage, "as written" for a geometry.
        count: under the table.
        load: vertical, of one [N].
        seal_drag: of one [N].
        one: what is known of a carriage.
    """

    name: str
    count: int
    load: float
    seal_drag: float
    one: RollingCarriage | RatedCarriage
