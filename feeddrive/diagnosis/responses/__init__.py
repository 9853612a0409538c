"""Measured frequency responses against what a plant file declares."""
