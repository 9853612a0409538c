"""Effects that add travel between screw and table."""
