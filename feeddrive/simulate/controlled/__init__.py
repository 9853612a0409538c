"""Runs under a sampled controller: the plant, the loop, what a recorder writes."""
