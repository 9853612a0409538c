"""The moving nut beyond its average: what the ripple within a period does to the slow temperatures.

The nut goes to and fro with period P, angular frequency ω = 2π/P, and K(t) = Σ K_k exp(i k ω t). Temperatures are
θ̄ + θ̃, slow and periodic. To second order in K_k the ripple is slaved to the slow part,

    θ̃_k = -(i k ω C + K₀)⁻¹ (K_k θ̄ - B_k u),

and fed back into the mean it lowers the conductance that the slow part feels:

    K_eff = K₀ - 2 Σ_{k≥1} K_k Re[(i k ω C + K₀)⁻¹] K_k,    B_eff = B₀ - 2 Σ K_k Re[(i k ω C + K₀)⁻¹] B_k

(to and fro are mirror images, so that K_k is real and symmetric, and K_eff is symmetric). Physically: the steel under
the nut warms while it is covered, so that less heat crosses than the mean temperatures tell. Nothing is fitted. The
sum is projected on a basis of the averaged model, so that only K_k V is solved for.

| symbol | meaning | unit |
|---|---|---|
| K₀, B₀ | means over a period, the averaged model | W/K |
| K_k, B_k | harmonics of contact, covered surface and heat on the shaft's side | W/K |
| V | basis of the slow temperatures, VᵀCV = 1 | |
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from feeddrive.errors import InputError, ValidityWarning
from feeddrive.thermal.full.full_model import NUT, Discretisation, contact_way, model_of
from feeddrive.thermal.full.grid import places_of
from feeddrive.thermal.reduced.parametric_model import AMBIENT, Path
from feeddrive.thermal.reduced.system import HeatSystem
from feeddrive.thermal.rig import Travel, refuse_unless_positive
from feeddrive.typing import Expression, FloatArray

HARMONICS = 12
"""The k-th contributes about k to the power -2.5: those left out are below 1 % of the correction."""

LARGEST_RIPPLE = 1.0
"""Rate at which the contact warms the covered steel, over ω, up to which second order holds; see `ripple_number`."""


def moving_system(
    parts: Discretisation,
    conductances: Mapping[Path, float],
    feed: float,
    basis: FloatArray,
    travel: Travel | None = None,
    harmonics: int = HARMONICS,
) -> HeatSystem:
    """The slow system under a moving nut on a basis of its temperatures.

    Args:
        parts: the rig in finite volumes.
        conductances: path to g.
        feed: speed of the nut [m/s].
        basis: V, (n, r), such as `krylov.orthonormal` gives.
        travel: in place of the rig's.
        harmonics: how many are summed.

    Returns:
        Dense system of order r with symmetric K; its outputs are means over a period.

    Raises:
        InputError: a feed that is not positive, a travel that leaves the shaft, a negative conductance, a nut so slow
            that second order has no meaning.

    Warns:
        ValidityWarning: the nut is too slow for the contact (`ripple_number` above 1).
    """
    refuse_unless_positive(feed, "m/s", "feed")
    travel = travel or parts.rig.travel
    slow = model_of(parts, travel).projected(basis).at(conductances)
    if travel.stroke == 0:
        return slow
    lost_K, lost_B = ripple_loss(parts, conductances, feed, basis, travel, harmonics)
    return lowered(slow, lost_K, lost_B)


def lowered(slow: HeatSystem, lost_K: FloatArray, lost_B: FloatArray) -> HeatSystem:
    """An averaged system less what the ripple takes away.

    Raises:
        InputError: nothing of the slow system is left: the nut is too slow for its contact.
    """
    felt = slow.conductance - lost_K
    if np.linalg.eigvalsh(felt)[0] <= 0:
        raise InputError("the nut is too slow for its contact: no slow system", "feed", "use the explicit scheme")
    return replace(slow, conductance=felt, gains=slow.gains - lost_B)


def ripple_loss(
    parts: Discretisation,
    conductances: Mapping[Path, float],
    feed: float,
    basis: FloatArray,
    travel: Travel,
    harmonics: int = HARMONICS,
) -> tuple[FloatArray, FloatArray]:
    """What the ripple takes from K₀ and B₀ on a basis, (r, r) symmetric and (r, m); arguments as `moving_system`.

    Warns:
        ValidityWarning: the nut is too slow for the contact.
    """
    _warn_of_slowness(ripple_number(parts, conductances, feed, travel))
    averaged = model_of(parts, travel).at(conductances)
    ω, order = np.pi * feed / travel.stroke, basis.shape[1]
    lost = np.zeros((order, order + len(averaged.input_names)))
    for k in range(1, harmonics + 1):
        K_k, B_k = _harmonic(parts, conductances, travel, k, averaged.input_names)
        swung = np.asarray(K_k @ basis)
        lost += 2 * swung.T @ averaged.shifted_solve(1j * k * ω, np.hstack([swung, B_k])).real
    lost_K = lost[:, :order]
    return (lost_K + lost_K.T) / 2, lost[:, order:]


def ripple_number(parts: Discretisation, conductances: Mapping[Path, float], feed: float, travel: Travel) -> float:
    """Rate 2g/(R ρc) at which the contact warms the covered shaft, over the angular frequency of the motion [1]."""
    rate = 2 * conductances.get(Path.CONTACT, 0.0) / (parts.rig.radius * parts.rig.steel.heat_capacity)
    return rate * travel.stroke / (np.pi * feed)


def _warn_of_slowness(number: float) -> None:
    if number > LARGEST_RIPPLE:
        what = f"the nut is slow for its contact (ripple number {number:.2g}, up to {LARGEST_RIPPLE} is covered)"
        warnings.warn(f"{what}: the moving contact is extrapolated", ValidityWarning, stacklevel=4)


def _harmonic(
    parts: Discretisation, conductances: Mapping[Path, float], travel: Travel, k: int, names: tuple[str, ...]
) -> tuple[Expression, FloatArray]:
    """K_k, (n, n) sparse, and B_k, (n, m)."""
    places, shares = places_of(travel, parts.nut.spacing)
    stretches = len(places) - 1
    # A place is passed at ±t; the nut stands there for the share of the period that the explicit scheme gives it.
    weights = shares * np.cos(np.pi * k * np.arange(stretches + 1) / stretches) * np.sinc(k / (2 * stretches))
    lengths = np.sum(
        [weight * parts.overlap(Travel(place, place)) for weight, place in zip(weights, places, strict=True)], axis=0
    )
    covered = parts.spread(parts.skin, lengths.sum(axis=0))
    h, g = conductances.get(Path.SCREW_FILM, 0.0), conductances.get(Path.CONTACT, 0.0)
    bare = -h * parts.girth * covered
    inputs = np.zeros((parts.nodes, len(names)))
    inputs[:, names.index(AMBIENT)] = bare
    inputs[:, names.index(NUT)] = (1 - parts.rig.nut_heat_share) * covered / parts.rig.nut.length
    return g * contact_way(parts, lengths).matrix + sparse.diags_array(bare), inputs
