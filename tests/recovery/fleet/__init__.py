"""A fleet of machines drawn at random, diagnosed as a user would, and set beside the truth."""

from tests.recovery.fleet.case import Case, case

__all__ = ["Case", "case"]
