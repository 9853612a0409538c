"""What was tried, kept and refused, run after run, and an earlier diagnosis taken up again."""
