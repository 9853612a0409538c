"""Effects: one law a file, written once as a CasADi expression."""
