"""A kept record beside what was planted: named or not, inside its intervals or not, how much is left."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from tests.recovery.suite.cases import Kind
from tests.recovery.suite.one import Record
from tests.recovery.suite.planting import place_of
from tests.recovery.suite.regression_terms import same
from tests.recovery.suite.truth import worst_ratio

LARGEST_SET = 3

SAYS = {
    "motor_inertia": "inertia_deviation",
    "screw_inertia": "inertia_deviation",
    "table_mass": "payload",
    "axial_stiffness": "stiffness_deviation",
    "guide_coulomb": "friction_deviation",
    "guide_viscous": "friction_deviation",
    "nut_coulomb": "friction_deviation",
    "nut_power": "friction_deviation",
    "bearing_coulomb": "friction_deviation",
}
"""Declared number to the effect that says that it is off; no effect says so of the others."""


@dataclass(frozen=True)
class Interval:
    """One parameter that was planted and found with an interval.

    Attributes:
        key: its name.
        inside: whether the planted value lies in the 95 % interval.
        width: half the interval over the bound; None where there is no bound.
    """

    key: str
    inside: bool
    width: float | None


@dataclass(frozen=True)
class Verdict:
    """What a record says."""

    record: Record

    @property
    def kind(self) -> Kind:
        """What the case is about."""
        return Kind(self.record["kind"])

    @property
    def planted(self) -> dict[str, dict[str, Any]]:
        """Effect to its parameters."""
        planted: dict[str, dict[str, Any]] = self.record["planted"]
        return planted

    @property
    def names(self) -> list[str]:
        """Effects found."""
        return [one["name"] for one in self.record["found"]]

    @property
    def sets(self) -> list[list[str]]:
        """Ambiguous sets small enough to help."""
        return [names for names in self.record["ambiguous"] if len(names) <= LARGEST_SET]

    @property
    def right(self) -> bool:
        """Exactly what was planted, each where it was planted."""
        return sorted(self.names) == sorted(self.planted) and all(self._placed(one) for one in self.record["found"])

    def _placed(self, one: dict[str, Any]) -> bool:
        place = place_of(self.planted[one["name"]])
        return place in ("", one["place"])

    @property
    def right_in_sets(self) -> bool:
        """As many as planted, each named or in the set of one that was found in its place."""
        if self.right:
            return True
        if "raised" in self.record or len(self.names) != len(self.planted):
            return False
        missing = [name for name in self.planted if name not in self.names]
        spare = [name for name in self.names if name not in self.planted]
        placed = all(self._placed(one) for one in self.record["found"] if one["name"] in self.planted)
        found = all(any(name in names and names[0] in spare for names in self.sets) for name in missing)
        return placed and bool(missing) and found

    @property
    def set_size(self) -> float:
        """Names that the answer leaves open per effect found; 1 where it is sure."""
        led = {names[0]: len(names) for names in self.record["ambiguous"]}
        return sum(led.get(name, 1) for name in self.names) / len(self.names) if self.names else 1.0

    @property
    def false_names(self) -> list[str]:
        """Found, and neither planted nor the name of a declared number that is off, nor ambiguous with such a name."""
        allowed = {*self.planted, *(SAYS[number] for number in self.record["off"] if number in SAYS)}
        in_sets = {names[0] for names in self.sets if allowed & set(names)}
        return [name for name in self.names if name not in allowed | in_sets]

    @property
    def error(self) -> float | None:
        """Error after over the floor, on the worst channel; None where there is none."""
        return worst_ratio(self.record["after"], self.record["floor"]) if self.record["after"] else None

    @property
    def before(self) -> float:
        """Error of the declared plant over the floor, on the worst channel."""
        return worst_ratio(self.record["before"], self.record["floor"])

    @property
    def intervals(self) -> list[Interval]:
        """Of the parameters of effects that were named where they were planted."""
        return [
            interval
            for one in self.record["found"]
            if one["name"] in self.planted and self._placed(one)
            for interval in self._intervals_of(one)
        ]

    def _intervals_of(self, one: dict[str, Any]) -> list[Interval]:
        planted, result = comparable(one["name"], self.planted[one["name"]], one["parameters"]), []
        bounds = self.record["bounds"].get(one["name"], {})
        for key, value in planted.items():
            span = one["parameters"].get(key, {}).get("ci95")
            if span is None or isinstance(span[0], list):
                continue
            low, high = span
            difference = value - 0.5 * (low + high)
            if key == "phase":
                difference = math.remainder(difference, 2 * math.pi)
            half = 0.5 * (high - low)
            bound = bounds.get(key)
            result.append(Interval(key, abs(difference) <= half, half / bound if bound else None))
        return result

    def rival(self, name: str) -> float | None:
        """Error of a rival over the floor, on the worst channel."""
        return worst_ratio(self.record[name]["after"], self.record["floor"]) if name in self.record else None

    @property
    def sparse_named(self) -> bool:
        """Whether every planted effect is among the strongest terms of a channel of the sparse regression."""
        terms = {term for found in self.record.get("sparse", {}).get("terms", {}).values() for term in found}
        return all(terms & same(name, values) for name, values in self.planted.items())

    @property
    def sparse_kept(self) -> int | None:
        """Terms that sparse regression keeps, over all channels; None where that was not kept."""
        kept = self.record.get("sparse", {}).get("kept")
        return None if kept is None else sum(kept.values())

    @property
    def cpu(self) -> float:
        """Seconds in total."""
        return float(sum(self.record["cpu"].values()))


def comparable(name: str, planted: dict[str, Any], found: dict[str, Any]) -> dict[str, float]:
    """Planted numbers as the found ones are to be read."""
    numbers = {key: float(value) for key, value in planted.items() if not isinstance(value, str)}
    if name == "torque_constant_droop" and "at_torque" in found:
        # Share at a torque: the same law has another share at another torque.
        at = float(found["at_torque"]["value"])
        numbers = {"share": numbers["share"] * (at / numbers["at_torque"]) ** 2}
    return numbers
