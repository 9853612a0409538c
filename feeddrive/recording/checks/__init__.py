"""Checks of a recording: what no machine has made is found, reported, left out or refused."""
