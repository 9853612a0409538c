"""Effects in the one spring law of the transmission."""
