"""The recovery suite: every effect planted by the independent generator, at three sizes, diagnosed and judged.

`python -m tests.recovery.suite` (or `make recovery`) runs what is missing and writes docs/recovery.md.
"""
