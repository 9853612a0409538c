"""Measurements against a machine: files, diagnosis, numbers, frequency responses, ISO 230, months of recordings."""
