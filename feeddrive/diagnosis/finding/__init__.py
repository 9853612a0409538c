"""The search for effects that a plant lacks."""
