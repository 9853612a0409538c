"""Figures of machine tools from recordings: positioning, following, circles, lost motion, friction, response."""
