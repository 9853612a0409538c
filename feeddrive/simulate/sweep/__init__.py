"""Sweeps: many runs of a scenario with varied values."""
