"""Which change of a drive explains a measured stiffness and a measured natural frequency."""
