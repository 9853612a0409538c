"""One file a control: its layout, its sign rule with the source, its limits, and how it applies a table."""
