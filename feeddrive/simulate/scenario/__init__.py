"""Scenarios: an experiment as a file, its run, what it gives."""
