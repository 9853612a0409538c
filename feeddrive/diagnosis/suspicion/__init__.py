"""The recording as a suspect: signs, factors, clocks, holds."""
