"""Chains: matrices of inertia, damping and stiffness from lumped or distributed parts."""
