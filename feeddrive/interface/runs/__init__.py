"""Machines in motion: controllers, scenarios, sweeps, warm-up."""
