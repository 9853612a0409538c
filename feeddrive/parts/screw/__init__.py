"""Ball screw and nut: geometry, friction, efficiency, preload, contact, load distribution."""
