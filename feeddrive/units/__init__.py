"""Units at the border: text with a unit in, SI inside, the usual units out."""
