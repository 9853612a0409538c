"""Life: rated, consumed, and its scatter."""
