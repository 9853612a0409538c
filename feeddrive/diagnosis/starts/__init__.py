"""Values from which fits start, read off the residual, and why a recording cannot show an effect."""
