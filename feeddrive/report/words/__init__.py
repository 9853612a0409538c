"""Sentences of results."""
