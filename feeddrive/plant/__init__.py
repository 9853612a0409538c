"""The plant: a chain and effects at its ports become equations; its file, its analysis."""
