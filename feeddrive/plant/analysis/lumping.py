"""The three-inertia machine that is nearest to a machine with a distributed screw, at one table position.

With the motor held, a force on the table and a torque on the screw at the nut move these two by the compliance

    H(s) = H_0 - s H_1 + ...,    H_0 = K^-1,  H_1 = K^-1 C K^-1    at the nut's angle and the table

Drive, screw and nut act in series, so that H_0 and H_1 of the machine have the form of three inertias, and

    1 / k_TS = H_0[phi, phi],    1 / k_XS = H_0[x, x] - r^2 / k_TS
    c_TS = k_TS^2 H_1[phi, phi], c_XS = k_XS^2 (H_1[x, x] - r^2 H_1[phi, phi])

give the static deflection of table and screw exactly, and to first order in frequency what is dissipated. Table mass,
ratio and lead are the machine's. All that turns is J = i^2 J_m + J_s, exactly, so that a torque accelerates both alike.
One value is left, the share of J that turns with the screw. It is the one for which

    (ln f_held / f_held,machine)^2 + (ln f_free / f_free,machine)^2

is least over the first anti-resonance (motor held) and the first resonance (motor free). By Rayleigh a frequency is off
by half the relative error of its mode's kinetic energy, so that this is the share with the least error of the kinetic
energy of the two lowest modes.

Along the stroke the axial spring of three inertias takes over what changes, the torsion's part included:

    1 / k_XS(x) = H_0[x, x](x) - r^2 / k_TS

It is a straight line where the screw is held at one end, a parabola where it is held at both, and the law of
`stiffness_vs_position` is both: b and m by least squares over places along the stroke. Dampers, inertias and torsion
stay as they are at the one position; what that costs is told by the first resonances at both ends.

Valid up to the first resonance: the second modes are told beside the machine's and need not agree.
A machine whose first mode is not the table on its springs (a table lighter than the screw) is told by its errors.

| symbol | meaning | unit |
|---|---|---|
| k_TS, c_TS | torsional stiffness and damping, motor to nut, at the screw | N m/rad, N m s/rad |
| k_XS, c_XS | axial stiffness and damping of bearings, screw and nut | N/m, N s/m |
| J_m, J_s, i | inertia at the motor, of the screw; motor turns per screw turn | kg m^2, kg m^2, 1 |
| r | lead / 2 pi | m/rad |
| b, m | as in `feeddrive.effects.transmission.stiffness_vs_position` | 1 |

Source: series of axial and torsional chain, paper 004, eqs. (6)-(8); Rayleigh's quotient for the inertias.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar

from feeddrive.effects.base import ChainEffect, Effect
from feeddrive.effects.transmission.preload_loss import PreloadLoss
from feeddrive.effects.transmission.stiffness_vs_position import StiffnessVsPosition
from feeddrive.errors import InputError
from feeddrive.plant.analysis.lumped_figures import PLACES, Compared, compared_along, compared_figures, first_modes
from feeddrive.plant.analysis.steady import steady_motions
from feeddrive.plant.analysis.stiffness_budget import nut_stiffness, static_stiffness
from feeddrive.plant.chain.chain import ThreeInertias
from feeddrive.plant.chain.drive_values import without_brake
from feeddrive.plant.file.lumped_text import lumped_text
from feeddrive.plant.file.plant_file import plant_from_entries
from feeddrive.plant.passive_friction import top_speed
from feeddrive.plant.plant import Plant
from feeddrive.schema.toml_text import parse_toml
from feeddrive.typing import FloatArray
from feeddrive.units.quantity import format_quantity

LEAST_SHARE = 1e-3
"""Least share of the turning inertia that motor and screw keep: none of the three may be without mass."""


_STRAIGHT = 1e-9
"""Rise of the parabola that is rounding: no machine is known to that."""

_STEADYPLACES = 5
"""Table positions of the steady motions: what is missed bends little along the stroke, as the torsion does."""

UNDECLARED_SPEED = 0.25
"""Velocity at which the drag is taken where neither table nor motor declare a greatest one [m/s]: a rapid traverse of
15 m/min. The error is told with it."""

_TRIED = 60  # shares from which the best is refined; the sum is smooth, with one minimum on machines


@dataclass(frozen=True)
class Lumped:
    """A machine as three inertias.

    Attributes:
        plant: the three inertias, as read from `text`.
        position: of the table, for which they hold [m].
        compared: what agrees, and how well.
        left_out: what three inertias do not have, in sentences.
        text: the plant file.
    """

    plant: Plant
    position: float
    compared: tuple[Compared, ...]
    left_out: tuple[str, ...]
    text: str


def lump(plant: Plant, position: float | None = None, further: tuple[str, ...] = ()) -> Lumped:
    """The three-inertia machine nearest to an elastic `plant` with its table at `position` [m], or in mid-stroke.

    `further` is what the caller knows to be left out besides, in sentences. Raises InputError: a rigid machine, or the
    nut off the screw.
    """
    if not plant.chain.elastic:
        raise InputError("a rigid machine has nothing to lump", plant.name, "name a machine with elastic parts")
    position = plant.middle if position is None else position
    plant.chain.refuse_off_screw(position, plant.name)
    bare = _bare(plant)
    values = _chain_values(bare, position)
    model = replace(bare, mechanics=ThreeInertias(values), effects=(), drive=None)
    along = _along_stroke(plant, bare, values, position)
    compared = (*compared_figures(bare, model, position), *compared_along(bare, model, along))
    effects, remarks = _effects(plant, values, along)
    missed = _missed(plant, replace(model, effects=effects))
    left_out = (*_left_out(plant, missed), *further)
    heading = _heading(plant, position, compared, left_out)
    text = lumped_text(plant, values, effects, remarks, heading, missed)
    where = f"{plant.name}, lumped"
    return Lumped(plant_from_entries(parse_toml(text, where), Path(where)), position, compared, left_out, text)


def _bare(plant: Plant) -> Plant:
    """Chain and chain effects alone, the motor held ideally where it is held."""
    kept = tuple(e for e in plant.effects if isinstance(e, ChainEffect) and not e.adds_coordinate)
    return replace(plant, effects=kept, drive=without_brake(plant.drive) if plant.drive is not None else None)


def _chain_values(bare: Plant, position: float) -> dict[str, float]:
    p = bare.chain_values()
    K, C, M = (
        np.array(matrix(p, position), dtype=float)
        for matrix in (bare.chain.stiffness, bare.chain.damping, bare.chain.mass)
    )
    nut = bare.chain.screw(p)[1:], bare.chain.table(p)[1:]
    static, first = _compliances(K[1:, 1:], C[1:, 1:], np.array(nut, dtype=float))
    r, rigid = bare.chain.radius, np.array(bare.chain.rigid_motion(p), dtype=float)
    torsional, axial = 1 / static[0, 0], 1 / (static[1, 1] - r**2 * static[0, 0])
    ratio = bare.chain.radius / bare.chain.motor_radius
    turning = (float(rigid @ M @ rigid) - p["table_mass"]) * r**2
    values = {
        "lead": p["lead"],
        "motor_inertia": 0.0,
        "screw_inertia": 0.0,
        "torsional_stiffness": torsional,
        "torsional_damping": torsional**2 * first[0, 0],
        "axial_stiffness": axial,
        "axial_damping": axial**2 * (first[1, 1] - r**2 * first[0, 0]),
        "table_mass": p["table_mass"],
    }
    values |= {"ratio": ratio} if abs(ratio - 1) > 1e-12 else {}
    share = _screw_share(bare, values, turning, ratio, position)
    return _shared(values, turning, ratio, share)


def _compliances(K: FloatArray, C: FloatArray, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """H_0 and H_1 at the nut's angle and the table, shape (2, 2) each."""
    size = 1 / np.sqrt(np.diag(K))  # of the coordinates: the matrix spans nine decades
    moved = size[:, None] * np.linalg.solve(size[:, None] * K * size, (rows * size).T)
    return rows @ moved, moved.T @ C @ moved


