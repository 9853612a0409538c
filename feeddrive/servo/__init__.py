"""Controllers as drives have them, their filters and their linear loop."""
