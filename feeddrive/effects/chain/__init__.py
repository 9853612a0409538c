"""Effects that change the linear chain."""