def _shared(values: Mapping[str, float], turning: float, ratio: float, share: float) -> dict[str, float]:
    split = {"motor_inertia": (1 - share) * turning / ratio**2, "screw_inertia": share * turning}
    return {**values, **split}


def _screw_share(bare: Plant, values: Mapping[str, float], turning: float, ratio: float, position: float) -> float:
    """Share of the turning inertia that is the screw's."""
    wanted = np.log(first_modes(bare, position))

    def missed(share: float) -> float:
        model = Plant("three inertias", ThreeInertias(_shared(values, turning, ratio, share)))
        return float(np.sum((np.log(first_modes(model, position)) - wanted) ** 2))

    tried = np.linspace(LEAST_SHARE, 1 - LEAST_SHARE, _TRIED)
    best = int(np.argmin([missed(float(share)) for share in tried]))
    ends = float(tried[max(best - 1, 0)]), float(tried[min(best + 1, _TRIED - 1)])
    return float(minimize_scalar(missed, bounds=ends, method="bounded", options={"xatol": 1e-7}).x)


def _along_stroke(
    plant: Plant, bare: Plant, values: Mapping[str, float], position: float
) -> StiffnessVsPosition | None:
    """The axial stiffness along the stroke, equal to the declared one at `position`; None where it does not change."""
    if plant.stroke is None or not plant.chain.varies:
        return None
    far = max(reversed(plant.stroke), key=lambda end: abs(end - position))
    places = np.linspace(*plant.stroke, PLACES)
    torsional = (plant.chain.radius**2) / values["torsional_stiffness"]
    compliance = np.array([1 / static_stiffness(bare, float(x)) - torsional for x in places])
    along = (places - position) / (far - position)
    laws = np.column_stack([along, 4 * along * (1 - along)])
    straight, middle = np.linalg.lstsq(laws, compliance * values["axial_stiffness"] - 1, rcond=None)[0]
    return StiffnessVsPosition.of(
        share_over_stroke=float(straight / (1 + straight)),
        middle_compliance=float(middle) if abs(middle) > _STRAIGHT else 0.0,
        low=position,
        high=far,
    )


