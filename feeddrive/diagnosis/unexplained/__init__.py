"""What no named effect explains: which variables it follows, its shape, and the term that carries it."""
