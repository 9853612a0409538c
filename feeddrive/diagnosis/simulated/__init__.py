"""The declared loop run by simulation: its error, and the values of the effects refined in it."""
