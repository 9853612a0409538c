"""What is told to the control: lead errors, backlash, friction, cogging and heat; tables in the controls' own forms."""
