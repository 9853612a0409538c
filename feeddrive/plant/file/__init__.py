"""Plant files: reading, drafting and writing a machine as TOML."""
