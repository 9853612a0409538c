"""Effects that add a force or a torque."""
