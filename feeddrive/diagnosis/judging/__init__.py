"""Judging what was found on data not fitted, and what is reported."""
