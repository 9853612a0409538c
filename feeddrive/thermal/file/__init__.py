"""The heat of a plant file: its sections, read."""