def _missed(machine: Plant, model: Plant) -> dict[str, float]:
    """Rms [m] of what three inertias miss of the table behind the motor in steady motion along the stroke, both ways.

    Exact under a force on the table; what is missed is the twist by the drag of the screw, whose way to the motor
    changes along the stroke. It grows with the drag, so that the fastest motion bounds it.
    """
    if machine.stroke is None or not machine.chain.varies:
        return {}
    speed = top_speed(machine, UNDECLARED_SPEED)
    behind = []
    for x in np.linspace(*machine.stroke, _STEADYPLACES):
        pairs = zip(*(steady_motions(one, (speed, -speed), float(x)) for one in (machine, model)), strict=True)
        behind.append([(one.state[0] - other.state[0]) * machine.chain.motor_radius for one, other in pairs])
    return {"table_position": float(np.std(behind))}


def _effects(
    plant: Plant, values: Mapping[str, float], along: StiffnessVsPosition | None
) -> tuple[tuple[Effect, ...], tuple[str, ...]]:
    """The effects that stay effects, and where their values come from."""
    nut = nut_stiffness(plant)
    kept: list[Effect] = [along] if along is not None else []
    remarks = ["screw, bearings and torsion along the stroke"] if along is not None else []
    for effect in plant.motion_effects:
        if isinstance(effect, ChainEffect) and not effect.adds_coordinate:
            continue
        made = _on_axial_spring(effect, nut, values["axial_stiffness"])
        sources = dict.fromkeys(plant.origins.get(f"{effect.label}.{key}", "") for key in effect.values)
        remark = "; ".join(source for source in sources if source)
        if made is not effect:
            remark = f"of the nut's spring, converted to the axial one; {remark}".rstrip("; ")
        kept.append(made)
        remarks.append(remark)
    return tuple(kept), tuple(remarks)


def _on_axial_spring(effect: Effect, nut: float, axial: float) -> Effect:
    """A law of the nut's spring as one of the axial spring of three inertias, in which the nut is in series.

    A nut softer by the factor a makes the axial spring softer by 1 / (1 + (1 / a - 1) k_XS / k_N).
    """

    def softened(factor: float) -> float:
        return 1 / (1 + (1 / factor - 1) * axial / nut)

    if isinstance(effect, PreloadLoss):
        return effect.with_values(ratio=softened(float(effect.values["ratio"])))  # type: ignore[arg-type]
    if isinstance(effect, StiffnessVsPosition):
        share, middle = (float(effect.values[key]) for key in ("share_over_stroke", "middle_compliance"))  # type: ignore[arg-type]
        softer = middle * axial / nut
        return effect.with_values(share_over_stroke=1 - softened(1 - share), middle_compliance=softer)
    return effect


def _left_out(plant: Plant, missed: Mapping[str, float]) -> tuple[str, ...]:
    lines = []
    speed = format_quantity(top_speed(plant, UNDECLARED_SPEED), "m/s")
    for channel, error in missed.items():
        lines.append(
            f"twist of the screw by its own drag, as it changes along the stroke: {channel} is missed by "
            f"{format_quantity(error, 'm')} rms at {speed}; a diagnosis with this file names nothing within it"
        )
    if plant.chain.varies:
        what = "torsional stiffness, damping and what turns" if plant.stroke is not None else "stiffness and damping"
        lines.append(f"{what} along the stroke: here and everywhere as with the table at this position")
    if plant.drive is not None:
        lines.append("parts, and what is checked of them: critical speed and buckling of the screw, rated life")
        if plant.drive.motor.brake is not None:
            lines.append("the brake: a held motor is held ideally")
    if plant.has_heat:
        lines.append("heat: temperatures, growth, and what they change")
    merged = [e.label for e in plant.effects if isinstance(e, ChainEffect) and not e.adds_coordinate]
    if merged:
        lines.append(f"{', '.join(merged)} as effects: they are in the values")
    return tuple(lines)


def _heading(plant: Plant, position: float, compared: tuple[Compared, ...], left_out: tuple[str, ...]) -> list[str]:
    """What the comments of the file say."""
    scale = {"N/m": (1e-6, "N/µm"), "1": (100.0, "%")}
    lines = [
        f"{plant.name} as three inertias with the table at {1e3 * position:g} mm, written by `feeddrive lump`.",
        "Valid up to the first resonance.",
        "",
        "machine -> this file:",
    ]
    for row in compared:
        factor, unit = scale.get(row.unit, (1.0, row.unit))
        told = f"{row.machine * factor:.5g} -> {row.lumped * factor:.5g} {unit}"
        lines.append(f"  {row.name}: {told} ({100 * row.error:+.2f} %)")
    lines += ["", "Not in this file:", *(f"  {line}" for line in left_out)] if left_out else []
    assert all(math.isfinite(row.lumped) for row in compared)
    return lines
