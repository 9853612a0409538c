"""Simulation: the plant driven, controlled, swept, warmed."""
