"""Motor motion and torque, sample by sample: what is compared in the band, how well it is known, what predicts it."""
