"""Recordings: one time-series type for measured and simulated runs, its files, and what is wrong with them."""

from feeddrive.recording.channels import CHANNEL_UNITS, channel_unit
from feeddrive.recording.checks.lead_check import (
    check_against_lead,
    check_against_stroke,
    without_unfollowed_setpoint,
)
from feeddrive.recording.files.reading import read_recording
from feeddrive.recording.files.writing import write_recording
from feeddrive.recording.recording import Recording

__all__ = [
    "CHANNEL_UNITS",
    "Recording",
    "channel_unit",
    "check_against_lead",
    "check_against_stroke",
    "read_recording",
    "without_unfollowed_setpoint",
    "write_recording",
]
