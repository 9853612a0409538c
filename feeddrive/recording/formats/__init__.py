"""Trace files as drives, controls and loggers write them, one file for each format; recognised by their content."""
