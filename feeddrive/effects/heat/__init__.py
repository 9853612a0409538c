"""Effects in the heat of a machine."""
