"""Odds for a lead map beside a set of effects, as for any further effect of the set."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from feeddrive.diagnosis.likelihood.fit import Fit, Problem, linear_step
from feeddrive.diagnosis.likelihood.set_evidence import log_prior_of_size, variance_along


def log_odds_of_map(problem: Problem, found: Fit, count: int) -> float:
    """Logarithm of the odds for a lead map beside a set; minus infinity where no stroke shows one, or it is open.

    A map is linear in its coordinates, of size one: one step from the set, with all that the set may do, is exact as
    far as the set is straight. Source: `likelihood.set_evidence`, with a normal prior.

    Args:
        problem: recordings.
        found: the set.
        count: candidates and starts that were tried for a name.
    """
    if any(e.open_map for e in problem.evidence):
        return float("-inf")
    rows = [int(e.thinned(e.fit_rows).sum()) * len(e.channels) for e in problem.evidence]
    parts, first, total = [], 0, len(found.residual)
    for e, size in zip(problem.evidence, rows, strict=True):
        for part in e.map_parts:
            column = np.zeros(total)
            column[first : first + size] = e.weighted(part, e.thinned(e.fit_rows))
            parts.append(column if problem.whitener is None else problem.whitener.applied(column))
        first += size
    if not parts:
        return float("-inf")
    columns = np.column_stack(parts)
    wide = np.column_stack([found.jacobian, columns]) if found.jacobian.size else columns
    residual = found.residual - wide @ linear_step(wide, found.residual)
    beside = replace(found, residual=residual, jacobian=wide)
    variance = variance_along(problem, beside, found, beside)
    volumes = [np.linalg.slogdet(j.T @ j / variance + np.eye(j.shape[1]))[1] for j in (found.jacobian, wide)]
    size = len(found.effects)
    more = log_prior_of_size(size + 1, count) - log_prior_of_size(size, count)
    excess = found.squared_error - float(residual @ residual)
    return float(0.5 * excess / variance - 0.5 * (volumes[1] - volumes[0]) + more)
