"""Measured numbers (stiffness, natural frequency, drag torque, lost motion) against what a plant file declares."""
