"""Support bearings: stiffness, friction, arrangement."""
