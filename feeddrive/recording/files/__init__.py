"""Reading and writing recordings: text tables, .mat, mappings."""
