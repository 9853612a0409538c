"""The bench: a page on which gains, filters, position, payload and effects are moved and the loop is seen at once."""
