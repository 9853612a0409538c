"""The reduced heat model: the full model's class with a few states."""
