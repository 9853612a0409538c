"""Set-points and forces over time: motions, trajectories, excitations, cutting forces."""
