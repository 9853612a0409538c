"""Find what a plant lacks, from recordings of it, and prove it on data that were not fitted."""
