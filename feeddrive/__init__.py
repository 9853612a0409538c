"""feeddrive: a control plant of machine-tool ball-screw feed drives that closes the loop with measured data."""

__version__ = "0.1.0"
