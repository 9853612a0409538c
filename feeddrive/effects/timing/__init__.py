"""Effects in time: dead time of drive and channels."""
