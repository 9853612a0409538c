"""Pages of results in HTML."""
