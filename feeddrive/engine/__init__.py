"""The engine: a program of steps, compiled or interpreted; it knows no scenario and no machine."""
