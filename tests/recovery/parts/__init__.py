"""Machines described by their parts, recorded by finite elements, diagnosed with their parts file: the table of them.

`python -m tests.recovery.parts` (or `make recovery-parts`) runs what is missing, the cheap cases first, and writes its
section of docs/recovery.md after each.
"""
