"""Loop settings as drives and controls name them: names, units, resolution, limits, each with its source."""
