"""Hours: a servo cycle repeated while the machine warms up, and slow logs."""
