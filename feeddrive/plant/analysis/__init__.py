"""Questions to a plant: linearisation, modes, stiffness budget, lumping, plausibility."""
