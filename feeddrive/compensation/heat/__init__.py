"""Thermal errors along the stroke and what compensates them: a table over one sensor, a model, an observer."""
