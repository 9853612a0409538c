"""What a catalogue sells: geometry and catalogue values become stiffness, inertia, friction, load, life."""
