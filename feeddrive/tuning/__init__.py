"""Recommended settings of controllers, and why."""
