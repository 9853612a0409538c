"""Temperatures and growth: what is compared, what predicts it, which effects are tried, and from which size on."""
