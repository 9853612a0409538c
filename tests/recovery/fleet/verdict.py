"""A record of the fleet beside its truth: names, channels, values, intervals."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from tests.recovery.corruptions import LIKE_AN_EFFECT

LARGEST_SET = 3
CUT = 0.5
"""Left out at both ends of what is judged [s]."""


@dataclass(frozen=True)
class Verdict:
    """A record with its questions answered; see `tests.recovery.fleet.run` for what it holds."""

    record: dict[str, Any]

    @property
    def truth(self) -> dict[str, Any]:
        """What was planted, off and spoilt."""
        return dict(self.record["truth"])

    @property
    def kind(self) -> str:
        """null, corrupted, pair or single."""
        return str(self.truth["kind"])

    @property
    def done(self) -> bool:
        """Whether the diagnosis came to its end."""
        return bool(self.record["outcome"] == "done")

    @property
    def relative(self) -> bool:
        """Whether a law that was planted is not the catalogue's."""
        return any(one["relative"] for one in self.truth["planted"])

    @property
    def planted(self) -> set[tuple[str, str]]:
        """Names and places of what was planted; the place is empty where an effect has one only."""
        return {(one["name"], one["place"]) for one in self.truth["planted"]}

    @property
    def asserted(self) -> list[dict[str, Any]]:
        """Effects that are asserted; none where the recording was refused."""
        return [one for one in self.record.get("found", []) if one["asserted"]]

    @property
    def named(self) -> set[tuple[str, str]]:
        """Names asserted, with their places where the planted effect of that name has one."""
        placed = {name for name, place in self.planted if place}
        return {(one["name"], one["place"] if one["name"] in placed else "") for one in self.asserted}

    @property
    def extra(self) -> list[str]:
        """Names asserted that are not true: neither planted nor a value beyond its tolerance."""
        allowed = set(self.truth["may"]) | set(LIKE_AN_EFFECT.get(self.truth["spoiling"], ()))
        return sorted(name for name, place in self.named - self.planted if name not in allowed)

    @property
    def right(self) -> bool:
        """Whether all that was planted is asserted, at its place, and nothing that is not true."""
        return self.done and self.planted <= self.named and not self.extra

    @property
    def sets(self) -> list[list[str]]:
        """Ambiguous sets of at most three names."""
        return [names for names in self.record.get("ambiguous", []) if len(names) <= LARGEST_SET]

    @property
    def right_in_sets(self) -> bool:
        """Whether all that was planted is asserted or in a set with a name that is, and nothing else is asserted."""
        if not self.done:
            return False
        names = {name for name, _ in self.named}
        shown = {name for one in self.sets if names & set(one) for name in one}
        of_sets = {name for one in self.sets if {n for n, _ in self.planted} & set(one) for name in one}
        wanted = {name for name, _ in self.planted}
        return wanted <= names | shown and not [name for name in self.extra if name not in of_sets]

    @property
    def set_size(self) -> float:
        """Mean number of names that stand for an asserted one."""
        if not self.asserted:
            return 1.0
        sizes = [max([1, *(len(one) for one in self.sets if found["name"] in one)]) for found in self.asserted]
        return sum(sizes) / len(sizes)

    @property
    def over_floor(self) -> float | None:
        """Error after over the floor, on the worst channel."""
        floor = self.record.get("floor") or {}
        return max((self.record["after"][name] / value for name, value in floor.items()), default=None)

    @property
    def worse_channels(self) -> list[str]:
        """Channels whose error is greater after than before, beyond three standard deviations of an rms.

        The rms of n independent samples scatters by 1 / sqrt(2 n) of itself; n is twice the band times the seconds.
        """
        result = []
        for name, after in self.record.get("after", {}).items():
            seconds = self.truth["rows"][1] / self.truth["rate_hz"] - 2 * CUT
            independent = max(2.0 * self.record["band"][name] * seconds, 1.0)
            if after > self.record["before"][name] * (1.0 + 3.0 / math.sqrt(2.0 * independent)):
                result.append(name)
        return result

    @property
    def out_of_range(self) -> list[str]:
        """Values of asserted effects that no machine can have."""
        return [
            f"{one['name']} {key} {value:.4g}"
            for one in self.asserted
            for key, value in _numbers(one)
            if not possible(one["name"], one["place"], key, value, self.truth)
        ]

    @property
    def intervals(self) -> list[tuple[str, bool]]:
        """Parameters of effects rightly named whose law is the catalogue's: effect and key, whether inside."""
        result = []
        for one in self.truth["planted"]:
            if one["relative"]:
                continue
            match = [
                f
                for f in self.asserted
                if f["name"] == one["name"] and (not one["place"] or f["place"] == one["place"])
            ]
            for found in match[:1]:
                result += list(_inside(one, found))
        return result


def _numbers(found: dict[str, Any]) -> Iterator[tuple[str, float]]:
    for key, parameter in found["parameters"].items():
        if isinstance(parameter["value"], (int, float)):
            yield key, float(parameter["value"])


NOT_NEGATIVE = (
    "delay", "width", "coulomb_factor", "viscous_factor", "factor", "stiffness", "damping", "time_constant",
    "frequency", "velocity", "half_width", "coefficient",
)  # fmt: skip


def possible(name: str, place: str, key: str, value: float, truth: dict[str, Any]) -> bool:
    """Whether a machine can have this value: positive masses, no delay into the future, no share above 1."""
    if name == "payload":
        return value > -float(truth["mass"])
    if name == "inertia_deviation":
        return value > -float(truth["motor_inertia" if place == "motor" else "screw_inertia"])
    if name == "position_spring":
        return True
    if key in ("share", "share_over_stroke", "break_away"):
        return value <= 1.0
    if name == "structural_mode" and key == "damping":
        return 0.0 <= value <= 2.0
    return value >= 0.0 if key in NOT_NEGATIVE else True


def _inside(planted: dict[str, Any], found: dict[str, Any]) -> Iterator[tuple[str, bool]]:
    for key, true in planted["values"].items():
        parameter = found["parameters"].get(key)
        span = parameter and parameter["ci95"]
        if not span or isinstance(span[0], list):
            continue
        value = float(true)
        if planted["name"] == "torque_constant_droop" and "at_torque" in found["parameters"]:
            value *= (float(found["parameters"]["at_torque"]["value"]) / planted["values"]["at_torque"]) ** 2
        difference = value - 0.5 * (span[0] + span[1])
        if key == "phase":
            difference = math.remainder(difference, 2.0 * math.pi)
        yield f"{planted['name']} {key}", abs(difference) <= 0.5 * (span[1] - span[0])
