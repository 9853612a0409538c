"""What a control is given: lead errors, backlash, friction, cogging and heat; tables in the controls' own forms."""
