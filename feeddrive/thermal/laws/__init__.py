"""Laws of heat: films, contact, friction, preload, expansion."""
