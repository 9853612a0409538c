"""Several recordings of one machine: what they share, and what changed from one to the next."""
