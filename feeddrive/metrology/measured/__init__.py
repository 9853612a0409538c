"""Metrology of measurements: tables of a laser or ball-bar, and recordings with a scale."""
