"""How sure a diagnosis is: intervals, correlations, effects that look alike, and the experiment that settles it."""
