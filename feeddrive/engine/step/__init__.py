"""One step: the linear chain exactly, effect forces on Radau nodes."""
