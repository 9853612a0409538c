"""What a machine answers without a motion: summary, modes, stiffness, rules, life, responses, drafts."""
