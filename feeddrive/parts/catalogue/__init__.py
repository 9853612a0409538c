"""The parts catalogue: what makers print of screws, bearings, guides, couplings and motors, each with its source."""
