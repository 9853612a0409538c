"""Linear guides: geometry, stiffness, film, friction, balance of a table's carriages."""
