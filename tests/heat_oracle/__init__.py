"""What the heat models are measured against: the explicit scheme, the moving nut at many speeds, exact step answers."""
