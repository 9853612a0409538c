"""Calibration before diagnosis: declared values fitted within their tolerances in every set of effects."""
