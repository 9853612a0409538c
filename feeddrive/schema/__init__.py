"""What may stand in a file: every key of every section, declared once for readers, reference and errors."""
