"""Hours of recording: which stretches are informative, and the recording that they make together."""
