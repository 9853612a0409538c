"""Fuzzing: whatever stands in a file, a command ends with status 0 or with 2 and one line."""
