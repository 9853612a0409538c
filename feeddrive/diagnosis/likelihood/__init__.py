"""What plant and recording say of a set of effects: prediction, residual, fit, blocks not fitted."""
