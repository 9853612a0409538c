"""Checks of a recording: what no machine has made is found, said, left out or refused."""
