"""What a plant file declares about heat, and how it is joined to the motion."""
