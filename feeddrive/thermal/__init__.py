"""The heat of a machine: full model, reduction, laws, runs."""
