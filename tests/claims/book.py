"""The list of claims (docs/claims.toml): what is claimed, its bound, what measures it, where it is printed.

A test takes its bound from here:

    CLAIMS["emps.force"].check(100 * torque.after.relative)

so that a claim and its test cannot have two bounds. What was measured is kept for `make check` where `MEASURED` names a
file.
"""

from __future__ import annotations

import json
import math
import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.state import ROOT

FILE = ROOT / "docs" / "claims.toml"

MEASURED = "FEEDDRIVE_MEASURED"
"""Environment variable: file to which each measured value is added as a line of JSON."""

KEYS = {"key", "says", "at_most", "at_least", "is", "within", "unit", "by", "command", "printed", "note"}


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes:
        key: name under which tests and scripts ask for it.
        says: what is claimed, without its number.
        by: tests (pytest's node ids) or scripts that measure it; one that has no bound holds where they pass.
        at_most, at_least: bounds.
        value, within: the value, and how far off it may be.
        unit: of bounds and measured values.
        command: what a user types to see it; "" for none.
        printed: file to the words there that state it.
        note: what a reader must know of the bound.
    """

    key: str
    says: str
    by: tuple[str, ...]
    at_most: float | None = None
    at_least: float | None = None
    value: float | None = None
    within: float | None = None
    unit: str = ""
    command: str = ""
    printed: tuple[tuple[str, str], ...] = ()
    note: str = ""

    @property
    def numeric(self) -> bool:
        """Whether it has a number; otherwise it holds where its tests pass."""
        return (self.at_most, self.at_least, self.value) != (None, None, None)

    def inside(self, measured: float) -> bool:
        """Whether a measured value is inside the bound; not one that is not finite."""
        if not math.isfinite(measured):
            return False
        if self.at_most is not None and measured > self.at_most:
            return False
        if self.at_least is not None and measured < self.at_least:
            return False
        return self.value is None or abs(measured - self.value) <= (self.within or 0.0) * (1 + 1e-12)

    def bound(self) -> str:
        """The bound in words; "holds" for a claim without a number."""
        unit = f" {self.unit}" if self.unit else ""
        parts = []
        if self.at_least is not None:
            parts.append(f"at least {self.at_least:g}{unit}")
        if self.at_most is not None:
            parts.append(f"at most {self.at_most:g}{unit}")
        if self.value is not None:
            parts.append(f"{self.value:g} ± {self.within:g}{unit}" if self.within else f"{self.value:g}{unit}")
        return ", ".join(parts) or "holds"

    def check(self, measured: float) -> None:
        """Keep a measured value and fail where it is outside the bound."""
        keep(self.key, float(measured))
        assert self.inside(float(measured)), f"{self.key}: {measured:.6g} {self.unit}, claimed is {self.bound()}"


def keep(key: str, measured: float) -> None:
    """Add a measured value to the file that `MEASURED` names, if it names one."""
    if os.environ.get(MEASURED):
        with Path(os.environ[MEASURED]).open("a", encoding="utf-8") as file:
            file.write(json.dumps({"key": key, "measured": measured}) + "\n")


def read_claims(path: Path = FILE) -> dict[str, Claim]:
    """Claims by key, in the order of the file.

    Raises:
        ValueError: a key that stands twice or is not known, or a bound that does not make sense.
    """
    found: dict[str, Claim] = {}
    for entry in tomllib.loads(path.read_text(encoding="utf-8"))["claim"]:
        claim = _claim(entry)
        if claim.key in found:
            raise ValueError(f"{path.name}: {claim.key} stands twice")
        found[claim.key] = claim
    return found


def _claim(entry: dict[str, Any]) -> Claim:
    if unknown := set(entry) - KEYS:
        raise ValueError(f"{entry.get('key')}: {', '.join(sorted(unknown))} not known")
    if (("is" in entry) and ({"at_most", "at_least"} & set(entry))) or ("within" in entry) != ("is" in entry):
        raise ValueError(f"{entry['key']}: a bound is at_most, at_least, or is with within")
    numbers = {key: float(entry[key]) for key in ("at_most", "at_least", "within") if key in entry}
    return Claim(
        entry["key"], entry["says"], tuple(entry["by"]), value=float(entry["is"]) if "is" in entry else None,
        unit=entry.get("unit", ""), command=entry.get("command", ""), note=entry.get("note", ""),
        printed=tuple(entry.get("printed", {}).items()), **numbers,
    )  # fmt: skip


CLAIMS = read_claims()
