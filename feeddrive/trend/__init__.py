"""An axis over months of recordings: what each says in one linear pass, what changed between them, and when."""
