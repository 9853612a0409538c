"""Runs of the heat model over hours, their energy balance, their summary."""
