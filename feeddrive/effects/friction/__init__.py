"""Effects in the one friction law of a port."""
