"""What else one would do on the machines of the fleet: sparse regression, a black box, an earlier method."""
